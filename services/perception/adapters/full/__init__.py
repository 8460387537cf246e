"""Large models on a GPU: Grounding DINO and its like, SAM 2, CLIP, all on torch (DESIGN 5)."""

from __future__ import annotations

from ovip.errors import NotConfigured
from services.perception.config import Settings
from services.perception.detecting import Models
from services.perception.ports import CropEncoder


def open_full(settings: Settings) -> Models:
    """The set that OVIP_FULL_GROUNDER, _SEGMENTER and _ENCODER name, on OVIP_FULL_DEVICE.

    NotConfigured where a package, the device or weights are missing: it says which, and what to do.
    """
    try:
        from services.perception.adapters.full.encoding import open_encoder
        from services.perception.adapters.full.grounding import open_grounder
        from services.perception.adapters.full.loading import checked_device
        from services.perception.adapters.full.naming import ZeroShotEnumerator
        from services.perception.adapters.full.segmenting import Sam2Segmenter
    except ImportError as error:
        raise NotConfigured(
            f"OVIP_MODELS=full: the package {error.name!r} is missing: pip install 'ovip-sg[full]'"
        ) from error
    device = checked_device(settings.full_device)
    encoder = open_encoder(settings.full_encoder, device)
    return Models(
        name="full",
        enumerator=ZeroShotEnumerator(encoder),
        grounder=open_grounder(settings.full_grounder, device, settings.min_confidence),
        segmenter=Sam2Segmenter(settings.full_segmenter, device),
        encoder=encoder,
    )


def open_second_encoder(settings: Settings) -> CropEncoder:
    """The DINO that OVIP_SECOND_ENCODER names, on OVIP_FULL_DEVICE; NotConfigured as in `open_full`."""
    try:
        from services.perception.adapters.full.dino import DinoEncoder
        from services.perception.adapters.full.loading import checked_device
    except ImportError as error:
        raise NotConfigured(
            f"OVIP_SECOND_ENCODER: the package {error.name!r} is missing: pip install 'ovip-sg[full]'"
        ) from error
    return DinoEncoder(settings.second_encoder, checked_device(settings.full_device))
