"""Ids that this system makes up: sortable by when they were made."""

from __future__ import annotations

import secrets
import time
import uuid


def uuid7() -> str:
    """RFC 9562, version 7: milliseconds since the epoch, then random bits."""
    value = (time.time_ns() // 1_000_000) << 80 | secrets.randbits(80)
    value = value & ~(0xF << 76) | 0x7 << 76
    value = value & ~(0x3 << 62) | 0x2 << 62
    return str(uuid.UUID(int=value))
