"""The proof: simulated homes, evaluation and measurements; nothing that a running system needs."""
