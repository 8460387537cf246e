"""Where the lab keeps what it has prepared."""

from __future__ import annotations

import os
from pathlib import Path


def cache_folder() -> Path:
    """`OVIP_LAB_CACHE`, by default `~/.cache/ovip/lab`; it may not be there yet."""
    return Path(os.environ.get("OVIP_LAB_CACHE") or Path.home() / ".cache" / "ovip" / "lab")
