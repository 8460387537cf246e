"""Imperfect perception: seeded detections from instance ids, to measure the mapper on; never the product's."""

from lab.simulation.imperfect.batches import (
    batch_of,
    gated,
    imperfect_batches,
    onboard_of,
    onboard_with_features,
)
from lab.simulation.imperfect.cache import CacheHeader, header_for, read_cache, write_cache
from lab.simulation.imperfect.features import FeatureModel, FeatureParams, View
from lab.simulation.imperfect.frames import (
    SeenFrame,
    coloured_frames,
    halved,
    rendered_frames,
    small_house_frames,
)
from lab.simulation.imperfect.looking import Look, Mistake, imperfect_looks
from lab.simulation.imperfect.params import NOISY, PERFECT, ImperfectParams
from lab.simulation.imperfect.truth import Thing, TrueThing, truth_of

__all__ = [
    "NOISY",
    "PERFECT",
    "CacheHeader",
    "FeatureModel",
    "FeatureParams",
    "ImperfectParams",
    "Look",
    "Mistake",
    "SeenFrame",
    "Thing",
    "TrueThing",
    "View",
    "batch_of",
    "coloured_frames",
    "gated",
    "halved",
    "header_for",
    "imperfect_batches",
    "imperfect_looks",
    "onboard_of",
    "onboard_with_features",
    "read_cache",
    "rendered_frames",
    "small_house_frames",
    "truth_of",
    "write_cache",
]
