"""What `ovip edit` asks of the mapper and prints."""

from __future__ import annotations

import getpass
import json
from typing import Any

import numpy as np
import pytest

from ovip.errors import Conflict, NotFound
from ovip.scene.edits import Delete, Merge, Pin, Rename, Split
from tests.builders import same
from tests.unit.ovip_cli.conftest import Run
from tests.unit.services.mapper.recorded import Recorded

EDITS = {
    "rename": (["o000001", "mug"], Rename("o000001", "mug")),
    "merge": (["o000001", "o000002", "o000003"], Merge("o000001", ("o000002", "o000003"))),
    "split": (
        ["o000001", "--label", "lid", "--box", "-1", "0", "-0.5", "1", "2", "3"],
        Split("o000001", np.array([-1, 0, -0.5, 1, 2, 3]), "lid"),
    ),
    "delete": (["o000001"], Delete("o000001")),
    "pin": (["o000001"], Pin("o000001")),
    "pin --off": (["o000001", "--off"], Pin("o000001", pinned=False)),
}


@pytest.mark.parametrize("name", EDITS)
async def test_an_edit_is_made_on_the_version_read_now_by_who_is_logged_in(
    ovip: Run, kitchen: Recorded, name: str
) -> None:
    words, edit = EDITS[name]

    told = await ovip("edit", "kitchen", name.split()[0], *words)

    assert told.exit_code == 0
    ((scene, request),) = kitchen.asked
    assert (scene, request.made_on_version, request.operator) == ("kitchen", 7, getpass.getuser())
    assert same(request.edit, edit)
    assert told.stdout.splitlines()[:2] == [
        "kitchen at version 7:",
        "  o000001 cup at (0.00, 0.00, 0.00) m, 0.10 x 0.10 x 0.10 m",
    ]
    assert told.stdout.splitlines()[-1] == "version 8: updated o000001"


async def test_every_edit_has_an_id_of_its_own(ovip: Run, kitchen: Recorded) -> None:
    for _ in range(2):
        await ovip("edit", "kitchen", "delete", "o000001")

    assert len({request.edit_id for _, request in kitchen.asked}) == 2


async def test_an_edit_names_the_version_and_the_operator_it_is_told(ovip: Run, kitchen: Recorded) -> None:
    told = await ovip(
        "edit", "kitchen", "rename", "o000001", "", "--made-on", "9", "--operator", "ada", "--json"
    )

    ((_, request),) = kitchen.asked
    assert (request.made_on_version, request.operator, request.edit) == (9, "ada", Rename("o000001", ""))
    body = json.loads(told.stdout)
    assert (body["made_on_version"], body["delta"]["kind"], body["delta"]["updated"]) == (
        9,
        "edit",
        ["o000001"],
    )


async def test_an_edit_made_on_what_has_changed_is_refused(ovip: Run) -> None:
    result = await ovip("edit", "kitchen", "delete", "o000001", "--made-on", "3")

    assert isinstance(result.exception, Conflict)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["attic", "delete", "o000001"], "no scene 'attic'; known: kitchen"),
        (["kitchen", "delete", "o000077"], "o000077"),
    ],
)
async def test_what_is_not_there_is_not_edited(
    ovip: Run, kitchen: Recorded, words: list[str], said: Any
) -> None:
    result = await ovip("edit", *words)

    assert isinstance(result.exception, NotFound)
    assert said in str(result.exception)
    assert kitchen.asked == []
