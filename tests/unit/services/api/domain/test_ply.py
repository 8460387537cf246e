"""PLY files, read back by the rules of the format."""

from __future__ import annotations

import numpy as np
import pytest

from services.api.domain.ply import PlyFormat, PlyObject, write_ply

OBJECTS = [
    PlyObject(
        "o-1", "white\nmug", np.array([[1.25, -2.0, 3.0]], np.float32), np.array([[255, 0, 7]], np.uint8)
    ),
    PlyObject("o-2", "stuhl ä", np.zeros((2, 3), np.float32), np.array([[1, 2, 3], [4, 5, 6]], np.uint8)),
]
ROW = np.dtype([("xyz", "<f4", 3), ("rgb", "u1", 3), ("object_id", "<i4")])


def split(data: bytes) -> tuple[list[str], bytes]:
    head, body = data.split(b"end_header\n", 1)
    return head.decode("ascii").splitlines(), body


def test_the_text_form_has_one_line_a_point() -> None:
    head, body = split(b"".join(write_ply(OBJECTS, PlyFormat.ASCII, ["scene flat"])))
    assert head[:2] == ["ply", "format ascii 1.0"]
    assert "element vertex 3" in head
    assert body.decode().splitlines() == [
        "1.25000 -2.00000 3.00000 255 0 7 0",
        "0.00000 0.00000 0.00000 1 2 3 1",
        "0.00000 0.00000 0.00000 4 5 6 1",
    ]


def test_the_binary_form_is_nineteen_bytes_a_point() -> None:
    head, body = split(b"".join(write_ply(OBJECTS, PlyFormat.BINARY)))
    assert head[1] == "format binary_little_endian 1.0"
    rows = np.frombuffer(body, ROW)
    assert rows["xyz"][0].tolist() == [1.25, -2.0, 3.0]
    assert rows["rgb"].tolist() == [[255, 0, 7], [1, 2, 3], [4, 5, 6]]
    assert rows["object_id"].tolist() == [0, 1, 1]


@pytest.mark.parametrize("form", list(PlyFormat))
def test_the_header_names_the_objects_each_on_one_ascii_line(form: PlyFormat) -> None:
    head, _ = split(b"".join(write_ply(OBJECTS, form)))
    assert "comment object 0 o-1 white mug" in head
    assert "comment object 1 o-2 stuhl ?" in head
    assert [line for line in head if line.startswith("property")] == [
        "property float x",
        "property float y",
        "property float z",
        "property uchar red",
        "property uchar green",
        "property uchar blue",
        "property int object_id",
    ]


def test_an_empty_map_is_a_header_alone() -> None:
    head, body = split(b"".join(write_ply([], PlyFormat.BINARY)))
    assert "element vertex 0" in head
    assert body == b""


def test_a_large_object_is_written_in_pieces() -> None:
    many = PlyObject("o", "wall", np.zeros((50_001, 3), np.float32), np.zeros((50_001, 3), np.uint8))
    pieces = list(write_ply([many], PlyFormat.BINARY))
    assert len(pieces) == 4
    assert sum(len(piece) for piece in pieces[1:]) == 19 * 50_001
