"""One experiment a module: `run(options) -> Result`."""
