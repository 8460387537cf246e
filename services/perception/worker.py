"""The stage that turns the frame log into the detections log, one scene at a time, each frame once (SPEC 1, DESIGN 3).

A step is a function of the frame log alone, so a replay after a crash writes what was not yet written and nothing
else: gate, tags, batches and cursor move in one commit.
"""

from __future__ import annotations

import json

from ovip.codec import encode_detection_batch
from ovip.errors import Corrupt, InvalidInput, NotFound
from ovip.scene.types import DetectionBatch
from ovip.stages import holding, new_owner
from ovip.store import Append, Entry, Lease, Store
from ovip.telemetry import get_logger
from services.perception.detecting import Detecting
from services.perception.domain.gate import GateParams, VocabularyGate
from services.perception.history import DETECTIONS, FRAMES, STAGE, FrameHistory, StoredFrame, stored_frame
from services.perception.onboard import OnboardDetection, decode_onboard

log = get_logger("perception")


class PerceptionWorker:
    """Follows one scene's frame log."""

    def __init__(self, store: Store, detecting: Detecting, gate: GateParams) -> None:
        self._store = store
        self._detecting = detecting
        self._gate_params = gate
        self._history = FrameHistory(store)
        self._owner = new_owner()

    async def follow(self, scene: str) -> None:
        """Processes frames as they come, for ever."""
        async with holding(self._store, scene, STAGE, self._owner) as lease:
            cursor = await self._store.cursor(scene, STAGE)
            progress = await _Progress.load(self._store, scene, self._gate_params)
            while True:
                for entry in await self._store.read(scene, FRAMES, cursor, count=4, block_ms=1000):
                    progress = await self._step(lease, entry, progress)
                    cursor = entry.id

    async def _step(self, lease: Lease, entry: Entry, progress: _Progress) -> _Progress:
        stored = stored_frame(entry)
        try:
            tags, gate, batches = await self._process(lease.scene, stored, progress.gate)
        except (Corrupt, InvalidInput, NotFound) as error:
            log.error("frame_skipped", scene=lease.scene, frame_id=stored.frame_id, reason=str(error))
            return await self._skip(lease, stored, progress)
        after = progress.advanced(gate, sum(len(b.detections) for b in batches))
        appends = [
            Append(
                DETECTIONS,
                {
                    "frame_id": batch.frame_id,
                    "batch": await self._store.blobs.put(encode_detection_batch(batch)),
                    "kind": "late" if batch.late else "frame",
                },
            )
            for batch in batches
        ]
        puts = {f"tags:{stored.frame_id}": json.dumps(tags), **after.puts()}
        await self._store.commit(lease, stored.log_id, appends, puts)
        log.debug("frame_processed", scene=lease.scene, frame_id=stored.frame_id, batches=len(batches))
        return after

    async def _process(
        self, scene: str, stored: StoredFrame, gate: VocabularyGate
    ) -> tuple[tuple[str, ...], VocabularyGate, list[DetectionBatch]]:
        """Enumerate, gate, ground; and ground earlier frames again for the words admitted only now."""
        frame = await self._history.load(stored)
        onboard = await self._onboard(stored)
        tags = await self._detecting.tags(frame, onboard)
        if onboard is not None:  # a robot's own detections are its own choice of words
            return tags, gate, [await self._detecting.batch(frame, tags, onboard, late=False)]
        gate, admission = gate.observe(stored.frame_id, tags)
        batches = [await self._detecting.batch(frame, admission.words, None, late=False)]
        for frame_id, word in admission.late:
            earlier = await self._history.load(await self._history.find(scene, frame_id))
            batches.append(await self._detecting.batch(earlier, [word], None, late=True))
        return tags, gate, batches

    async def _skip(self, lease: Lease, stored: StoredFrame, progress: _Progress) -> _Progress:
        after = progress.passed_over()
        await self._store.commit(lease, stored.log_id, [], after.puts())
        return after

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
