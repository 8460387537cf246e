import json
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import cv2
import numpy as np
import pytest

from lab.evaluation.experiment import Options
from lab.evaluation.experiments import ablation, instance, scaling, semantic
from lab.evaluation.mapping.making import PlaceParams, PlaceSpec, make_place, place_of, specs_of
from lab.evaluation.mapping.places import Place
from lab.evaluation.mapping.sources import Source
from lab.evaluation.processes import in_processes
from lab.evaluation.scores.semantic import REPLICA_CLASSES
from lab.simulation import SimulatedRoom, pose_looking
from lab.simulation.home import Home, HomeObject, Material, Mesh, Storey
from lab.simulation.imperfect import PERFECT, SeenFrame, read_cache
from ovip.errors import InvalidInput
from ovip.scene.camera import backproject
from ovip.scene.types import F64, I64, Intrinsics

SMALL = PlaceParams(dimension=64)
EMPTY_MESH = Mesh(
    vertices=np.zeros((0, 3), np.float32),
    triangles=np.zeros((0, 3), np.int32),
    normals=np.zeros((0, 3, 3), np.float32),
    uv=np.zeros((0, 3, 2), np.float32),
    material_ids=np.zeros(0, np.int32),
    materials=(Material(np.zeros(3, np.uint8)),),
    object_ids=np.zeros(0, np.uint16),
)


def room_source(first: int, last: int, step: int) -> Source:
    """Part of the walk through the simulated room as a source; its truth is what all of the walk sees."""
    room = SimulatedRoom(0)
    things = tuple(
        HomeObject(o.object_id, o.label, (o.color,), o.structural, o.box, 1.0 + o.object_id, 0, 0)
        for o in room.objects
    )
    poses = room.walk()
    frames = [_seen(room, pose, i) for i, pose in enumerate(poses[::step])]
    points = [backproject(f.depth, f.intrinsics, f.world_from_camera) for f in frames[::3]]
    home = Home("room", 0, "", EMPTY_MESH, (Storey(0, 0.0, 2.6),), (), (), things)
    return Source(
        home=home,
        frames=frames[first // step : last // step],
        points=np.concatenate([p[::4] for p, _ in points]),
        ids=np.concatenate(
            [f.ids.ravel()[i][::4].astype(np.int64) for f, (_, i) in zip(frames[::3], points, strict=True)]
        ),
    )


def _seen(room: SimulatedRoom, pose: F64, index: int) -> SeenFrame:
    _, depth, ids = room.render(pose)
    return SeenFrame(index, index * 100, room.intrinsics, pose, None, depth, ids)


@pytest.fixture(scope="module")
def source() -> Source:
    return room_source(0, 10_000, 8)


@pytest.fixture(scope="module")
def place(source: Source, tmp_path_factory: pytest.TempPathFactory) -> Place:
    return make_place(source, SMALL, 3, tmp_path_factory.mktemp("place"))


def test_the_instances_that_count_are_things_that_were_seen(source: Source, place: Place) -> None:
    labels = {thing.object_id: thing for thing in source.home.objects}
    assert len(place.area_ids) >= 15
    assert not any(labels[int(i)].structural for i in place.area_ids)
    assert set(place.instances.tolist()) == set(place.area_ids.tolist())
    assert [place.class_names[c] for c in place.point_class[::50]] == [
        labels[int(i)].label for i in place.instances[::50]
    ]
    assert place.structural == {"wall", "floor", "ceiling"}


def test_the_cache_holds_words_that_the_place_knows(place: Place) -> None:
    batches = list(read_cache(place.cache)[1])
    assert len(batches) == place.frames
    labels = {d.label for batch in batches for d in batch.detections}
    assert labels <= set(place.words)
    assert sum(len(batch.detections) for batch in batches) == place.detections
    assert np.linalg.norm(place.word_features, axis=1) == pytest.approx(1, abs=1e-5)


def test_a_walk_that_sees_one_room_is_not_judged_by_the_other(tmp_path: Path) -> None:
    source = room_source(0, 30, 5)  # it starts in the main room; the bed is in the other
    place = make_place(source, SMALL, 3, tmp_path)
    bed = next(thing.object_id for thing in source.home.objects if thing.label == "bed")
    assert bed in source.ids
    assert bed not in place.instances
    assert "bed" not in {place.class_names[c] for c in np.unique(place.dense_class)}


def test_the_same_seed_gives_the_same_ablation_table(source: Source, place: Place, tmp_path: Path) -> None:
    again = make_place(source, SMALL, 3, tmp_path)
    first, second = ablation.score(place), ablation.score(again)
    assert first == second
    assert [row["config"] for row in first][:4] == ["overlap", "+IPSM", "+LAMP", "+AWF"]
    assert all(0 < row["PQ"] <= 1 and 0 < row["F-mIoU"] <= 100 for row in first)
    assert make_place(source, SMALL, 4, tmp_path / "other").detections != 0


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (Options(dataset="examples"), "expected small_house or replica"),
        (Options(dataset="small_house"), "expected the folder of small_house, got None"),
        (Options(dataset="replica", root=Path("not/there")), "not/there"),
    ],
)
def test_a_data_set_that_is_not_there_is_said_in_words(options: Options, said: str) -> None:
    with pytest.raises(InvalidInput, match=said):
        specs_of(options)


def test_homes_count_up_from_the_seed() -> None:
    assert [spec.seed for spec in specs_of(Options(homes=3, seed=7))] == [7, 8, 9]


# Replica: a floor, a table and a cushion on it, as the data set's mesh and as NICE-SLAM's render of it

CAMERA = Intrinsics(120.0, 120.0, 79.5, 59.5, 160, 120)
UNNAMED = 9  # an object_id that info_semantic.json does not list


def test_a_replica_scene_is_mapped_and_judged_by_its_own_mesh(replica: Path, tmp_path: Path) -> None:
    (spec,) = specs_of(Options(dataset="replica", root=replica))
    place = place_of(replace(spec, params=PlaceParams(PERFECT, 64)), tmp_path)
    assert place.class_names == tuple(name.replace("-", " ") for name in REPLICA_CLASSES)
    assert place.frames == 6  # every fifth of thirty
    assert {place.words[c] for c in np.unique(place.point_class)} == {"table", "cushion"}
    assert len(place.area_ids) == 2
    row = ablation.score(place)[-1]
    assert row["PQ"] > 0.9
    assert row["mAcc"] > 90


def test_a_place_is_made_once_and_again_when_what_it_is_made_by_changes(
    replica: Path, tmp_path: Path
) -> None:
    spec = PlaceSpec("replica", 0, replica, "room0", params=PlaceParams(PERFECT, 64))
    first = place_of(spec, tmp_path)
    written = first.cache.stat().st_mtime_ns
    assert place_of(spec, tmp_path).cache.stat().st_mtime_ns == written
    assert place_of(replace(spec, seed=1), tmp_path).cache != first.cache


def test_a_folder_without_replica_scenes_says_what_is_expected(tmp_path: Path) -> None:
    (tmp_path / "stuff").mkdir()
    with pytest.raises(InvalidInput, match=r"traj\.txt.*got stuff"):
        specs_of(Options(dataset="replica", root=tmp_path))


@pytest.mark.parametrize(
    ("experiment", "configs"),
    [
        (ablation, ["overlap", "+IPSM", "+LAMP", "+AWF", "ours"]),
        (semantic, ["overlap", "ours", "ours, labels 0.3", "ours, labels 1"]),
        (instance, ["overlap", "ours"]),
        (scaling, ["room0"]),
    ],
)
def test_an_experiment_has_a_row_per_configuration_and_draws_where_asked(
    experiment: ModuleType, configs: list[str], replica: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OVIP_LAB_CACHE", str(replica / "cache"))
    result = experiment.run(Options(dataset="replica", root=replica, figures=tmp_path))
    assert [row["config"] for row in result.rows] == configs
    assert {row["scene"] for row in result.scenes} == {"room0"}
    assert all(row["strict"] and row["objects"] >= 0 for row in result.rows)
    assert result.figures
    assert all(path.stat().st_size > 1000 for path in result.figures)


def test_work_comes_back_in_order_from_several_processes() -> None:
    assert in_processes(abs, [-3, 2, -1], 2) == [3, 2, 1]


@pytest.fixture(scope="module")
def replica(tmp_path_factory: pytest.TempPathFactory) -> Path:
    pytest.importorskip("open3d", reason="ids are rendered with Open3D")
    root = tmp_path_factory.mktemp("replica")
    parts = [
        (_sheet((-2, -2, 0), (2, 2, 0)), 0),
        (_box((-0.6, -0.6, 0.0), (0.6, 0.6, 0.5)), 4),
        (_box((-0.2, -0.2, 0.52), (0.2, 0.2, 0.7)), 7),
        (_sheet((-2, -2, 2.5), (-1.9, -1.9, 2.5)), UNNAMED),
    ]
    _write_mesh(root / "room_0" / "habitat", parts)
    _write_recording(root / "room0", root)
    return root


def _sheet(low: tuple[float, ...], high: tuple[float, ...], cells: int = 16) -> F64:
    """Quads `(N, 4, 3)` of a level rectangle."""
    x, y = (np.linspace(low[i], high[i], cells + 1) for i in (0, 1))
    corner = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    i, j = np.mgrid[:cells, :cells].reshape(2, -1, 1)
    return np.stack([x[i + corner[:, 0]], y[j + corner[:, 1]], np.full((cells**2, 4), low[2])], axis=2)


def _box(low: tuple[float, ...], high: tuple[float, ...]) -> F64:
    """Quads of all six sides."""
    sides = []
    for axis in range(3):
        order = [(axis + 1) % 3, (axis + 2) % 3, axis]
        for level in (low[axis], high[axis]):
            flat = _sheet((low[order[0]], low[order[1]], level), (high[order[0]], high[order[1]], level))
            side = np.empty_like(flat)
            side[..., order] = flat
            sides.append(side)
    return np.concatenate(sides)


def _write_mesh(folder: Path, parts: list[tuple[F64, int]]) -> None:
    folder.mkdir(parents=True)
    vertices = np.concatenate([quads.reshape(-1, 3) for quads, _ in parts]).astype("<f4")
    ids: I64 = np.repeat([i for _, i in parts], [len(quads) for quads, _ in parts])
    faces = np.zeros(len(ids), [("count", "u1"), ("corners", "<i4", (4,)), ("id", "<i4")])
    faces["count"], faces["corners"], faces["id"] = 4, np.arange(len(vertices)).reshape(-1, 4), ids
    head = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n"
        "property float x\nproperty float y\nproperty float z\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nproperty int object_id\nend_header\n"
    )
    (folder / "mesh_semantic.ply").write_bytes(head.encode() + vertices.tobytes() + faces.tobytes())
    named = {0: "floor", 4: "table", 7: "cushion"}
    listed = [{"id": i, "class_name": name} for i, name in named.items()]
    (folder / "info_semantic.json").write_text(json.dumps({"objects": listed}))


def _write_recording(folder: Path, root: Path) -> None:
    from lab.evaluation.mapping.replica import _home
    from lab.simulation.renderer import Renderer
    from ovip.recordings.replica_mesh import read_replica_mesh

    (folder / "results").mkdir(parents=True)
    renderer = Renderer(_home("room0", read_replica_mesh(root / "room_0")), CAMERA)
    poses = []
    for i, angle in enumerate(np.linspace(0, 2 * np.pi, 30, endpoint=False)):
        eye = (1.8 * np.cos(angle), 1.8 * np.sin(angle), 1.5)
        poses.append(pose_looking(eye, angle + np.pi, -0.55))
        depth, _ = renderer.depth_and_ids(poses[-1])
        cv2.imwrite(str(folder / "results" / f"depth{i:06d}.png"), (depth * 6553.5).round().astype(np.uint16))
        cv2.imwrite(str(folder / "results" / f"frame{i:06d}.jpg"), np.full((120, 160, 3), 90, np.uint8))
    np.savetxt(folder / "traj.txt", np.stack(poses).reshape(-1, 16))
    k = {"w": 160, "h": 120, "fx": 120.0, "fy": 120.0, "cx": 79.5, "cy": 59.5, "scale": 6553.5}
    (root / "cam_params.json").write_text(json.dumps({"camera": k}))
