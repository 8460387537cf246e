"""One random stream for every named draw, so that nothing depends on the order in which things are drawn."""

from __future__ import annotations

import hashlib

import numpy as np


def stream(seed: int, *name: int | str) -> np.random.Generator:
    """The generator of this seed and name: the same numbers for the same name, whatever else was drawn."""
    digest = hashlib.blake2b(repr((seed, *name)).encode(), digest_size=16).digest()
    return np.random.Generator(np.random.PCG64(int.from_bytes(digest, "little")))


def happens(seed: int, mistake: str, level: float, object_id: int, frame: int) -> bool:
    """Whether a mistake of this level is made with a thing in a frame.

    Its chance is the level times the thing's own inclination, drawn evenly from 0 to 2 once for all frames.
    """
    if level <= 0:
        return False
    inclination = 2 * stream(seed, mistake, "inclination", object_id).random()
    return bool(stream(seed, mistake, object_id, frame).random() < level * inclination)
