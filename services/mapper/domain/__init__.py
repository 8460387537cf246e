"""IPA (IPSM + LAMP), AWF and the object map in plain numpy."""
