"""The real recording through the real models: the objects that are known to be there, and answers about them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.e2e.conftest import Cli, Stack

pytestmark = [pytest.mark.recording, pytest.mark.models]

# centres in the pose files' own frame, metres, read by hand, good to 0.2 m (../shared/data/README.md)
WHITE_MUG = (-0.71, -0.17, 1.95)
CHAIR_BEYOND_TABLE = (-0.49, -0.30, 2.26)
CHAIR_LEFT_END = (-1.18, 0.09, 1.95)
STRIDE = 7


REPLAY = ("--layout", "7scenes", "--scene", "kitchen", "--stride", str(STRIDE))


@dataclass(frozen=True)
class Mapped:
    """The kitchen, mapped: what the replay said, where its state lies, and the stack that answers from it."""

    result: dict[str, Any]
    stack: Stack
    cli: Cli

    def find(self, text: str) -> Any:
        words = ("find", text, "--scene", "kitchen", "--frame", "source", "--data-dir", self.stack.data)
        return self.cli.json(*words)


@pytest.fixture(scope="module")
def mapped(cli: Cli, kitchen: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Mapped]:
    """Mapped by a standalone replay, whose state a second stack then answers from."""
    data = tmp_path_factory.mktemp("kitchen")
    result = cli.json("replay", kitchen, *REPLAY, "--standalone", "--data-dir", data, timeout=500)
    with Stack(cli, data) as stack:
        yield Mapped(result, stack, cli)


def distance(answer: Any, truth: tuple[float, float, float]) -> float:
    return float(np.linalg.norm(np.array(answer["position"]) - truth))


def test_every_frame_is_mapped_and_the_map_is_small(mapped: Mapped) -> None:
    result = mapped.result
    assert result["frames"] == len(range(0, 175, STRIDE))
    assert result["rejected"] == []
    assert 5 <= result["objects"] <= 60
    assert result["regions"] >= 1


def test_white_mug_is_found_where_it_stands(mapped: Mapped) -> None:
    answer = mapped.find("white mug")
    assert answer["outcome"] == "found"
    assert distance(answer["object"], WHITE_MUG) < 0.35
    assert answer["goal"] is not None
    assert any("colour" in fallback for fallback in answer["fallbacks"])
    assert [t["vlm_calls"] for t in answer["tiers"]] == [0] * len(answer["tiers"])


def test_chairs_are_several_objects(mapped: Mapped) -> None:
    answer = mapped.find("chair")
    assert answer["outcome"] == "found"
    chairs = [answer["object"], *answer["candidates"]]
    assert min(distance(c, CHAIR_BEYOND_TABLE) for c in chairs) < 0.35
    assert min(distance(c, CHAIR_LEFT_END) for c in chairs) < 0.35


def test_table_is_one_piece(mapped: Mapped) -> None:
    answer = mapped.find("table")
    assert (answer["outcome"], answer["tier"]) == ("found", 1)
    assert answer["candidates"] == []


def test_piano_is_not_found_and_the_answer_says_what_it_would_take(mapped: Mapped) -> None:
    answer = mapped.find("piano")
    assert answer["outcome"] == "unresolved"
    assert [t["tier"] for t in answer["tiers"]] == [1, 2, 3, 4]
    assert answer["object"] is None
    assert "viewpoints" in answer["needs"]


def test_the_recording_again_changes_nothing(mapped: Mapped, cli: Cli, kitchen: Path) -> None:
    again = cli.json("replay", kitchen, *REPLAY, "--data-dir", mapped.stack.data)
    assert again["sent"] == 0
    assert again["state_hash"] == mapped.result["state_hash"]
