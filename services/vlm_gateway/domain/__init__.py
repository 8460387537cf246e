"""What the gateway decides, without I/O or a clock: fingerprints, estimates, retries, schemas, order."""
