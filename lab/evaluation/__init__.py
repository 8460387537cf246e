"""The paper's protocols: experiments that run the system on a place with known truth, and score it."""
