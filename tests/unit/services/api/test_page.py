"""The page in a real browser, over the flat in memory."""

from __future__ import annotations

import asyncio
import io
import re
import shutil
from collections.abc import AsyncIterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import pytest_asyncio
from fastapi import FastAPI
from PIL import Image

from ovip.errors import InvalidInput
from ovip.scene.types import Frontier, RegionEvent, RegionEventKind
from services.api.config import Settings
from services.api.domain.palette import TINT, region_colors
from services.api.server.listening import listening
from tests.unit.services.api.flat import Flat

playwright = pytest.importorskip(
    "playwright.async_api", reason="playwright is not installed: page not tested"
)
expect = playwright.expect
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
    pytest.mark.asyncio(loop_scope="module"),
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="no chromium on PATH: page not tested"),
]


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def browser() -> AsyncIterator[Any]:
    """One Chromium for all tests: starting it takes seconds."""
    async with playwright.async_playwright() as driver:
        started = await driver.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield started
        await started.close()


@pytest_asyncio.fixture(loop_scope="module")
async def base_url(app: FastAPI, stopping: asyncio.Event) -> AsyncIterator[str]:
    async with listening(app, "127.0.0.1", 0, stopping) as port:
        yield f"http://127.0.0.1:{port}"


@pytest_asyncio.fixture(loop_scope="module")
async def page(browser: Any, base_url: str) -> AsyncIterator[Any]:
    """A page of its own session; an error it logs, or a request to another host, fails the test."""
    wrong: list[str] = []
    context = await browser.new_context(viewport={"width": 1280, "height": 800}, base_url=base_url)
    shown = await context.new_page()
    shown.set_default_timeout(15_000)
    shown.on("pageerror", lambda error: wrong.append(str(error)))
    shown.on("console", lambda said: wrong.append(said.text) if "Security Policy" in said.text else None)
    shown.on("request", lambda asked: wrong.append(asked.url) if _elsewhere(asked.url, base_url) else None)
    yield shown
    await context.close()
    assert wrong == []


def _elsewhere(url: str, base_url: str) -> bool:
    return not url.startswith((base_url, "data:", "blob:"))


def at(name: str) -> str:
    return f'[data-testid="{name}"]'


async def opened(page: Any, path: str = "/") -> None:
    await page.goto(path)
    await page.wait_for_selector(f'{at("live-status")}[data-state="on"]')


async def ask(page: Any, text: str) -> None:
    await page.fill(at("query-input"), text)
    await page.press(at("query-input"), "Enter")


async def test_the_map_is_shown_as_a_plan_and_in_3d(page: Any) -> None:
    await opened(page)
    assert await page.text_content(at("object-count")) == "17"
    assert await page.text_content(at("region-count")) == "3"
    assert await page.locator(at("plan-object")).count() == 17
    assert await page.locator(at("plan-region")).count() == 3
    written = await page.locator(f"{at('plan-svg')} text").all_text_contents()
    assert {"living room", "kitchen", "bathroom", "sofa"} <= set(written)
    await page.wait_for_selector(f"{at('space')}[data-points='2040']")
    await expect(page.locator(at("space"))).to_have_attribute("data-drawn", re.compile(r"[2-9]|\d\d"))
    picture = np.asarray(
        Image.open(io.BytesIO(await page.locator(at("space-canvas")).screenshot())).convert("RGB")
    )
    assert len(np.unique(picture.reshape(-1, 3), axis=0)) > 100


async def test_a_typed_question_is_answered_tier_by_tier(page: Any, home: Flat) -> None:
    home.tier_pause_s = 0.3
    await opened(page)
    await ask(page, "white mug")
    await page.wait_for_selector(f"{at('tier-1')}[data-result='running']")
    await page.wait_for_selector(f"{at('tier-2')}[data-result='running']")
    await page.wait_for_selector(f"{at('answer-outcome')}[data-outcome='found']")
    assert await page.text_content(at("answer-outcome")) == "Found the mug in tier 2"
    assert "2 objects are called mug" in await page.text_content(at("tier-1"))
    answer = await page.text_content(at("answer"))
    assert "In the kitchen, on the dining table" in answer
    assert "6.25, 4.05, 0.81" in await page.text_content(at("answer-position"))
    await page.wait_for_selector(f"{at('evidence')}[data-drawn='true']")
    assert await page.locator(at("candidate")).count() == 1
    assert "no VLM configured" in await page.text_content(at("fallbacks"))
    for mark in ("plan-path", "plan-goal", "plan-found", "plan-robot"):
        assert await page.locator(at(mark)).count() == 1


async def test_what_is_not_found_says_what_would_decide_it(page: Any) -> None:
    await opened(page)
    await ask(page, "piano")
    await page.wait_for_selector(f"{at('answer-outcome')}[data-outcome='unresolved']")
    assert "18 viewpoints" in await page.text_content(at("answer-needs"))
    assert "0 of 18 viewpoints visited" in await page.text_content(at("answer-coverage"))
    assert await page.locator(f"{at('coverage')} meter").count() == 3


async def test_an_object_that_a_robot_maps_appears_by_itself(page: Any, home: Flat) -> None:
    await opened(page)
    home.grow("lamp", (3.0, 4.8, 0.0, 3.4, 5.2, 1.5), "r-living")
    await page.wait_for_selector(f"{at('plan-object')}[data-label='lamp']")
    await expect(page.locator(at("object-count"))).to_have_text("18")
    await page.wait_for_selector(f"{at('space')}[data-points='2160']")


async def test_a_steady_stream_of_changes_is_followed_while_it_lasts(page: Any, home: Flat) -> None:
    await opened(page)
    for number in range(60):
        home.grow("crumb", (1.0 + number / 50, 3.0, 0.0, 1.01 + number / 50, 3.01, 0.01), "r-living")
        await asyncio.sleep(0.03)
    assert int(await page.text_content(at("object-count"))) > 17
    await expect(page.locator(at("object-count"))).to_have_text("77")


async def test_the_keyboard_alone_reaches_everything(page: Any) -> None:
    await opened(page)
    await page.keyboard.press("/")
    await page.keyboard.type("sofa")
    await page.keyboard.press("Enter")
    await page.wait_for_selector(f"{at('answer-outcome')}[data-outcome='found']")
    await page.focus(at("tab-answer"))
    await page.keyboard.press("ArrowRight")
    assert await page.get_attribute(at("tab-objects"), "aria-selected") == "true"
    await page.keyboard.press("Tab")
    await page.keyboard.type("plant")
    assert await page.locator(at("object-item")).count() == 1
    await page.keyboard.press("Tab")
    await page.keyboard.press("Enter")
    await page.wait_for_selector(f"{at('plan-object')}[data-label='plant'][data-current='true']")
    await page.focus(at("plan-svg"))
    world = page.locator(f"{at('plan-svg')} > g").first
    before = await world.get_attribute("transform")
    await page.keyboard.press("+")
    await expect(world).not_to_have_attribute("transform", before)


async def test_a_click_on_the_plan_selects_and_a_hover_describes(page: Any) -> None:
    await opened(page)
    await page.hover(f"{at('plan-object')}[data-label='refrigerator'] rect")
    assert "kitchen · 0.7 × 0.7 × 1.8 m" in await page.text_content(at("plan-tip"))
    await page.click(f"{at('plan-object')}[data-label='refrigerator'] rect")
    await page.click(at("tab-objects"))
    assert "refrigerator" in await page.text_content(f"{at('object-item')}[aria-current='true']")


async def test_regions_are_listed_with_their_ways_and_marked_on_the_plan(page: Any, home: Flat) -> None:
    home.upstairs = True
    home.frontiers = (Frontier(0, "r-bath", np.array([8.0, 1.0, 0.0]), 1.2),)
    await opened(page)
    for mark in ("plan-doorway", "plan-stairs", "plan-frontier"):
        assert await page.locator(at(mark)).count() == 1
    written = await page.locator(f"{at('plan-svg')} text").all_text_contents()
    assert {"0.9 m", "up to floor 1", "unexplored"} <= set(written)
    await page.click(at("tab-regions"))
    kitchen = page.locator(f"{at('region-item')}[data-id='r-kitchen']")
    await expect(kitchen).to_contain_text("kitchen 7 objects · floor 0doorway 0.9 m to living room9.0 m²")
    await kitchen.hover()
    await expect(page.locator(f"{at('plan-region')}[data-id='r-kitchen']")).to_have_attribute(
        "data-pointed", ""
    )
    await page.click(f"{at('region-item')}[data-id='r-attic']")
    await expect(page.locator(at("plan-region"))).to_have_count(1)
    await expect(page.locator(at("floor-picker"))).to_have_value("1")
    await expect(page.locator(f"{at('plan-svg')} text", has_text="down to floor 0")).to_have_count(1)


async def test_a_region_pointed_at_on_the_plan_is_described_and_a_click_selects_it(page: Any) -> None:
    await opened(page)
    bath = page.locator(f"{at('plan-region')}[data-id='r-bath']")
    box = await bath.bounding_box()
    middle = (box["x"] + 0.3 * box["width"], box["y"] + 0.35 * box["height"])
    await page.mouse.move(*middle)
    assert "bathroom8.7 m² · 3 objects" in await page.text_content(at("plan-tip"))
    await page.mouse.click(*middle)
    await expect(page.locator(f"{at('region-item')}[aria-current='true']")).to_contain_text("bathroom")
    assert await page.is_visible(at("region-list"))


async def test_a_new_partition_redraws_the_plan_and_says_what_changed(page: Any, home: Flat) -> None:
    await opened(page)
    assert not await page.is_visible(at("region-changes"))
    gone = home.regions.pop()
    home.regions[1] = replace(home.regions[1], function="pantry", display_name="pantry")
    home.cut_anew(
        RegionEvent(RegionEventKind.VANISHED, gone.region_id, 0, gone.display_name, "r-living"),
        RegionEvent(RegionEventKind.RETYPED, "r-kitchen", 0, "pantry"),
    )
    await expect(page.locator(at("region-changes"))).to_have_text(
        "bathroom is gone (now living room); r-kitchen is now called pantry"
    )
    await expect(page.locator(at("plan-region"))).to_have_count(2)
    await expect(page.locator(at("region-count"))).to_have_text("2")


async def test_regions_have_the_colours_of_the_picture(page: Any, home: Flat) -> None:
    await opened(page)
    bath = page.locator(f"{at('plan-region')}[data-id='r-bath']")
    assert await bath.get_attribute("fill") == region_colors(home.regions)["r-bath"]
    opacity = await bath.evaluate("node => getComputedStyle(node).fillOpacity")
    assert float(opacity) == pytest.approx(TINT)


async def test_what_goes_wrong_is_said_in_words(page: Any, home: Flat) -> None:
    await opened(page)
    await ask(page, "refuse")
    await page.wait_for_selector(at("answer-problem"))
    assert await page.text_content(at("answer-problem")) == "text: expected a thing to look for"
    home.broken = InvalidInput("mapper: out of order")
    await ask(page, "sofa")
    await expect(page.locator(at("answer-problem"))).to_have_text("mapper: out of order")


async def test_a_stack_without_scenes_says_how_to_begin_and_goes_on_by_itself(page: Any, home: Flat) -> None:
    home.empty = True
    await page.goto("/")
    await page.wait_for_selector(at("notice"))
    assert "ovip replay" in await page.text_content(at("notice"))
    home.empty = False
    await page.wait_for_selector(f'{at("live-status")}[data-state="on"]')
    assert not await page.is_visible(at("notice"))


async def test_dark_is_dark(page: Any) -> None:
    await page.emulate_media(color_scheme="dark")
    await opened(page)
    color = await page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert color == "rgb(18, 22, 27)"


class TestWithAKey:
    @pytest.fixture
    def settings(self) -> Settings:
        return Settings(api_port=0, api_key="secret", _env_file=None)

    async def test_the_link_with_the_key_opens_and_the_key_leaves_the_address(self, page: Any) -> None:
        await opened(page, "/?key=secret&scene=flat")
        assert page.url.endswith("/?scene=flat")
        await ask(page, "sofa")
        await page.wait_for_selector(f"{at('evidence')}[data-drawn='true']")
        await page.reload()
        await page.wait_for_selector(f'{at("live-status")}[data-state="on"]')

    async def test_without_it_the_page_asks_and_a_wrong_one_is_told(self, page: Any) -> None:
        await page.goto("/")
        await page.fill(at("key-input"), "guess")
        await page.click(at("key-submit"))
        await expect(page.locator("#key-why")).to_contain_text("not the right one")
        await page.fill(at("key-input"), "secret")
        await page.click(at("key-submit"))
        await page.wait_for_selector(f'{at("live-status")}[data-state="on"]')
        assert not await page.is_visible(at("key-dialog"))
