"""Detection batches as the mapper gets them from perception, made by imperfect perception."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace

from lab.simulation.imperfect.features import FeatureModel
from lab.simulation.imperfect.frames import SeenFrame
from lab.simulation.imperfect.looking import Look, imperfect_looks
from lab.simulation.imperfect.params import NOISY, ImperfectParams
from lab.simulation.imperfect.truth import TrueThing, truth_of
from ovip.recordings import OnboardDetection
from ovip.scene.types import Detection, DetectionBatch, Frame
from services.perception.domain.gate import GateParams, gate_offline
from services.perception.domain.lifting import LiftParams, lift_all, surface_cloud
from services.perception.domain.nearest import nearest_depth


def imperfect_batches(
    frames: Iterable[SeenFrame],
    things: Iterable[TrueThing],
    params: ImperfectParams = NOISY,
    seed: int = 0,
    model: FeatureModel | None = None,
    lifting: LiftParams | None = None,
) -> Iterator[DetectionBatch]:
    """One batch a frame, lifted as perception lifts; not gated (see `gated`).

    things: a home's objects. model: its encoder, by default the one of seed 0, so that all homes share one
    feature space. A frame's batch depends on the frame, things, params and seed only, not on other frames.
    """
    truth = truth_of(things)
    model = model or FeatureModel(tuple(thing.label for thing in truth.values()))
    lifting = lifting or LiftParams()
    for seen in frames:
        looks = imperfect_looks(seen, truth, model, params, seed)
        yield batch_of(seen.frame, looks, lifting)


def batch_of(frame: Frame, looks: Sequence[Look], lifting: LiftParams) -> DetectionBatch:
    """A frame's looks lifted; what is too small, too far or too uncertain drops out, as in perception."""
    return DetectionBatch(
        frame_id=frame.frame_id,
        timestamp_ns=frame.timestamp_ns,
        intrinsics=frame.intrinsics,
        world_from_camera=frame.world_from_camera,
        detections=tuple(_lifted(frame, looks, lifting)),
        surface=surface_cloud(frame, lifting),
        words=tuple(sorted({look.label for look in looks})),
        nearest=nearest_depth(frame.depth, farthest=lifting.farthest_seen),
    )


def gated(
    batches: Callable[[], Iterable[DetectionBatch]], params: GateParams | None = None
) -> Iterator[DetectionBatch]:
    """The batches with the detections of admitted words only, as perception grounds a recorded run (Eq. 1).

    batches: gives them from the start each time it is called; it is called twice.
    """
    admitted = gate_offline([(batch.frame_id, batch.words) for batch in batches()], params or GateParams())
    for batch in batches():
        words = tuple(word for word in batch.words if (batch.frame_id, word) in admitted)
        yield replace(batch, words=words, detections=tuple(d for d in batch.detections if d.label in words))


def onboard_of(looks: Sequence[Look]) -> tuple[OnboardDetection, ...]:
    """A frame's looks as a robot that detects on board sends them, without features.

    A stack embeds the labels in its own feature space; where it has the lab's, `onboard_with_features`.
    """
    return tuple(OnboardDetection(look.label, look.score, look.box2, look.mask) for look in looks)


def onboard_with_features(looks: Sequence[Look]) -> tuple[OnboardDetection, ...]:
    """The same with features."""
    return tuple(
        OnboardDetection(look.label, look.score, look.box2, look.mask, look.feature) for look in looks
    )


def _lifted(frame: Frame, looks: Sequence[Look], lifting: LiftParams) -> Iterator[Detection]:
    sure = [(index, look) for index, look in enumerate(looks) if look.score >= lifting.min_confidence]
    made = lift_all(frame, [look.mask for _, look in sure], lifting)
    for (index, look), lifted in zip(sure, made, strict=True):
        if lifted is None:
            continue
        yield Detection(
            detection_id=f"{frame.frame_id}/{index}",
            label=look.label,
            score=look.score,
            box2=look.box2,
            box=lifted.box,
            feature=look.feature,
            points=lifted.points,
            colors=lifted.colors,
        )
