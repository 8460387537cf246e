"""Where the camera was, by ROS: tracks of poses, and the tree of transforms on /tf and /tf_static."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np

from ovip.errors import InvalidInput
from ovip.recordings.text import parse_numbers
from ovip.recordings.tum import pose_of_quaternion
from ovip.scene.types import F64, I64


@dataclass(frozen=True, slots=True, eq=False)
class PoseTrack:
    """Poses `(N, 4, 4)` at rising times `(N,)` in nanoseconds."""

    times: I64
    poses: F64

    @classmethod
    def of(cls, timed: list[tuple[int, F64]]) -> PoseTrack:
        """From times and poses in any order, those that are not finite left out; of several at one time the
        first counts."""
        timed = [(time, pose) for time, pose in timed if np.isfinite(pose).all()]
        times, first = np.unique(np.array([time for time, _ in timed], np.int64), return_index=True)
        return cls(times, np.array([timed[at][1] for at in first]).reshape(-1, 4, 4))

    def at(self, time: int, max_dt: int) -> F64 | None:
        """The pose at `time`: between its neighbours where they are at most 2 `max_dt` apart, else the
        nearest within `max_dt`; None where there is none."""
        right = int(np.searchsorted(self.times, time))
        if right < len(self.times) and self.times[right] == time:
            return np.asarray(self.poses[right])
        if 0 < right < len(self.times) and self.times[right] - self.times[right - 1] <= 2 * max_dt:
            share = (time - self.times[right - 1]) / (self.times[right] - self.times[right - 1])
            return _between(self.poses[right - 1], self.poses[right], float(share))
        near = [at for at in (right - 1, right) if 0 <= at < len(self.times)]
        best = min(near, key=lambda at: abs(int(self.times[at]) - time), default=None)
        if best is None or abs(int(self.times[best]) - time) > max_dt:
            return None
        return np.asarray(self.poses[best])


class Transforms:
    """The tree of coordinate frames: of each the pose in its parent, fixed or at many times."""

    def __init__(self) -> None:
        self._fixed: dict[str, tuple[str, F64]] = {}
        self._timed: defaultdict[str, list[tuple[int, F64]]] = defaultdict(list)
        self._parents: dict[str, str] = {}
        self._tracks: dict[str, PoseTrack] = {}

    def add(self, message: Any, fixed: bool) -> None:
        """A tf2_msgs/TFMessage; `fixed`: from /tf_static."""
        for item in message.transforms:
            parent, child = frame_name(item.header.frame_id), frame_name(item.child_frame_id)
            pose = pose_of(item.transform.translation, item.transform.rotation)
            self._parents[child] = parent
            if fixed:
                self._fixed[child] = (parent, pose)
            else:
                stamp = int(item.header.stamp.sec) * 1_000_000_000 + int(item.header.stamp.nanosec)
                self._timed[child].append((stamp, pose))

    def chain(self, frame: str) -> tuple[str, ...]:
        """`frame` and all above it, the root last."""
        names = [frame]
        while names[-1] in self._parents and self._parents[names[-1]] not in names:
            names.append(self._parents[names[-1]])
        return tuple(names)

    def moves(self, frame: str, root: str) -> bool:
        """Whether anything between `frame` and `root` above it changes with time."""
        chain = self.chain(frame)
        return any(name in self._timed for name in chain[: chain.index(root)])

    def joined(self, first: str, second: str) -> bool:
        """Whether the two are in one tree."""
        return self.chain(first)[-1] == self.chain(second)[-1]

    def between(self, target: str, source: str, time: int, max_dt: int) -> F64 | None:
        """target_from_source `(4, 4)` at `time`; None where a transform on the way has no value then."""
        ups, downs = self.chain(source), self.chain(target)
        common = next((name for name in ups if name in downs), None)
        if common is None:
            return None
        source_pose = self._above(ups[: ups.index(common)], time, max_dt)
        target_pose = self._above(downs[: downs.index(common)], time, max_dt)
        if source_pose is None or target_pose is None:
            return None
        return np.asarray(np.linalg.inv(target_pose) @ source_pose)

    def _above(self, names: tuple[str, ...], time: int, max_dt: int) -> F64 | None:
        """Pose of the first of `names` in the parent of the last."""
        pose = np.eye(4)
        for name in names:
            step = self._step(name, time, max_dt)
            if step is None:
                return None
            pose = step @ pose
        return pose

    def _step(self, name: str, time: int, max_dt: int) -> F64 | None:
        if name in self._timed:
            if name not in self._tracks:
                self._tracks[name] = PoseTrack.of(self._timed[name])
            return self._tracks[name].at(time, max_dt)
        return self._fixed[name][1]


def frame_name(name: str) -> str:
    """A frame's name as ROS 2 writes it, without ROS 1's leading slash."""
    return name.lstrip("/")


def pose_of(position: Any, orientation: Any) -> F64:
    """`(4, 4)` of a ROS position (x, y, z) and quaternion (x, y, z, w); NaN where the quaternion has no length."""
    p, q = position, orientation
    return pose_of_quaternion(np.array([p.x, p.y, p.z, q.x, q.y, q.z, q.w], np.float64))


def parse_extrinsic(text: str) -> F64:
    """`x,y,z,qx,qy,qz,qw` as typed -> base_from_camera `(4, 4)`."""
    numbers = parse_numbers(text, "option extrinsic")
    pose = pose_of_quaternion(numbers) if numbers.size == 7 else np.full((4, 4), np.nan)
    if not np.isfinite(pose).all():
        raise InvalidInput(
            f"option extrinsic: expected x,y,z,qx,qy,qz,qw of the camera in its base, got {text!r}"
        )
    return pose


def _between(first: F64, second: F64, share: float) -> F64:
    turn = cv2.Rodrigues(first[:3, :3].T @ second[:3, :3])[0]
    pose = np.eye(4)
    pose[:3, :3] = first[:3, :3] @ cv2.Rodrigues(share * turn)[0]
    pose[:3, 3] = (1 - share) * first[:3, 3] + share * second[:3, 3]
    return pose
