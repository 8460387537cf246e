"""Which topics of a bag hold the colour, the depth, the camera and the poses: named by options, or found."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from itertools import takewhile

from ovip.errors import InvalidInput
from ovip.recordings.layout import Options
from ovip.recordings.rosbag_images import COMPRESSED, IMAGE

INFO = "sensor_msgs/msg/CameraInfo"
TFS = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")
ODOMETRY, TRANSFORM = "nav_msgs/msg/Odometry", "geometry_msgs/msg/TransformStamped"
POSE, POSE_WITH_COVARIANCE = "geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/PoseWithCovarianceStamped"
POSES = (ODOMETRY, POSE, POSE_WITH_COVARIANCE, TRANSFORM)
TF_TOPICS = ("/tf", "/tf_static")
_OTHER_IMAGES = ("depth", "infra", "/ir", "mask", "label", "semantic", "instance", "disparity", "confidence")


@dataclass(frozen=True, slots=True)
class Topics:
    """Names of topics; info None: there is no CameraInfo; pose None: poses come from /tf."""

    color: str
    depth: str
    info: str | None
    pose: str | None

    @property
    def registered(self) -> bool:
        """Whether the depth topic's name says that its depth is seen from the colour camera."""
        return "aligned" in self.depth or "registered" in self.depth


def choose_topics(types: dict[str, str], options: Options) -> Topics:
    """The topics to read of those in a bag (name -> type); InvalidInput lists what is there."""
    images = (IMAGE, COMPRESSED)
    color = _named("color_topic", images, types, options) or _color(types)
    depth = _named("depth_topic", images, types, options) or _depth(types)
    info = _named("info_topic", (INFO,), types, options) or _info(color, types)
    pose = _named("pose_topic", POSES, types, options)
    if pose is None and not any(types.get(name) in TFS for name in TF_TOPICS):
        pose = _only_pose(types)
    return Topics(color, depth, info, pose)


def listed(types: dict[str, str]) -> str:
    """The topics of a bag in words."""
    return ", ".join(f"{name} ({kind.rpartition('/')[2]})" for name, kind in sorted(types.items())) or "none"


def _named(option: str, kinds: Collection[str], types: dict[str, str], options: Options) -> str | None:
    name = options.get(option)
    if name is not None and types.get(name) not in kinds:
        wanted = " or ".join(kind.rpartition("/")[2] for kind in kinds)
        raise InvalidInput(
            f"option {option}: expected a topic of {wanted} in the bag, got {name!r}; it has {listed(types)}"
        )
    return name


def _color(types: dict[str, str]) -> str:
    found = [
        name
        for name, kind in types.items()
        if kind in (IMAGE, COMPRESSED) and not any(word in name.lower() for word in _OTHER_IMAGES)
    ]
    if not found:
        raise InvalidInput(
            f"expected a topic of colour images; name it by color_topic. There is {listed(types)}"
        )
    return min(found, key=lambda name: (not _says_color(name), types[name] != IMAGE, len(name), name))


def _says_color(name: str) -> bool:
    return any(word in name.lower() for word in ("rgb", "color", "colour"))


def _depth(types: dict[str, str]) -> str:
    found = [
        name
        for name, kind in types.items()
        if kind in (IMAGE, COMPRESSED) and "depth" in name.lower() and "confidence" not in name.lower()
    ]
    if not found:
        raise InvalidInput(
            f"expected a topic of depth images; name it by depth_topic. There is {listed(types)}"
        )
    return min(
        found,
        key=lambda name: (
            not ("aligned" in name or "registered" in name),
            types[name] != IMAGE,
            "compressedDepth" not in name,
            len(name),
            name,
        ),
    )


def _info(color: str, types: dict[str, str]) -> str | None:
    """The CameraInfo whose name has most in common with the colour topic's."""
    infos = [name for name, kind in types.items() if kind == INFO]
    if len(infos) == 1:
        return infos[0]
    return max(infos, key=lambda name: (_shared(name, color), name), default=None)


def _shared(first: str, second: str) -> int:
    """How many parts two names have in common from the start."""
    same = (a == b for a, b in zip(first.split("/"), second.split("/"), strict=False))
    return sum(1 for _ in takewhile(bool, same))


def _only_pose(types: dict[str, str]) -> str:
    found = sorted(name for name, kind in types.items() if kind in POSES)
    if len(found) != 1:
        what = f"several: {', '.join(found)}" if found else f"none; there is {listed(types)}"
        raise InvalidInput(f"expected /tf or one topic of poses, got {what}; name it by pose_topic")
    return found[0]
