"""The stage that turns the frame log into the detections log, one scene at a time, each frame once (SPEC 1, DESIGN 3).

A step is a function of the frame log alone, so a replay after a crash writes what was not yet written and nothing
else: gate, tags, batches and cursor move in one commit.
"""

from __future__ import annotations

import asyncio
import json
from collections.abc import Sequence
from dataclasses import dataclass

from ovip.codec import encode_detection_batch
from ovip.errors import Corrupt, InvalidInput, NotFound, OvipError
from ovip.scene.types import DetectionBatch, Frame
from ovip.stages import holding, new_owner
from ovip.store import Append, Entry, Lease, Store
from ovip.telemetry import get_logger
from services.perception.detecting import Detecting
from services.perception.domain.gate import GateParams, VocabularyGate
from services.perception.history import DETECTIONS, FRAMES, STAGE, FrameHistory, StoredFrame, stored_frame
from services.perception.onboard import OnboardDetection, decode_onboard

_AT_ONCE = 16
_WRITTEN_AT_ONCE = 2
_UNUSABLE = (Corrupt, InvalidInput, NotFound)
log = get_logger("perception")


@dataclass(frozen=True, slots=True, eq=False)
class _Read:
    """A frame as it lies in the store. onboard: its robot's own detections, None where it sent none."""

    frame: Frame
    onboard: tuple[OnboardDetection, ...] | None


@dataclass(frozen=True, slots=True, eq=False)
class _Step:
    """What the stage writes for one frame; tags None where it is passed over."""

    stored: StoredFrame
    tags: tuple[str, ...] | None
    batches: tuple[DetectionBatch, ...]
    after: _Progress


class PerceptionWorker:
    """Follows one scene's frame log."""

    def __init__(
        self, store: Store, detecting: Detecting, gate: GateParams, history: FrameHistory | None = None
    ) -> None:
        self._store = store
        self._detecting = detecting
        self._gate_params = gate
        self._history = history or FrameHistory(store)
        self._owner = new_owner()

    async def follow(self, scene: str) -> None:
        """Processes frames as they come, for ever."""
        async with holding(self._store, scene, STAGE, self._owner) as lease:
            cursor = await self._store.cursor(scene, STAGE)
            progress = await _Progress.load(self._store, scene, self._gate_params)
            while True:
                entries = await self._store.read(scene, FRAMES, cursor, count=_AT_ONCE, block_ms=1000)
                if entries:
                    progress = await self._work_off(lease, entries, progress)
                    cursor = entries[-1].id

    async def _work_off(self, lease: Lease, entries: Sequence[Entry], progress: _Progress) -> _Progress:
        """Frame after frame; while one is looked at, the next is read and those before it are written, in order."""
        frames = [stored_frame(entry) for entry in entries]
        reading = asyncio.create_task(self._read(frames[0]))
        writing: list[asyncio.Task[None]] = []
        try:
            for stored, following in zip(frames, [*frames[1:], None], strict=True):
                read = await reading
                if following:
                    reading = asyncio.create_task(self._read(following))
                step = await self._made(lease.scene, stored, read, progress)
                if len(writing) >= _WRITTEN_AT_ONCE:
                    await writing[-_WRITTEN_AT_ONCE]
                before = writing[-1] if writing else None
                writing.append(asyncio.create_task(self._write(lease, step, before)))
                progress = step.after
            await asyncio.gather(*writing)
        except Exception:
            # the frames before are not lost with this one
            await asyncio.gather(*writing, return_exceptions=True)
            raise
        finally:
            for task in (reading, *writing):
                task.cancel()
            await asyncio.gather(reading, *writing, return_exceptions=True)
        return progress

    async def _read(self, stored: StoredFrame) -> _Read | OvipError:
        """A frame's images and its robot's detections; what cannot be read stops nothing but itself."""
        try:
            return _Read(await self._history.load(stored), await self._onboard(stored))
        except _UNUSABLE as error:
            return error

    async def _made(
        self, scene: str, stored: StoredFrame, read: _Read | OvipError, progress: _Progress
    ) -> _Step:
        try:
            if isinstance(read, OvipError):
                raise read
            tags, gate, batches = await self._process(scene, stored, read, progress.gate)
        except _UNUSABLE as error:
            log.error("frame_skipped", scene=scene, frame_id=stored.frame_id, reason=str(error))
            return _Step(stored, None, (), progress.passed_over())
        after = progress.advanced(gate, sum(len(b.detections) for b in batches))
        return _Step(stored, tags, tuple(batches), after)

    async def _write(self, lease: Lease, step: _Step, before: asyncio.Task[None] | None) -> None:
        """Stores a step's batches, and commits it after the one before it; not where that one failed."""
        encoded = [await asyncio.to_thread(encode_detection_batch, batch) for batch in step.batches]
        refs = await asyncio.gather(*(self._store.blobs.put(data) for data in encoded))
        appends = [
            Append(
                DETECTIONS,
                {"frame_id": batch.frame_id, "batch": ref, "kind": "late" if batch.late else "frame"},
            )
            for batch, ref in zip(step.batches, refs, strict=True)
        ]
        if before:
            await before
        tags = {} if step.tags is None else {f"tags:{step.stored.frame_id}": json.dumps(step.tags)}
        await self._store.commit(lease, step.stored.log_id, appends, {**tags, **step.after.puts()})
        log.debug(
            "frame_processed", scene=lease.scene, frame_id=step.stored.frame_id, batches=len(step.batches)
        )

    async def _process(
        self, scene: str, stored: StoredFrame, read: _Read, gate: VocabularyGate
    ) -> tuple[tuple[str, ...], VocabularyGate, list[DetectionBatch]]:
        """Enumerate, gate, ground; and ground earlier frames again for the words admitted only now."""
        frame, onboard = read.frame, read.onboard
        tags = await self._detecting.tags(frame, onboard)
        if onboard is not None:  # a robot's own detections are its own choice of words
            return tags, gate, [await self._detecting.batch(frame, tags, onboard, late=False)]
        gate, admission = gate.observe(stored.frame_id, tags)
        batches = [await self._detecting.batch(frame, admission.words, None, late=False)]
        for frame_id, word in admission.late:
            earlier = await self._history.load(await self._history.find(scene, frame_id))
            batches.append(await self._detecting.batch(earlier, [word], None, late=True))
        return tags, gate, batches

    async def _onboard(self, stored: StoredFrame) -> tuple[OnboardDetection, ...] | None:
        return decode_onboard(await self._store.blobs.get(stored.onboard_ref)) if stored.onboard_ref else None


class _Progress:
    """The stage's small values: the gate and the counts, as they lie in the store."""

    def __init__(self, gate: VocabularyGate, processed: int, skipped: int, detections: int) -> None:
        self.gate = gate
        self._processed, self._skipped, self._detections = processed, skipped, detections

    @classmethod
    async def load(cls, store: Store, scene: str, params: GateParams) -> _Progress:
        values = await store.values(scene, STAGE, ["gate", "processed", "skipped", "detections"])
        named = {word: tuple(frames) for word, frames in json.loads(values.get("gate", b"{}")).items()}
        counts = (int(values.get(name, 0)) for name in ("processed", "skipped", "detections"))
        return cls(VocabularyGate(params, named), *counts)

    def advanced(self, gate: VocabularyGate, detections: int) -> _Progress:
        return _Progress(gate, self._processed + 1, self._skipped, self._detections + detections)

    def passed_over(self) -> _Progress:
        return _Progress(self.gate, self._processed, self._skipped + 1, self._detections)

    def puts(self) -> dict[str, bytes | str | int]:
        return {
            "gate": json.dumps({word: list(frames) for word, frames in self.gate.named.items()}),
            "vocabulary": json.dumps(self.gate.vocabulary),
            "processed": self._processed,
            "skipped": self._skipped,
            "detections": self._detections,
        }
