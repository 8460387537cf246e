"""The kernel of OVIP-SG: the words and the wires that every service shares."""
