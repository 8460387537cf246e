"""The dashboard in a real browser over a real stack that has mapped the simulated home."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.e2e.conftest import Cli, Stack

playwright = pytest.importorskip(
    "playwright.sync_api", reason="playwright is not installed: dashboard not tested"
)
CHROMIUM = shutil.which("chromium")
FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
pytestmark = [
    pytest.mark.browser,
    pytest.mark.models,
    pytest.mark.skipif(CHROMIUM is None, reason="no chromium on PATH: dashboard not tested"),
]
SCENE = "home"


@pytest.fixture(scope="module")
def stack(cli: Cli, tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, Any]]:
    """A stack on free ports, with its data directory in `data`."""
    with Stack(cli, tmp_path_factory.mktemp("dashboard")) as stack:
        yield {**stack.running, "data": stack.data}


@pytest.fixture(scope="module")
def mapped(stack: dict[str, Any], cli: Cli, room_recording: Path) -> dict[str, Any]:
    """What the replay of the simulated home into the running stack said."""
    result: dict[str, Any] = cli.json(
        "replay", room_recording, "--scene", SCENE, "--data-dir", stack["data"], timeout=500
    )
    return result


@pytest.fixture
def page(stack: dict[str, Any], mapped: dict[str, Any], tmp_path: Path) -> Iterator[Any]:
    """The dashboard, opened by the link that the stack prints; an error of its scripts fails the test."""
    wrong: list[str] = []
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch_persistent_context(
            tmp_path / "profile",
            executable_path=CHROMIUM,
            args=FLAGS,
            viewport={"width": 1280, "height": 800},
        )
        shown = browser.new_page()
        shown.set_default_timeout(30_000)
        shown.on("pageerror", lambda error: wrong.append(str(error)))
        shown.goto(f"{stack['dashboard']}&scene={SCENE}")
        shown.wait_for_selector(f"{at('live-status')}[data-state='on']")
        yield shown
        browser.close()
    assert wrong == []


def at(name: str) -> str:
    return f'[data-testid="{name}"]'


def test_the_home_is_shown_with_its_objects_and_regions(page: Any, mapped: dict[str, Any]) -> None:
    expect = playwright.expect
    expect(page.locator(at("object-count"))).to_have_text(str(mapped["objects"]))
    expect(page.locator(at("plan-object"))).to_have_count(mapped["objects"])
    expect(page.locator(at("region-count"))).to_have_text(str(mapped["regions"]))
    assert page.locator(f"{at('plan-object')}[data-label='laptop']").count() == 1
    assert page.locator(f"{at('plan-svg')} image").count() == 1
    expect(page.locator(at("space"))).to_have_attribute("data-points", re.compile(r"[1-9]\d+"))
    expect(page.locator(at("space"))).to_have_attribute("data-drawn", re.compile(r"[1-9]"))


def test_a_question_typed_into_it_is_answered_with_its_evidence(page: Any) -> None:
    page.fill(at("query-input"), "where is the laptop?")
    page.press(at("query-input"), "Enter")
    page.wait_for_selector(f"{at('answer-outcome')}[data-outcome='found']")
    assert "laptop" in page.text_content(at("answer-outcome"))
    assert page.text_content(at("answer-position"))
    page.wait_for_selector(f"{at('evidence')}[data-drawn='true']")
    page.wait_for_selector(at("plan-found"))


def test_what_is_not_there_is_said_with_what_it_would_take(page: Any) -> None:
    page.fill(at("query-input"), "piano")
    page.click(at("query-submit"))
    page.wait_for_selector(f"{at('answer-outcome')}[data-outcome='unresolved']")
    assert "viewpoints" in page.text_content(at("answer-needs"))
    for tier in (1, 2, 3, 4):
        assert page.text_content(at(f"tier-{tier}"))


def test_the_regions_are_listed_with_their_areas_and_one_clicked_is_marked(page: Any) -> None:
    page.click(at("tab-regions"))
    rows = page.locator(at("region-item"))
    playwright.expect(rows.first).to_contain_text("m²")
    rows.first.click()
    marked = page.locator(f"{at('plan-region')}[data-current='true']")
    playwright.expect(marked).to_have_attribute("data-id", rows.first.get_attribute("data-id"))


def test_the_command_line_draws_the_same_regions_and_writes_maps_for_robots(
    cli: Cli, stack: dict[str, Any], mapped: dict[str, Any], tmp_path: Path
) -> None:
    said = cli.json(
        *("regions", SCENE, "--recompute", "--data-dir", stack["data"]),
        *(
            "--plot",
            tmp_path / "plan.png",
            "--polygons",
            tmp_path / "rooms.json",
            "--nav2",
            tmp_path / "maps",
        ),
    )
    assert len(said["regions"]) == mapped["regions"]
    assert (tmp_path / "plan.png").read_bytes().startswith(b"\x89PNG")
    assert (tmp_path / "maps" / "floor-0.yaml").read_text().startswith("image: floor-0.pgm\n")
    polygons = json.loads((tmp_path / "rooms.json").read_text())
    assert [feature["id"] for feature in polygons["features"]] == [r["region_id"] for r in said["regions"]]
