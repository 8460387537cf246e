"""Doing a step: its input is fetched first, then the map is changed, which needs nothing but the processor."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np

from ovip.codec import decode_detection_batch, decode_edit_request
from ovip.errors import InvalidInput
from ovip.scene.types import DetectionBatch
from ovip.store.blobs import BlobStore
from services.mapper.domain.object_map import ObjectMap
from services.mapper.domain.params import params_of
from services.mapper.journal import (
    EditInput,
    FrameInput,
    JoinInput,
    SettingsInput,
    Step,
    StepInput,
    UpkeepInput,
)

Doing = Callable[[ObjectMap], Step]
"""Changes a map by one step, given all that the step needs; says what it did."""


async def prepared(blobs: BlobStore, source: StepInput) -> Doing:
    """What an input does to any map. NotFound or Corrupt, now or then, where its bytes are not what was put."""
    match source:
        case FrameInput():
            data = await blobs.get(source.batch)
            return lambda objects: _integrate(objects, decode_detection_batch(data), source)
        case UpkeepInput():
            return lambda objects: Step(source, objects.upkeep())
        case EditInput():
            request = decode_edit_request(source.request)
            return lambda objects: Step(source, objects.edit(request))
        case JoinInput():
            return _joining(source, await blobs.get(source.other_map))
        case SettingsInput():
            params = params_of(source.params)
            return lambda objects: Step(source, objects.adopt(params))


def _joining(source: JoinInput, other_map: bytes) -> Doing:
    def join(objects: ObjectMap) -> Step:
        other = ObjectMap.restore([other_map])
        return Step(source, *objects.join(other, source.world_from_other))

    return join


def _integrate(objects: ObjectMap, batch: DetectionBatch, source: FrameInput) -> Step:
    """One frame's step. What cannot be the map's is left out, and the reason written down: the same in every replay."""
    if not source.refused:
        try:
            return Step(source, objects.integrate(batch))
        except InvalidInput as error:
            source = dataclasses.replace(source, refused=str(error))
    return Step(source, objects.integrate(_empty(batch)))


def _empty(batch: DetectionBatch) -> DetectionBatch:
    return dataclasses.replace(
        batch, detections=(), surface=np.zeros((0, 3), np.float32), nearest=np.zeros((0, 0), np.float32)
    )
