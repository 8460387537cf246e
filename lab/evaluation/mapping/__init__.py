"""Maps of places with known truth: one detection cache a place, whatever configuration reads it, and its scores."""
