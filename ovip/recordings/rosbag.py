"""Layouts `ros1` and `ros2`: ROS bags, a .bag file, or a folder with metadata.yaml (or a .mcap or .db3 file).

Topics are found by type and name, or named by options. Depth: 16UC1 is millimetres, 32FC1 metres (rounded to
millimetres), 0 and NaN = none; it must be registered to colour: same size, same optical frame. Pose: from /tf
(the camera's optical frame under map, world or odom), or from a topic of Odometry or poses, with the way from
its frame to the camera on /tf_static or given as extrinsic. Camera: ROS's optical frame, x right, y down, z
forward. World: ROS's, z up. Time: the colour image's stamp; depth is the nearest within max_dt, the pose is
interpolated. Lens distortion is not undone.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ovip.errors import InvalidInput
from ovip.recordings.layout import Contents, ListedFrame, Options
from ovip.recordings.rosbag_camera import camera_of
from ovip.recordings.rosbag_file import FILE_SUFFIXES, Bag, BagMessage
from ovip.recordings.rosbag_images import DEPTH_SCALE, BagImage, color_image, depth_image
from ovip.recordings.rosbag_poses import PoseTrack, Transforms, frame_name, parse_extrinsic, pose_of
from ovip.recordings.rosbag_topics import ODOMETRY, TF_TOPICS, TRANSFORM, Topics, choose_topics
from ovip.recordings.tum import associate
from ovip.recordings.up import Up
from ovip.scene.types import F64

OPTIONS = {
    "color_topic": "colour images (found by name)",
    "depth_topic": "depth images, registered to colour (found by name)",
    "info_topic": "CameraInfo of the colour camera (found by name)",
    "pose_topic": "Odometry, PoseStamped, PoseWithCovarianceStamped or TransformStamped (else /tf)",
    "fixed_frame": "the world's frame on /tf (map, world, odom or the root)",
    "base_frame": "the frame that pose_topic moves (Odometry names it; else the camera)",
    "camera_frame": "the camera's optical frame (the colour image's)",
    "extrinsic": "x,y,z,qx,qy,qz,qw of the camera in the frame that pose_topic moves (else /tf_static)",
    "intrinsics": "fx,fy,cx,cy where there is no CameraInfo",
    "max_dt": "seconds between colour and depth, and colour and pose, at most (0.05)",
    "registered": "yes: depth is seen from the colour camera though its frame has another name",
}
_WORLDS = ("map", "world", "odom")
PoseAt = Callable[[int], F64 | None]


@dataclass(slots=True, eq=False)
class _Seen:
    """What one pass over a bag found."""

    colors: list[BagImage] = field(default_factory=list)
    depths: list[BagImage] = field(default_factory=list)
    info: Any = None
    color_frame: str = ""
    depth_frame: str = ""
    moved_frame: str = ""
    poses: list[tuple[int, F64]] = field(default_factory=list)
    transforms: Transforms = field(default_factory=Transforms)


class RosBag:
    """Reads ROS bags of one generation."""

    options: Options = OPTIONS
    up: Up = None

    def __init__(self, name: str, expects: str, fits: Callable[[Path], bool]) -> None:
        self.name, self.expects, self._fits = name, expects, fits

    def fits(self, path: Path) -> bool:
        return self._fits(path)

    def read(self, path: Path, options: Options) -> Contents:
        max_dt = round(_seconds(options.get("max_dt", "0.05")) * 1e9)
        bag = Bag(path)
        try:
            topics = choose_topics(bag.topics, options)
            seen = _pass_over(bag, topics)
            _check_registered(seen, topics, options)
            intrinsics, notes = camera_of(seen.info, seen.colors, options)
            pose_at, pose_note = _poses(seen, topics, options, max_dt)
        except InvalidInput as error:
            raise InvalidInput(f"{path}: {str(error).removeprefix(f'{path}: ')}") from error
        frames = _frames(seen, pose_at, max_dt)
        chosen = f"colour {topics.color}, depth {topics.depth}, camera {topics.info or 'by option'}"
        return Contents(intrinsics, DEPTH_SCALE, frames, notes=(f"{chosen}, {pose_note}", *notes))


def _is_ros2(path: Path) -> bool:
    return (path / "metadata.yaml").is_file() or (path.is_file() and path.suffix in FILE_SUFFIXES)


ROS1 = RosBag("ros1", "a .bag file", lambda path: path.is_file() and path.suffix == ".bag")
ROS2 = RosBag("ros2", "a folder with metadata.yaml and .db3 or .mcap files, or one such file", _is_ros2)


def _pass_over(bag: Bag, topics: Topics) -> _Seen:
    seen = _Seen()
    wanted = {topics.color, topics.depth, topics.info, topics.pose, *TF_TOPICS} - {None}
    for message in bag.messages({name for name in wanted if name}):
        if message.topic == topics.color:
            seen.colors.append(color_image(bag, message))
            seen.color_frame = frame_name(message.value.header.frame_id)
        elif message.topic == topics.depth:
            seen.depths.append(depth_image(bag, message))
            seen.depth_frame = frame_name(message.value.header.frame_id)
        elif message.topic == topics.info:
            seen.info = seen.info or message.value
        elif message.topic == topics.pose:
            _add_pose(seen, message, bag.topics[message.topic])
        else:
            seen.transforms.add(message.value, fixed=message.topic == "/tf_static")
    return seen


def _add_pose(seen: _Seen, message: BagMessage, kind: str) -> None:
    value = message.value
    if kind in (ODOMETRY, TRANSFORM):
        seen.moved_frame = frame_name(value.child_frame_id)
    if kind == TRANSFORM:
        pose = pose_of(value.transform.translation, value.transform.rotation)
    else:
        plain = value.pose.pose if hasattr(value.pose, "pose") else value.pose
        pose = pose_of(plain.position, plain.orientation)
    seen.poses.append((message.stamp_ns, pose))


def _check_registered(seen: _Seen, topics: Topics, options: Options) -> None:
    color, depth = seen.colors[0].header(), seen.depths[0].header()
    hint = (
        "record the depth that the driver registers to colour (aligned_depth_to_color, depth_registered), and "
        "name it by depth_topic"
    )
    if color and depth and (color.width, color.height) != (depth.width, depth.height):
        raise InvalidInput(
            f"expected depth registered to colour, got {depth.width}x{depth.height} on {topics.depth} and "
            f"{color.width}x{color.height} on {topics.color}; {hint}"
        )
    said = topics.registered or options.get("registered") == "yes"
    if seen.color_frame != seen.depth_frame and not said:
        raise InvalidInput(
            f"expected depth registered to colour, got depth seen from {seen.depth_frame!r} and colour from "
            f"{seen.color_frame!r}; {hint}, or say registered=yes where the two frames are one camera"
        )


def _poses(seen: _Seen, topics: Topics, options: Options, max_dt: int) -> tuple[PoseAt, str]:
    """world_from_camera at a time, and where it comes from in words."""
    camera = frame_name(options.get("camera_frame", seen.color_frame))
    if topics.pose is None:
        return _poses_of_tree(seen.transforms, camera, options, max_dt)
    track = PoseTrack.of(seen.poses)
    base_from_camera, note = _mounting(seen, camera, options, max_dt)

    def pose_at(time: int) -> F64 | None:
        base, mounted = track.at(time, max_dt), base_from_camera(time)
        return None if base is None or mounted is None else np.asarray(base @ mounted)

    return pose_at, f"poses {topics.pose} {note}"


def _poses_of_tree(tree: Transforms, camera: str, options: Options, max_dt: int) -> tuple[PoseAt, str]:
    chain = tree.chain(camera)
    asked = options.get("fixed_frame")
    world = asked or next((name for name in _WORLDS if name in chain), chain[-1])
    if world not in chain or world == camera:
        raise InvalidInput(
            f"expected the camera's frame {camera!r} under {world!r} on /tf, got {' < '.join(chain)}; name the "
            "world by fixed_frame and the camera by camera_frame, or poses by pose_topic"
        )
    if asked is None and not tree.moves(camera, world):
        raise InvalidInput(
            f"expected the camera to move on /tf, but {camera!r} is fixed in {world!r}; name the topic of its "
            "poses by pose_topic (or fixed_frame, where it stands still)"
        )
    return lambda time: tree.between(world, camera, time, max_dt), f"poses /tf {world} < {camera}"


def _mounting(seen: _Seen, camera: str, options: Options, max_dt: int) -> tuple[PoseAt, str]:
    """base_from_camera at a time, and where it comes from in words."""
    given = options.get("extrinsic")
    if given is not None:
        extrinsic = parse_extrinsic(given)
        return lambda _: extrinsic, "with the extrinsic given"
    base = frame_name(options.get("base_frame", seen.moved_frame))
    if base in ("", camera):
        return lambda _: np.eye(4), "taken as the camera's own"
    if not seen.transforms.joined(base, camera):
        raise InvalidInput(
            f"expected the way from {base!r} to the camera's frame {camera!r} on /tf_static, got none; give "
            "extrinsic, or base_frame and camera_frame"
        )
    return lambda time: seen.transforms.between(base, camera, time, max_dt), f"and /tf {base} < {camera}"


def _frames(seen: _Seen, pose_at: PoseAt, max_dt: int) -> tuple[ListedFrame, ...]:
    times = np.array([image.stamp_ns for image in seen.colors], np.int64)
    partner = associate(times, np.array([image.stamp_ns for image in seen.depths], np.int64), max_dt)
    frames = [
        ListedFrame(
            name=f"{image.stamp_ns / 1e9:.6f}",
            timestamp_ns=image.stamp_ns,
            pose=pose_at(image.stamp_ns),
            rgb=image,
            depth=seen.depths[at] if at >= 0 else None,
        )
        for image, at in zip(seen.colors, partner.tolist(), strict=True)
    ]
    return tuple(sorted(frames, key=lambda frame: frame.timestamp_ns))


def _seconds(word: str) -> float:
    try:
        seconds = float(word)
    except ValueError:
        seconds = math.nan
    if not (math.isfinite(seconds) and seconds > 0):
        raise InvalidInput(f"option max_dt: expected seconds above 0, got {word!r}")
    return seconds
