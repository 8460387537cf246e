"""Loading weights and finding the device, with errors that name the setting."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

import torch

from ovip.errors import NotConfigured


def checked_device(name: str) -> str:
    """`name` itself; NotConfigured where torch does not know it or has no such device."""
    try:
        torch.zeros(1, device=name)
    except (RuntimeError, AssertionError) as error:
        reason = str(error).splitlines()[0]
        raise NotConfigured(
            f"OVIP_FULL_DEVICE: expected a device that torch can use, such as cuda or cpu; {name!r}: {reason}"
        ) from error
    return name


@contextlib.contextmanager
def loading(setting: str, name: str) -> Iterator[None]:
    """Loads a model inside the block; NotConfigured names `setting` where it cannot be had."""
    try:
        yield
    except (OSError, ValueError, RuntimeError) as error:
        reason = str(error).strip().splitlines()[0] if str(error).strip() else type(error).__name__
        raise NotConfigured(
            f"{setting}: expected a model's hub name or a directory with its files; {name!r}: {reason}"
        ) from error
