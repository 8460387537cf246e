"""Replica's semantic mesh, written here as the data set writes it."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import numpy as np
import pytest

from ovip.errors import InvalidInput
from ovip.recordings.ply import read_ply
from ovip.recordings.replica_mesh import read_replica_mesh

HEADER = """ply
format binary_little_endian 1.0
element vertex 5
property float x
property float y
property float z
property uchar red
element face {faces}
property list uchar int vertex_indices
property int object_id
end_header
"""
VERTICES = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 2.5)]
QUADS = [((0, 1, 2, 3), 7), ((0, 1, 4, 3), 9)]


def write_scene(folder: Path, faces: list[tuple[tuple[int, ...], int]]) -> Path:
    (folder / "habitat").mkdir(parents=True)
    data = HEADER.format(faces=len(faces)).encode()
    data += b"".join(struct.pack("<fffB", *vertex, 200) for vertex in VERTICES)
    for corners, object_id in faces:
        data += struct.pack(f"<B{len(corners)}ii", len(corners), *corners, object_id)
    (folder / "habitat" / "mesh_semantic.ply").write_bytes(data)
    objects = [{"id": 7, "class_id": 40, "class_name": "floor"}, {"id": 9, "class_id": 93, "class_name": ""}]
    (folder / "habitat" / "info_semantic.json").write_text(json.dumps({"classes": [], "objects": objects}))
    return folder


def test_quads_become_two_triangles_each_with_the_id_of_their_face(tmp_path: Path) -> None:
    mesh = read_replica_mesh(write_scene(tmp_path / "room_0", QUADS))
    np.testing.assert_array_equal(mesh.vertices, VERTICES)
    assert mesh.faces.tolist() == [[0, 1, 2], [0, 2, 3], [0, 1, 4], [0, 4, 3]]
    assert mesh.object_ids.tolist() == [7, 7, 9, 9]
    assert mesh.labels == {7: "floor"}


def test_faces_of_three_and_four_corners_may_be_mixed(tmp_path: Path) -> None:
    faces = [((0, 1, 2, 3), 7), ((0, 1, 4), 9), ((1, 2, 3, 4), 8), ((2, 3, 4), 9)]
    mesh = read_replica_mesh(write_scene(tmp_path / "room_0", faces))
    by_id = {i: mesh.faces[mesh.object_ids == i].tolist() for i in (7, 8, 9)}
    assert by_id == {7: [[0, 1, 2], [0, 2, 3]], 8: [[1, 2, 3], [1, 3, 4]], 9: [[0, 1, 4], [2, 3, 4]]}


@pytest.mark.parametrize("asked", ["office_3", "office3", "office_3/habitat"])
def test_the_scene_is_found_by_either_name(tmp_path: Path, asked: str) -> None:
    write_scene(tmp_path / "office_3", QUADS)
    assert len(read_replica_mesh(tmp_path / asked).faces) == 4


def test_a_folder_of_the_render_is_told_that_the_mesh_is_missing(replica) -> None:
    with pytest.raises(InvalidInput, match=r"room0: expected a scene of Replica itself, with habitat/mesh_"):
        read_replica_mesh(replica())


@pytest.mark.parametrize(
    ("break_", "message"),
    [
        (lambda data: data[:-3], "bytes or more by its header, got .*cut off"),
        (lambda data: data[:-9], "bytes or more by its header, got .*cut off"),
        (lambda data: data.replace(b"binary_little_endian", b"ascii"), "binary little-endian PLY file, got"),
        (lambda data: b"", "binary little-endian PLY file, got b''"),
        (lambda data: data.replace(b"object_id", b"part_numb"), "vertex_indices and object_id, got"),
        (lambda data: data.replace(b"list uchar int", b"list uchar half"), "PLY's number types"),
    ],
)
def test_a_broken_mesh_says_what_was_expected(tmp_path: Path, break_, message: str) -> None:
    path = write_scene(tmp_path / "room_0", QUADS) / "habitat" / "mesh_semantic.ply"
    path.write_bytes(break_(path.read_bytes()))
    with pytest.raises(InvalidInput, match=message):
        read_replica_mesh(tmp_path / "room_0")


def test_an_index_beyond_the_vertices_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match="faces of its 5 vertices, got index 5"):
        read_replica_mesh(write_scene(tmp_path / "room_0", [((0, 1, 5), 7)]))


def test_an_element_without_rows_is_empty(tmp_path: Path) -> None:
    path = write_scene(tmp_path / "room_0", []) / "habitat" / "mesh_semantic.ply"
    assert read_ply(path)["face"] == []
    assert read_replica_mesh(tmp_path / "room_0").faces.shape == (0, 3)
