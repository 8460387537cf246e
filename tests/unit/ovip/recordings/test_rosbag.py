"""Layouts ros1 and ros2: bags written here with rosbags' own writers."""

from __future__ import annotations

import struct
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from ovip.errors import InvalidInput, NotConfigured
from ovip.recordings import open_recording
from ovip.recordings.images import decode_raw_depth
from ovip.scene.types import F64, Intrinsics

pytest.importorskip("rosbags", reason="the package rosbags is not here: reading ROS bags was not tested")

from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

WIDTH, HEIGHT = 64, 48
START = 1_700_000_000_000_000_000
OPTICAL = "camera_color_optical_frame"
SECOND = 1_000_000_000


@dataclass
class Script:
    """What to write: (topic, type, bag time, message); `ros1` chooses types."""

    ros1: bool
    written: list[tuple[str, str, int, Any]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.store = get_typestore(Stores.ROS1_NOETIC if self.ros1 else Stores.ROS2_HUMBLE)
        if self.ros1:
            transforms = "geometry_msgs/TransformStamped[] transforms"
            self.store.register(get_types_from_msg(transforms, "tf2_msgs/msg/TFMessage"))

    def make(self, kind: str, **fields: Any) -> Any:
        return self.store.types[kind](**fields)

    def header(self, time: int, frame: str) -> Any:
        stamp = self.make("builtin_interfaces/msg/Time", sec=time // SECOND, nanosec=time % SECOND)
        extra = {"seq": 0} if self.ros1 else {}
        return self.make("std_msgs/msg/Header", stamp=stamp, frame_id=frame, **extra)

    def add(self, topic: str, kind: str, time: int, **fields: Any) -> None:
        # recorded 3 ms after it was measured
        self.written.append((topic, kind, time + 3_000_000, self.make(kind, **fields)))

    def image(
        self, topic: str, time: int, frame: str, encoding: str, pixels: np.ndarray, pad: int = 0
    ) -> None:
        rows = np.ascontiguousarray(pixels).view(np.uint8).reshape(pixels.shape[0], -1)
        rows = np.pad(rows, ((0, 0), (0, pad)))
        self.add(
            topic,
            "sensor_msgs/msg/Image",
            time,
            header=self.header(time, frame),
            height=pixels.shape[0],
            width=pixels.shape[1],
            encoding=encoding,
            is_bigendian=0,
            step=rows.shape[1],
            data=rows.ravel(),
        )

    def compressed(self, topic: str, time: int, frame: str, format_: str, data: bytes) -> None:
        self.add(
            topic,
            "sensor_msgs/msg/CompressedImage",
            time,
            header=self.header(time, frame),
            format=format_,
            data=np.frombuffer(data, np.uint8),
        )

    def info(self, topic: str, time: int, distortion: Sequence[float] = (0, 0, 0, 0, 0)) -> None:
        k = np.array([60, 0, 31.5, 0, 61, 23.5, 0, 0, 1], np.float64)
        names = ("D", "K", "R", "P") if self.ros1 else ("d", "k", "r", "p")
        values = (np.array(distortion, np.float64), k, np.eye(3).ravel(), np.eye(3, 4).ravel())
        roi = self.make(
            "sensor_msgs/msg/RegionOfInterest", x_offset=0, y_offset=0, height=0, width=0, do_rectify=False
        )
        self.add(
            topic,
            "sensor_msgs/msg/CameraInfo",
            time,
            header=self.header(time, OPTICAL),
            height=HEIGHT,
            width=WIDTH,
            distortion_model="plumb_bob",
            binning_x=0,
            binning_y=0,
            roi=roi,
            **dict(zip(names, values, strict=True)),
        )

    def _spot(self, pose: F64, kind: str, keys: tuple[str, str]) -> Any:
        x, y, z = map(float, pose[:3, 3])
        point = "geometry_msgs/msg/Point" if kind.endswith("Pose") else "geometry_msgs/msg/Vector3"
        turn = dict(zip("xyzw", map(float, _quaternion(pose[:3, :3])), strict=True))
        place = self.make(point, x=x, y=y, z=z)
        return self.make(kind, **{keys[0]: place, keys[1]: self.make("geometry_msgs/msg/Quaternion", **turn)})

    def pose(self, pose: F64) -> Any:
        return self._spot(pose, "geometry_msgs/msg/Pose", ("position", "orientation"))

    def stamped_transform(self, time: int, parent: str, child: str, pose: F64) -> Any:
        transform = self._spot(pose, "geometry_msgs/msg/Transform", ("translation", "rotation"))
        return self.make(
            "geometry_msgs/msg/TransformStamped",
            header=self.header(time, parent),
            child_frame_id=child,
            transform=transform,
        )

    def tf(self, time: int, parent: str, child: str, pose: F64, static: bool = False) -> None:
        one = [self.stamped_transform(time, parent, child, pose)]
        self.add("/tf_static" if static else "/tf", "tf2_msgs/msg/TFMessage", time, transforms=one)

    def odometry(self, topic: str, time: int, child: str, pose: F64) -> None:
        zero = self.make("geometry_msgs/msg/Vector3", x=0.0, y=0.0, z=0.0)
        twist = self.make("geometry_msgs/msg/Twist", linear=zero, angular=zero)
        none = np.zeros(36)
        self.add(
            topic,
            "nav_msgs/msg/Odometry",
            time,
            header=self.header(time, "odom"),
            child_frame_id=child,
            pose=self.make("geometry_msgs/msg/PoseWithCovariance", pose=self.pose(pose), covariance=none),
            twist=self.make("geometry_msgs/msg/TwistWithCovariance", twist=twist, covariance=none),
        )

    def camera_pose(self, topic: str, time: int, pose: F64) -> None:
        kind = "geometry_msgs/msg/PoseStamped"
        self.add(topic, kind, time, header=self.header(time, "map"), pose=self.pose(pose))

    def write(self, path: Path) -> Path:
        with Writer1(path) if self.ros1 else Writer2(path, version=9) as writer:
            connections: dict[str, Any] = {}
            for topic, kind, time, message in sorted(self.written, key=lambda item: item[2]):
                if topic not in connections:
                    connections[topic] = writer.add_connection(topic, kind, typestore=self.store)
                serialize = self.store.serialize_ros1 if self.ros1 else self.store.serialize_cdr
                writer.write(connections[topic], time, serialize(message, kind))
        return path


def _quaternion(r: F64) -> F64:
    vector = cv2.Rodrigues(np.ascontiguousarray(r))[0].ravel()
    angle = float(np.linalg.norm(vector))
    axis = vector / angle if angle > 1e-12 else np.zeros(3)
    return np.array([*(np.sin(angle / 2) * axis), np.cos(angle / 2)])


def base_at(time: int) -> F64:
    """Half a metre a second along x, a third of a radian a second to the left."""
    t = (time - START) / SECOND
    pose = np.eye(4)
    pose[:3, :3] = cv2.Rodrigues(np.array([0, 0, t / 3]))[0]
    pose[:3, 3] = [t / 2, 0, 0]
    return pose


def mounted() -> F64:
    """Optical frame 1.2 m above the base, looking along the base's x."""
    pose = np.eye(4)
    pose[:3, :3] = [[0, 0, 1], [-1, 0, 0], [0, -1, 0]]
    pose[:3, 3] = [0.1, 0, 1.2]
    return pose


def color(seed: int) -> np.ndarray:
    image = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    image[:] = (200, 40 + 30 * seed, 10)
    return image


def depth(seed: int) -> np.ndarray:
    return np.full((HEIGHT, WIDTH), 1500 + 100 * seed, np.uint16)


def images(script: Script, count: int = 3, depth_frame: str = OPTICAL) -> Script:
    """Raw colour at 0, 0.1, 0.2 s, raw depth 4 ms later, one CameraInfo."""
    script.info("/camera/color/camera_info", START)
    for index in range(count):
        time = START + index * SECOND // 10
        script.image("/camera/color/image_raw", time, OPTICAL, "rgb8", color(index), pad=2)
        topic = "/camera/depth/image_rect_raw" if depth_frame != OPTICAL else "/camera/depth/image"
        script.image(topic, time + 4_000_000, depth_frame, "16UC1", depth(index))
    return script


def tree(script: Script) -> Script:
    """map < odom < base (timed, every 30 ms) < camera < optical (fixed)."""
    for step in range(-2, 12):
        time = START + step * 30_000_000
        script.tf(time, "map", "odom", np.eye(4))
        script.tf(time, "odom", "base_link", base_at(time))
    script.tf(START - 90_000_000, "base_link", OPTICAL, mounted(), static=True)
    return script


@pytest.fixture(params=[True, False], ids=["ros1", "ros2"])
def script(request: pytest.FixtureRequest) -> Script:
    return Script(request.param)


@pytest.fixture
def opened(tmp_path: Path) -> Callable[..., Any]:
    def open_(script: Script, **options: str) -> Any:
        path = script.write(tmp_path / ("walk.bag" if script.ros1 else "walk"))
        return open_recording(path, "ros1" if script.ros1 else "ros2", options=options)

    return open_


def test_images_camera_and_poses_by_tf_are_read(script: Script, opened) -> None:
    recording = opened(tree(images(script)))
    frames = list(recording)
    assert recording.intrinsics == Intrinsics(60, 61, 31.5, 23.5, WIDTH, HEIGHT)
    assert [frame.timestamp_ns - START for frame in frames] == [0, SECOND // 10, SECOND // 5]
    assert recording.notes == (
        (
            "colour /camera/color/image_raw, depth /camera/depth/image, camera /camera/color/camera_info, "
            f"poses /tf map < {OPTICAL}"
        ),
    )
    for index, frame in enumerate(frames):
        assert (decode_raw_depth(frame.depth_bytes) == depth(index)).all()
        bgr = cv2.imdecode(np.frombuffer(frame.rgb_bytes, np.uint8), cv2.IMREAD_COLOR)
        np.testing.assert_allclose(bgr[10, 10, ::-1], color(index)[0, 0], atol=4)
        expected = base_at(frame.timestamp_ns) @ mounted()
        np.testing.assert_allclose(frame.world_from_camera, expected, atol=1e-6)


def test_a_frame_out_of_reach_of_depth_or_pose_is_skipped(script: Script, opened) -> None:
    images(tree(script))
    late = START + SECOND
    script.image("/camera/color/image_raw", late, OPTICAL, "rgb8", color(3))
    script.image("/camera/depth/image", late, OPTICAL, "16UC1", depth(3))
    script.image("/camera/color/image_raw", START + SECOND // 20, OPTICAL, "rgb8", color(4))
    recording = opened(script, max_dt="0.02")
    assert len(recording) == 3
    assert sorted(frame.reason for frame in recording.skipped) == ["no depth image", "no pose"]


def test_odometry_goes_to_the_camera_by_the_static_tree_or_the_extrinsic_given(tmp_path: Path) -> None:
    for name in ("tree", "given"):
        script = images(Script(ros1=False))
        for step in range(-1, 12):
            time = START + step * 30_000_000
            script.odometry("/odom", time, "base_link", base_at(time))
        options = {"pose_topic": "/odom"}
        if name == "tree":
            script.tf(START, "base_link", OPTICAL, mounted(), static=True)
        else:
            numbers = [*mounted()[:3, 3], *_quaternion(mounted()[:3, :3])]
            options["extrinsic"] = ",".join(f"{number:.9g}" for number in numbers)
        frame = list(open_recording(script.write(tmp_path / name), "ros2", options=options))[1]
        expected = base_at(START + SECOND // 10) @ mounted()
        np.testing.assert_allclose(frame.world_from_camera, expected, atol=1e-6)


def test_odometry_without_a_way_to_the_camera_is_an_error(script: Script, opened) -> None:
    images(script).odometry("/odom", START, "base_link", base_at(START))
    with pytest.raises(InvalidInput, match=r"from 'base_link' to the camera's frame 'camera_color_optical_"):
        opened(script)


def test_a_lone_topic_of_poses_is_taken_as_the_cameras(script: Script, opened) -> None:
    images(script)
    for step in range(4):
        time = START + step * SECOND // 10
        script.camera_pose("/camera/pose", time, base_at(time) @ mounted())
    recording = opened(script)
    assert recording.notes[0].endswith("poses /camera/pose taken as the camera's own")
    np.testing.assert_allclose(
        list(recording)[2].world_from_camera, base_at(START + SECOND // 5) @ mounted(), atol=1e-6
    )


def test_compressed_images_pass_through_as_they_are(script: Script, opened) -> None:
    jpeg = cv2.imencode(".jpg", color(0))[1].tobytes()
    png = cv2.imencode(".png", depth(2))[1].tobytes()
    tree(script).info("/camera/color/camera_info", START)
    script.compressed(
        "/camera/color/image_raw/compressed", START, OPTICAL, "rgb8; jpeg compressed bgr8", jpeg
    )
    topic = "/camera/aligned_depth_to_color/image_raw/compressedDepth"
    script.compressed(topic, START, OPTICAL, "16UC1; compressedDepth png", bytes(12) + png)
    frame = next(iter(opened(script)))
    assert frame.rgb_bytes == jpeg
    assert frame.depth_bytes == png


def test_compressed_depth_of_floats_is_inverse_depth(script: Script, opened) -> None:
    tree(script).info("/camera/color/camera_info", START)
    script.image("/camera/color/image_raw", START, OPTICAL, "mono8", color(0)[..., 0].copy())
    # depth = a / (v - b): 3000 / (1510 - 10) = 2 m; 0 = none
    inverse = np.full((HEIGHT, WIDTH), 1510, np.uint16)
    inverse[0] = 0
    data = struct.pack("<iff", 0, 3000.0, 10.0) + cv2.imencode(".png", inverse)[1].tobytes()
    topic = "/camera/depth/image/compressedDepth"
    script.compressed(topic, START, OPTICAL, "32FC1; compressedDepth png", data)
    raw = decode_raw_depth(next(iter(opened(script))).depth_bytes)
    assert raw is not None
    assert (raw[0] == 0).all()
    assert (raw[1:] == 2000).all()


def test_depth_in_metres_becomes_millimetres_and_nan_none(script: Script, opened) -> None:
    tree(script).info("/camera/color/camera_info", START)
    script.image("/camera/color/image_raw", START, OPTICAL, "bgr8", color(0))
    metres = np.full((HEIGHT, WIDTH), 1.2345, np.float32)
    metres[0], metres[1], metres[2] = np.nan, np.inf, 90.0
    script.image("/camera/depth/image", START, OPTICAL, "32FC1", metres)
    raw = decode_raw_depth(next(iter(opened(script))).depth_bytes)
    assert raw is not None
    assert (raw[:3] == 0).all()
    assert (raw[3:] == 1234).all() or (raw[3:] == 1235).all()


def test_depth_of_another_size_is_refused(script: Script, opened) -> None:
    tree(images(script, count=0))
    script.image("/camera/color/image_raw", START, OPTICAL, "rgb8", color(0))
    script.image("/camera/depth/image", START, OPTICAL, "16UC1", depth(0)[::2, ::2].copy())
    with pytest.raises(
        InvalidInput, match=r"depth registered to colour, got 32x24 on .* and 64x48 on .*aligned"
    ):
        opened(script)


def test_depth_of_another_camera_is_refused_unless_it_is_said_to_be_the_same(tmp_path: Path) -> None:
    script = tree(images(Script(ros1=True), depth_frame="camera_depth_optical_frame"))
    path = script.write(tmp_path / "walk.bag")
    with pytest.raises(InvalidInput, match=r"seen from 'camera_depth_optical_frame' and colour from"):
        open_recording(path, "ros1")
    assert len(open_recording(path, "ros1", options={"registered": "yes"})) == 3


def test_a_topic_that_is_not_there_is_told_those_that_are(script: Script, opened) -> None:
    with pytest.raises(
        InvalidInput, match=r"color_topic: expected a topic of Image .*'/left'; it has .*image_raw \(Image\)"
    ):
        opened(tree(images(script)), color_topic="/left")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"max_dt": "soon"}, "option max_dt: expected seconds above 0"),
        ({"fixed_frame": "moon"}, "expected the camera's frame .* under 'moon' on /tf, got camera_color"),
        ({"camera_frame": "left"}, "expected the camera's frame 'left' under 'left' on /tf"),
        ({"intrinsics": "60,60"}, "option intrinsics: expected fx,fy,cx,cy"),
    ],
)
def test_wrong_options_say_what_was_expected(opened, options: dict[str, str], message: str) -> None:
    with pytest.raises(InvalidInput, match=message):
        opened(tree(images(Script(ros1=False))), **options)


def test_a_camera_that_never_moves_on_tf_is_an_error(script: Script, opened) -> None:
    images(script).tf(START, "map", OPTICAL, mounted(), static=True)
    with pytest.raises(InvalidInput, match="expected the camera to move on /tf"):
        opened(script)


def test_lens_distortion_is_told(script: Script, opened) -> None:
    tree(images(script, count=1))
    script.written = [item for item in script.written if not item[1].endswith("CameraInfo")]
    script.info("/camera/color/camera_info", START, (0.1, -0.2, 0, 0, 0))
    assert "lens distortion (up to 0.2) is not undone" in opened(script).notes[1]


def test_a_broken_bag_is_told(tmp_path: Path) -> None:
    (tmp_path / "broken.bag").write_bytes(b"#ROSBAG V2.0\n" + bytes(40))
    with pytest.raises(InvalidInput, match=r"broken\.bag: expected a whole ROS bag, got"):
        open_recording(tmp_path / "broken.bag", "ros1")
    (tmp_path / "broken").mkdir()
    (tmp_path / "broken" / "metadata.yaml").write_text("rosbag2_bagfile_information: {}\n")
    with pytest.raises(InvalidInput, match=r"broken: expected a whole ROS bag, got"):
        open_recording(tmp_path / "broken", "ros2")


def test_without_the_package_the_one_to_install_is_named(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "rosbags", None)
    (tmp_path / "a.bag").write_bytes(b"")
    with pytest.raises(NotConfigured, match=r"pip install 'ovip-sg\[ros\]'"):
        open_recording(tmp_path / "a.bag", "ros1")


def test_a_bag_of_the_other_generation_is_told(script: Script, tmp_path: Path) -> None:
    path = tree(images(script)).write(tmp_path / ("a.bag" if script.ros1 else "a"))
    other, own = ("ros2", "ros1") if script.ros1 else ("ros1", "ros2")
    with pytest.raises(InvalidInput, match=rf"This looks like layout {own}\."):
        open_recording(path, other)
