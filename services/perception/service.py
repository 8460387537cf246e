"""What perception does for others: takes frames in, shows its history, grounds words in it."""

from __future__ import annotations

import asyncio
import dataclasses
import json
import re
from collections.abc import AsyncIterator, Sequence
from dataclasses import dataclass

import numpy as np

from ovip import keys
from ovip.errors import Conflict, InvalidInput, NotFound
from ovip.scene.answers import FrameRecord, PerceptionStatus
from ovip.scene.camera import check_intrinsics, check_pose
from ovip.scene.types import F32, F64, Detection, Intrinsics
from ovip.scene.words import normalize_word
from ovip.store import Store
from ovip.telemetry import get_logger
from ovip.wire import decode_depth, decode_rgb
from services.perception.config import Settings
from services.perception.detecting import Detecting
from services.perception.history import (
    DETECTIONS,
    FRAMES,
    STAGE,
    FrameHistory,
    Images,
    StoredFrame,
    Upload,
    entry_fields,
)
from services.perception.onboard import OnboardDetection, check_onboard, decode_onboard, encode_onboard

MOST_GROUNDED_FRAMES = 64
MOST_WORDS = 32
MOST_TEXTS = 512
_CREDITS_SECONDS = 0.2  # how long a count of the backlog holds: acks need not ask the store each time
_LATEST_TIMESTAMP_NS = 2**63 - 1
log = get_logger("perception")


@dataclass(frozen=True, slots=True)
class Session:
    """A robot's stream into a scene: its names are checked, its camera plausible."""

    scene: str
    robot_id: str
    session_id: str
    intrinsics: Intrinsics

    @property
    def name(self) -> str:
        return f"{self.robot_id}.{self.session_id}"

    def frame_id(self, sequence: int) -> str:
        return f"{self.name}.{sequence:08d}"


@dataclass(frozen=True, slots=True)
class Durable:
    """A frame that survives a crash from now on."""

    frame_id: str
    duplicate: bool


class Perception:
    """The use cases of the service."""

    def __init__(
        self, store: Store, detecting: Detecting, settings: Settings, history: FrameHistory | None = None
    ) -> None:
        self._store = store
        self._detecting = detecting
        self._settings = settings
        self._credits: dict[str, tuple[float, int]] = {}
        self.history = history or FrameHistory(store)

    async def open_session(
        self, scene: str, robot_id: str, session_id: str, intrinsics: Intrinsics, world_from_source: F64
    ) -> tuple[Session, int]:
        """Makes the scene known and returns the session with its last durable sequence."""
        session = Session(
            keys.check_name(scene, "scene"),
            keys.check_name(robot_id, "robot_id"),
            keys.check_name(session_id, "session_id"),
            check_intrinsics(intrinsics),
        )
        await self._remember_source(scene, check_pose(world_from_source))
        await self._store.add_scene(scene)
        return session, await self._store.last_sequence(scene, session.name)

    async def check(
        self, session: Session, upload: Upload, onboard: Sequence[OnboardDetection] | None
    ) -> Upload:
        """The frame as it may be kept; InvalidInput says what is wrong with it, and the session goes on."""
        return await asyncio.to_thread(self._check, session, upload, onboard)

    async def keep(
        self, session: Session, upload: Upload, after: asyncio.Task[None] | None = None
    ) -> Durable:
        """Syncs a checked frame's images and appends it to the log; again for the same sequence changes nothing.

        after: what must have ended well before it is appended. InvalidInput for a sequence that the session has
        passed over: the frame is not kept.
        """
        bulk = (upload.rgb, upload.depth, upload.onboard)
        refs = await asyncio.gather(*(self._store.blobs.put(data) for data in bulk if data))
        frame_id = session.frame_id(upload.sequence)
        onboard_ref = refs[2] if upload.onboard else ""
        fields = entry_fields(frame_id, upload, session.intrinsics, refs[0], refs[1], onboard_ref)
        if upload.images:
            self.history.expect(refs[0], refs[1], upload.depth_scale, upload.images)
        if after:
            await after
        taken = await self._store.ingest(session.scene, session.name, upload.sequence, frame_id, fields)
        if not taken.log_id:
            last = await self._store.last_sequence(session.scene, session.name)
            raise InvalidInput(f"sequence: expected above {last}, the session's last, got {upload.sequence}")
        return Durable(frame_id, taken.duplicate)

    async def credits(self, scene: str) -> int:
        """How many frames a stream may have in flight: the window, down to one as the backlog fills."""
        now = asyncio.get_running_loop().time()
        counted_at, credits = self._credits.get(scene, (-_CREDITS_SECONDS, 1))
        if now - counted_at >= _CREDITS_SECONDS:
            durable = await self._store.length(scene, FRAMES)
            processed, skipped, _ = await self._counts(scene)
            room = self._settings.max_backlog - (durable - processed - skipped)
            credits = int(np.clip(room, 1, self._settings.window))
            self._credits[scene] = (now, credits)
        return credits

    async def applied(self, session: Session, after: str) -> AsyncIterator[str]:
        """Frame ids of a session as the mapper commits them, from a map log id on, for ever."""
        while True:
            for entry in await self._store.read(session.scene, "map", after, count=200, block_ms=1000):
                after = entry.id
                frame_id = entry.fields["frame_id"].decode()
                if frame_id.startswith(f"{session.name}."):
                    yield frame_id

    async def newest_map_entry(self, scene: str) -> str:
        """Where the map log stands now."""
        newest = await self._store.newest(scene, "map")
        return newest[0].id if newest else "0-0"

    async def list_frames(
        self, scene: str, after: str, limit: int
    ) -> tuple[list[FrameRecord], dict[str, F32]]:
        """Frames of the history, and the text feature of every tag among them."""
        await self._check_known(scene)
        if after and not _is_log_id(after):
            raise InvalidInput(
                f"after_log_id: expected an id like 1700000000000-0 from an earlier answer, got {after[:80]!r}"
            )
        frames = await self.history.records(scene, after, min(limit or 1000, 1000))
        words = sorted({word for frame in frames for word in frame.tags})
        features = await self._detecting.models.encoder.embed_texts(words)
        return frames, dict(zip(words, features, strict=True))

    async def find_frame(self, scene: str, frame_id: str) -> tuple[StoredFrame, FrameRecord]:
        """One frame of the history."""
        await self._check_known(scene)
        stored = await self.history.find(scene, frame_id)
        tags = await self.history.tags(scene, [frame_id])
        return stored, stored.record(tags.get(frame_id))

    async def blob(self, ref: str) -> bytes:
        return await self._store.blobs.get(ref)

    async def ground(
        self, scene: str, frame_ids: Sequence[str], words: Sequence[str]
    ) -> tuple[dict[str, tuple[Detection, ...]], tuple[str, ...]]:
        """Detections of words in frames of the history, past the gate; and the words the grounder cannot see."""
        await self._check_known(scene)
        if len(frame_ids) > MOST_GROUNDED_FRAMES:
            raise InvalidInput(
                f"frame_ids: expected at most {MOST_GROUNDED_FRAMES}, got {len(frame_ids)}: ask in batches"
            )
        if not 1 <= len(words) <= MOST_WORDS or not all(word.strip() for word in words):
            raise InvalidInput(f"words: expected 1 to {MOST_WORDS} non-empty words, got {len(words)}")
        wanted = [normalize_word(word) for word in words]
        grounded: dict[str, tuple[Detection, ...]] = {}
        seen_on_board: set[str] = set()
        by_models_too = False
        for frame_id in frame_ids:
            stored = await self.history.find(scene, frame_id)
            onboard = await self.onboard_of(stored)
            by_models_too |= onboard is None
            seen_on_board |= {d.label for d in onboard or ()}
            grounded[frame_id] = await self._detecting.detect(
                await self.history.load(stored), wanted, onboard
            )
        by_models_too |= not frame_ids
        groundable = self._detecting.models.grounder.groundable
        blind = tuple(w for w in wanted if w not in seen_on_board and not (by_models_too and groundable(w)))
        return grounded, blind

    async def embed_text(self, texts: Sequence[str]) -> F32:
        """Unit features `(N, D)`."""
        if not 1 <= len(texts) <= MOST_TEXTS:
            raise InvalidInput(f"texts: expected 1 to {MOST_TEXTS}, got {len(texts)}")
        if any(not text.strip() or len(text) > 1000 for text in texts):
            raise InvalidInput("texts: expected 1 to 1000 characters each")
        return await self._detecting.models.encoder.embed_texts(texts)

    async def status(self, scene: str) -> PerceptionStatus:
        """Where perception stands with a scene."""
        await self._check_known(scene)
        processed, skipped, detections = await self._counts(scene)
        values = await self._store.values(scene, STAGE, ["vocabulary"])
        newest = await self._store.newest(scene, DETECTIONS)
        source = await self._store.load_document(scene, "scene", "world_from_source")
        return PerceptionStatus(
            frames_durable=await self._store.length(scene, FRAMES),
            frames_processed=processed,
            frames_skipped=skipped,
            vocabulary=tuple(json.loads(values.get("vocabulary", b"[]"))),
            world_from_source=np.frombuffer(source.data, "<f8").reshape(4, 4) if source else np.eye(4),
            backend=self._detecting.models.name,
            feature_space=self.feature_space,
            detections=detections,
            newest_detections_id=newest[0].id if newest else "",
        )

    @property
    def feature_space(self) -> str:
        return self._detecting.models.encoder.space

    async def onboard_of(self, stored: StoredFrame) -> tuple[OnboardDetection, ...] | None:
        """The robot's own detections of a frame; None where it sent none."""
        return decode_onboard(await self._store.blobs.get(stored.onboard_ref)) if stored.onboard_ref else None

    def _check(self, session: Session, upload: Upload, onboard: Sequence[OnboardDetection] | None) -> Upload:
        if not 1 <= upload.sequence < 10**8:
            raise InvalidInput(f"sequence: expected 1 to 99999999, got {upload.sequence}")
        if not 0 <= upload.timestamp_ns <= _LATEST_TIMESTAMP_NS:
            raise InvalidInput(
                f"timestamp_ns: expected nanoseconds since the epoch, got {upload.timestamp_ns}"
            )
        check_pose(upload.world_from_camera)
        rgb = decode_rgb(upload.rgb, session.intrinsics)
        depth = decode_depth(upload.depth, upload.depth_encoding, upload.depth_scale, session.intrinsics)
        upload = dataclasses.replace(upload, images=Images(rgb, depth))
        if onboard is None and self._detecting.models.name == "given":
            raise InvalidInput(
                "this stack runs OVIP_MODELS=given: expected detections made on board with every frame"
            )
        if onboard is None:
            return upload
        models = self._detecting.models
        second = models.second_encoder.dimension if models.second_encoder else 0
        kept = check_onboard(onboard, session.intrinsics, models.encoder.dimension, second)
        return dataclasses.replace(upload, onboard=encode_onboard(kept))

    async def _remember_source(self, scene: str, world_from_source: F64) -> None:
        data = world_from_source.astype("<f8").tobytes()
        known = await self._store.load_document(scene, "scene", "world_from_source")
        if known is None:
            try:
                await self._store.save_document(scene, "scene", "world_from_source", data, 0)
                return
            except Conflict:  # another robot was first
                known = await self._store.load_document(scene, "scene", "world_from_source")
        if known and np.abs(np.frombuffer(known.data, "<f8") - world_from_source.ravel()).max() > 1e-6:
            raise InvalidInput(
                f"scene {scene} was begun with another world_from_source: expected the same rotation to z-up "
                "(pass the same --up), or another scene name"
            )

    async def _counts(self, scene: str) -> tuple[int, int, int]:
        values = await self._store.values(scene, STAGE, ["processed", "skipped", "detections"])
        return tuple(int(values.get(name, 0)) for name in ("processed", "skipped", "detections"))  # type: ignore[return-value]

    async def _check_known(self, scene: str) -> None:
        keys.check_name(scene, "scene")
        scenes = await self._store.scenes()
        if scene not in scenes:
            raise NotFound(f"there is no scene {scene!r}; known: {', '.join(scenes) or 'none yet'}")


def _is_log_id(text: str) -> bool:
    return re.fullmatch(r"[0-9]{1,15}-[0-9]{1,15}", text) is not None
