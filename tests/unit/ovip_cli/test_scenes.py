"""What `ovip scenes` asks of the mapper and prints."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ovip.errors import InvalidInput
from ovip.scene.types import Move, Presence, Relation, RelationKind
from ovip.scene.versions import Alignment, MapDiff, ObjectChange, Verification
from ovip_cli.joining import read_transform
from tests.builders import same
from tests.unit.ovip.map_objects import map_object
from tests.unit.ovip_cli.conftest import Run
from tests.unit.services.mapper.recorded import TRANSFORM, Recorded

ROW = "kitchen                         7        3       60         600"


@pytest.mark.parametrize("words", [["scenes"], ["scenes", "list"]])
async def test_the_scenes_of_a_stack_are_listed_with_and_without_the_word(
    ovip: Run, words: list[str]
) -> None:
    told, plain = await ovip(*words), await ovip(*words, "--json")

    assert told.stdout.splitlines()[1] == ROW
    assert json.loads(plain.stdout)["scenes"][0]["map_version"] == 7


async def test_options_before_the_word_are_refused_rather_than_passed_over(ovip: Run) -> None:
    result = await ovip("scenes", "--json", "show", "kitchen")

    assert result.exit_code == 2


async def test_objects_are_shown_with_place_size_and_what_stands_out(ovip: Run, kitchen: Recorded) -> None:
    cup = map_object(
        "o000001",
        centroid=np.array([1.25, -0.5, 0.75]),
        pinned=True,
        relations=(
            Relation(RelationKind.ON, "o000002", {"gap": 0.01}),
            Relation(RelationKind.NEXT_TO, "o000009", {"gap": 0.2}),
        ),
    )
    table = map_object(
        "o000002",
        label="dining table",
        frames=40,
        presence=Presence.MOVED_OR_REMOVED,
        label_given=True,
        moves=(Move(1, np.zeros(3)),),
    )
    kitchen.map = replace(kitchen.map, objects=(cup, table))

    shown = await ovip("scenes", "show", "kitchen", "--at", "5", "--departed", "--unconfirmed")

    assert shown.exit_code == 0
    assert shown.stdout.splitlines() == [
        "kitchen: version 7, 2 objects from 3 frames",
        "id       label                     where (m)         size (m) frames  notes",
        (
            "o000001  cup             (1.25, -0.50, 0.75) 0.10 x 0.10 x 0.10      3  "
            "pinned; on dining table o000002; next to o000009"
        ),
        (
            "o000002  dining table     (0.00, 0.00, 0.00) 0.10 x 0.10 x 0.10     40  "
            "moved or removed; named by an operator; moved once"
        ),
    ]
    assert kitchen.asked == [("kitchen", True, 5, True)]


async def test_what_is_gone_is_not_shown_unless_asked_for(ovip: Run, kitchen: Recorded) -> None:
    shown = await ovip("scenes", "show", "kitchen", "--json")

    assert kitchen.asked == [("kitchen", False, 0, False)]
    body = json.loads(shown.stdout)
    assert (body["map_version"], body["state_hash"], len(body["objects"])) == (7, "hash-7", 3)
    assert body["objects"][0]["presence"] == "present"


async def test_a_map_that_its_log_makes_again_is_said_to_hold(ovip: Run) -> None:
    told = await ovip("scenes", "verify", "kitchen")

    assert told.exit_code == 0
    assert told.stdout == (
        "kitchen: version 7, 70 steps rebuilt, 2 snapshots compared: the same, bit for bit (ab)\n"
    )


@pytest.mark.parametrize(
    ("found", "words"),
    [
        (Verification(7, "ab", "cd", 2, (), 70), "NOT the same: in use ab, rebuilt cd"),
        (Verification(7, "ab", "ab", 2, (3, 5), 70), "NOT the same: snapshots that differ at version 3, 5"),
    ],
)
async def test_a_map_that_its_log_does_not_make_again_ends_with_1_in_words_and_in_json(
    ovip: Run, kitchen: Recorded, found: Verification, words: str
) -> None:
    kitchen.verification = found

    told, plain = (
        await ovip("scenes", "verify", "kitchen"),
        await ovip("scenes", "verify", "kitchen", "--json"),
    )

    assert told.exit_code == plain.exit_code == 1
    assert words in told.stdout
    assert json.loads(plain.stdout)["holds"] is False


async def test_a_difference_tells_what_came_what_went_and_what_changed(ovip: Run, kitchen: Recorded) -> None:
    cup = map_object("o000001", feature=np.zeros(0, np.float32))
    kitchen.difference = MapDiff(
        3,
        7,
        (
            ObjectChange("o000001", cup, replace(cup, label="mug"), ("label", "box")),
            ObjectChange("o000002", None, replace(cup, object_id="o000002")),
            ObjectChange("o000003", replace(cup, object_id="o000003"), None, (), "o000001"),
            ObjectChange("o000004", replace(cup, object_id="o000004"), None),
        ),
    )

    told = await ovip("scenes", "diff", "kitchen", "3")
    plain = await ovip("scenes", "diff", "kitchen", "3", "7", "--json")

    at = "at (0.00, 0.00, 0.00) m, 0.10 x 0.10 x 0.10 m"
    assert told.stdout.splitlines() == [
        "kitchen: version 3 -> 7, 4 objects differ",
        f"~ o000001 mug {at} (was cup): label, box",
        f"+ o000002 cup {at}",
        f"- o000003 cup {at} (merged into o000001)",
        f"- o000004 cup {at}",
    ]
    changes = json.loads(plain.stdout)["changes"]
    assert [(c["id"], c["merged_into"]) for c in changes][2] == ("o000003", "o000001")
    assert changes[1]["before"] is None
    assert kitchen.asked == [("kitchen", 3, 0), ("kitchen", 3, 7)]


# Joining and aligning


async def test_maps_are_joined_by_a_transform_from_a_file_under_the_id_given(
    ovip: Run, kitchen: Recorded, tmp_path: Path
) -> None:
    np.savetxt(tmp_path / "t.txt", TRANSFORM, fmt="%.17g")

    told = await ovip(
        "scenes", "join", "kitchen", "attic", "--transform", str(tmp_path / "t.txt"), "--edit-id", "j1"
    )

    assert told.stdout == (
        "kitchen: version 9: 1 objects of attic came in, 1 of them new, 0 into objects that were here\n"
    )
    assert same(kitchen.asked, [("kitchen", "attic", TRANSFORM, "j1")])


async def test_maps_are_joined_by_the_transform_that_alignment_found(ovip: Run, kitchen: Recorded) -> None:
    told = await ovip("scenes", "join", "kitchen", "attic", "--align", "--json")

    aligned, joined = kitchen.asked
    assert aligned == ("kitchen", "attic", None)
    assert same(joined[2], TRANSFORM)
    assert len(joined[3]) == 36
    body = json.loads(told.stdout)
    assert body["ids"] == {"o000001": "o000003"}
    assert body["alignment"]["overlap"] == 0.75


@pytest.mark.parametrize("words", [[], ["--align", "--transform", "t.txt"]])
async def test_a_join_takes_either_a_transform_or_an_alignment(ovip: Run, words: list[str]) -> None:
    result = await ovip("scenes", "join", "kitchen", "attic", *words)

    assert isinstance(result.exception, InvalidInput)
    assert "either --transform FILE or --align" in str(result.exception)


async def test_an_alignment_written_to_a_file_is_a_transform_to_join_by(
    ovip: Run, kitchen: Recorded, tmp_path: Path
) -> None:
    kitchen.alignment = Alignment(TRANSFORM, 0.9, 0.01)
    path = tmp_path / "t.json"

    told = await ovip("scenes", "align", "kitchen", "attic", "-o", str(path))

    assert told.stdout.startswith("aligned: 90 % of the smaller surface lies on the other, rmse 0.010 m")
    assert np.array_equal(read_transform(path), TRANSFORM)


async def test_an_alignment_starts_from_a_guess_where_there_is_one(
    ovip: Run, kitchen: Recorded, tmp_path: Path
) -> None:
    first = await ovip("scenes", "align", "kitchen", "attic", "--json")
    (tmp_path / "found.json").write_text(first.stdout)

    await ovip("scenes", "align", "kitchen", "attic", "--guess", str(tmp_path / "found.json"))

    assert same(kitchen.asked[1], ("kitchen", "attic", TRANSFORM))


@pytest.mark.parametrize("text", ["", "1 2 3", "one two", '{"a": 1}', "[[1, 2], [3]]", "{"])
def test_a_file_that_holds_no_transform_is_refused_in_words(tmp_path: Path, text: str) -> None:
    (tmp_path / "t.txt").write_text(text)

    with pytest.raises(InvalidInput, match="expected the 16 numbers of a 4x4"):
        read_transform(tmp_path / "t.txt")
    with pytest.raises(InvalidInput, match=r"nowhere\.txt: cannot be read"):
        read_transform(tmp_path / "nowhere.txt")
