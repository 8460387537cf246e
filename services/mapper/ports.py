"""The seam of the mapper: who finds how two recordings of one place lie on each other."""

from __future__ import annotations

from typing import Protocol

from ovip.scene.types import F32, F64
from ovip.scene.versions import Alignment


class Aligner(Protocol):
    """Registers surfaces by their shape."""

    def align(self, cloud: F32, other: F32, guess: F64 | None) -> Alignment:
        """How `other` `(M, 3)` lies on `cloud` `(N, 3)`, both in metres, z up.

        guess: `(4, 4)` world_from_other to start from; None: anywhere. InvalidInput where a cloud is
        none, Unreliable where it cannot be told, and why; NotConfigured where a package is missing.
        """
        ...
