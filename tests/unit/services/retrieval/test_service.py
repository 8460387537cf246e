from __future__ import annotations

import asyncio
import itertools
from collections.abc import AsyncIterator, Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import pytest_asyncio

from ovip.errors import InvalidInput, NotFound
from ovip.scene.answers import (
    Answer,
    Observation,
    Outcome,
    Query,
    TierResult,
    TierStarted,
    Viewpoint,
)
from ovip.scene.navigation import region_at
from ovip.scene.types import F64, EdgeKind, Floor, Frontier, RegionEdge
from ovip.store import Store
from services.retrieval.adapters.crops import OpenCvCrops
from services.retrieval.adapters.searches import StoredSearches
from services.retrieval.case import Limits
from services.retrieval.domain.viewpoints import ViewpointParams
from services.retrieval.evidence import FrameHistory, Sources, TextSpace
from services.retrieval.opening import Desk
from services.retrieval.robot_search import Cancel, Resume
from services.retrieval.service import Retrieval
from tests.unit.services.retrieval.builders import (
    BROWN,
    DARK,
    WHITE,
    NoVlm,
    ScriptedVlm,
    World,
    box_at,
    detection,
    frame,
    grid_of,
    mapped,
    messages,
    partition,
    pose_at,
    region,
)

GRID = grid_of(
    "\n".join(["#" * 26, *["#" + "k" * 12 + "b" * 12 + "#"] * 12, "#" * 26]),
    0.25,
    {"k": "r1", "b": "r2"},
)
ROOMS = partition(
    region("r1", "kitchen", (1.75, 1.75), ["cup1", "cup2", "table"], ["f000", "f001", "f002"]),
    region("r2", "bedroom", (4.75, 1.75), [], ["f003"]),
)
FRAMES = [frame(f"f{k:03d}", pose_at(1.0 + 0.1 * k, 1.0, 0.0), ("table",)) for k in range(4)]
TABLE = mapped("table", "dining table", np.array([1.0, 1.5, 0.0, 2.5, 2.5, 0.75]), BROWN)
CUP1 = mapped("cup1", "cup", box_at(1.5, 2.0, 0.80), DARK, frames=30)
CUP2 = mapped("cup2", "cup", box_at(2.2, 2.2, 0.80), WHITE, frames=6)
KITCHEN = [TABLE, CUP1, CUP2]
_IDS = itertools.count(1)


def build(store: Store, world: World, vlm: Any = None, limits: Limits | None = None) -> Retrieval:
    limits = limits or Limits(viewpoint=ViewpointParams(views=1, reach=3.0))
    desk = Desk(
        sources=Sources(world, world, world, world),
        scenes=store,
        vlm=vlm or NoVlm(),
        crops=OpenCvCrops(),
        limits=limits,
        max_vlm_calls=20,
        text_space=TextSpace(world),
        history=FrameHistory(world),
    )
    ticks = itertools.count()
    return Retrieval(desk, StoredSearches(store, 60.0), lambda: next(ticks) * 1e-3, lambda: f"s{next(_IDS)}")


@pytest_asyncio.fixture
async def home(store: Store) -> AsyncIterator[Store]:
    await store.add_scene("home")
    yield store


async def ask(retrieval: Retrieval, text: str, **changes: Any) -> Answer:
    events = [event async for _, event in retrieval.find(Query("home", text, **changes))]
    assert isinstance(events[-1], Answer)
    return events[-1]


def kitchen(**changes: Any) -> World:
    return World(**{"objects": KITCHEN, "regions": ROOMS, "grids": {0: GRID}, "frames": FRAMES, **changes})


# Tier 1


async def test_one_table_is_found_by_name_with_goal_and_path(home: Store) -> None:
    answer = await ask(build(home, kitchen()), "where is the table?", robot_pose=pose_at(5.0, 1.0, 0.0))
    assert (answer.outcome, answer.tier) == (Outcome.FOUND, 1)
    assert answer.object is not None
    assert answer.object.object_id == "table"
    assert answer.goal is not None
    np.testing.assert_allclose(answer.path[-1], answer.goal.position)
    assert len(answer.path) > 3
    assert (answer.map_version, answer.regions_revision) == (7, 3)
    assert answer.tiers[0].vlm_calls == 0
    assert answer.fallbacks == ()


async def test_without_a_robot_pose_the_way_starts_at_the_newest_frame(home: Store) -> None:
    answer = await ask(build(home, kitchen()), "table")
    assert len(answer.path)
    assert np.linalg.norm(answer.path[0, :2] - FRAMES[-1].world_from_camera[:2, 3]) < 0.5


async def test_without_a_grid_the_object_is_found_and_the_missing_path_is_said(home: Store) -> None:
    answer = await ask(build(home, kitchen(grids={})), "table")
    assert answer.outcome is Outcome.FOUND
    assert answer.goal is None
    assert not len(answer.path)
    assert answer.object is not None
    assert "no floor grid" in answer.object.why


# Tier 2, instances


async def test_the_white_mug_of_two_cups_is_picked_by_mapped_colours_and_says_so(home: Store) -> None:
    answer = await ask(build(home, kitchen()), "white mug")
    assert (answer.outcome, answer.tier) == (Outcome.FOUND, 2)
    assert answer.object is not None
    assert answer.object.object_id == "cup2"
    assert [report.result for report in answer.tiers] == [TierResult.AMBIGUOUS, TierResult.FOUND]
    assert any(
        "mapped colours" in fallback and "no VLM configured" in fallback for fallback in answer.fallbacks
    )
    assert [candidate.object_id for candidate in answer.rejected] == ["cup1"]


async def test_equal_chairs_are_found_best_seen_first_the_others_as_candidates(home: Store) -> None:
    chairs = [
        mapped(f"c{k}", "chair", box_at(1 + k, 1, 0.5, 0.4), frames=f) for k, f in enumerate([4, 40, 9, 20])
    ]
    answer = await ask(build(home, kitchen(objects=chairs)), "chair")
    assert (answer.outcome, answer.tier) == (Outcome.FOUND, 2)
    assert answer.object is not None
    assert answer.object.object_id == "c1"
    assert [candidate.object_id for candidate in answer.candidates] == ["c3", "c2", "c0"]
    assert answer.fallbacks == ()
    assert sum(report.vlm_calls for report in answer.tiers) == 0


async def test_tier_1_alone_answers_with_equal_instances(home: Store) -> None:
    answer = await ask(build(home, kitchen()), "cup", max_tier=1)
    assert (answer.outcome, answer.tier) == (Outcome.FOUND, 1)
    assert len(answer.candidates) == 1


async def test_tier_1_alone_leaves_attributes_open(home: Store) -> None:
    answer = await ask(build(home, kitchen()), "white mug", max_tier=1)
    assert answer.outcome is Outcome.UNRESOLVED
    assert len(answer.candidates) == 2
    assert "tier 2" in answer.needs


async def test_what_cannot_be_judged_comes_back_as_ranked_candidates(home: Store) -> None:
    towels = [mapped(f"t{k}", "towel", box_at(1 + k, 1, 1)) for k in range(2)]
    answer = await ask(build(home, kitchen(objects=towels)), "the floral towel")
    assert (answer.outcome, answer.tier) == (Outcome.UNRESOLVED, 2)
    assert len(answer.candidates) == 2
    assert "'floral'" in answer.needs
    assert "VLM" in answer.needs
    assert answer.object is None


async def test_relations_are_judged_from_boxes(home: Store) -> None:
    floor_cup = mapped("cup3", "cup", box_at(4.0, 1.0, 0.05), frames=50)
    answer = await ask(build(home, kitchen(objects=[*KITCHEN, floor_cup])), "cup on the table")
    assert answer.outcome is Outcome.FOUND
    assert answer.object is not None
    assert answer.object.object_id == "cup1"
    assert [candidate.object_id for candidate in answer.rejected] == ["cup3"]


async def test_what_is_on_the_table_lists_what_is_on_it(home: Store) -> None:
    answer = await ask(build(home, kitchen()), "what is on the table?")
    assert answer.outcome is Outcome.FOUND
    assert answer.object is not None
    assert {answer.object.object_id, *(c.object_id for c in answer.candidates)} == {"cup1", "cup2"}


async def test_a_place_narrows_the_question_to_its_region(home: Store) -> None:
    elsewhere = mapped("cup9", "cup", box_at(5.0, 1.0, 0.8), frames=90)
    rooms = replace(ROOMS, regions=(ROOMS.regions[0], replace(ROOMS.regions[1], object_ids=("cup9",))))
    retrieval = build(home, kitchen(objects=[CUP1, elsewhere], regions=rooms))
    for answer in (
        await ask(retrieval, "cup in the kitchen"),
        await ask(retrieval, "cup", region_hint="kitchen"),
    ):
        assert answer.object is not None
        assert answer.object.object_id == "cup1"
    missed = await ask(retrieval, "cup", region_hint="ballroom")
    assert any("ballroom" in note for note in missed.fallbacks)


async def test_a_vlm_judges_the_crops_and_its_calls_are_counted(home: Store) -> None:
    def yes_to_the_first(prompt: str, images: int) -> object:
        assert images == 2
        return {
            "verdicts": [
                {"image": k + 1, "matches": "yes" if k == 0 else "no", "confidence": 0.9, "reason": "seen"}
                for k in range(images)
            ]
        }

    vlm = ScriptedVlm(yes_to_the_first)
    answer = await ask(build(home, kitchen(), vlm), "patterned mug")
    assert (answer.outcome, answer.tier) == (Outcome.FOUND, 2)
    assert answer.object is not None
    assert answer.object.object_id == "cup1"
    assert answer.tiers[1].vlm_calls == 1
    assert answer.fallbacks == ()


async def test_the_budget_of_vlm_calls_is_kept(home: Store) -> None:
    cups = [mapped(f"c{k:02d}", "cup", box_at(k * 0.2, 1, 1)) for k in range(20)]
    vlm = ScriptedVlm(lambda *_: {"verdicts": []})
    answer = await ask(build(home, kitchen(objects=cups), vlm), "patterned mug", max_vlm_calls=2)
    assert len(vlm.asked) == 2
    assert any("2 VLM calls are used up" in fallback for fallback in answer.fallbacks)


async def test_a_vlm_that_answers_nonsense_falls_back(home: Store) -> None:
    answer = await ask(build(home, kitchen(), ScriptedVlm(lambda *_: "hm")), "white mug")
    assert answer.object is not None
    assert answer.object.object_id == "cup2"
    assert answer.fallbacks


# Tier 2, tags; tier 3


def seen_kettle(*frame_ids: str) -> dict[str, list[Any]]:
    return {frame_id: [detection("kettle", 2.0, 2.0, 0.9)] for frame_id in frame_ids}


FEATURE = np.array([1.0, 0.0, 0.0, 0.0], np.float32)


def kettle_world(*frame_ids: str, tags: tuple[str, ...] = ("table",), **changes: Any) -> World:
    seen = {f: [detection("kettle", 2.0, 2.0, 0.9, feature=FEATURE)] for f in frame_ids}
    tagged = [replace(record, tags=tags) for record in FRAMES]
    words = dict.fromkeys(("kettle", "teakettle", "electric kettle"), FEATURE)
    return kitchen(frames=tagged, seen=seen, features=words, space="minilm", **changes)


async def test_a_tagged_thing_that_is_not_mapped_is_grounded_on_the_best_frame(home: Store) -> None:
    world = kettle_world("f000", "f001", "f002", "f003", tags=("kettle",))
    answer = await ask(build(home, world), "kettle")
    assert (answer.outcome, answer.tier) == (Outcome.FOUND, 2)
    assert answer.object is not None
    np.testing.assert_allclose(answer.object.position, [2.0, 2.0, 0.9], atol=1e-6)
    assert answer.object.object_id == ""
    assert len(world.grounded) == 1
    assert any("encoder features" in fallback for fallback in answer.fallbacks)


async def test_a_thing_that_was_never_tagged_is_voted_for_in_the_history(home: Store) -> None:
    answer = await ask(build(home, kettle_world("f000", "f001", "f002")), "kettle")
    assert (answer.outcome, answer.tier) == (Outcome.FOUND, 3)
    assert answer.object is not None
    np.testing.assert_allclose(answer.object.position, [2.0, 2.0, 0.9], atol=1e-6)
    assert "3 frames agree" in answer.object.why
    assert any("priors: room table" in fallback for fallback in answer.fallbacks)


async def test_two_frames_are_too_few_votes(home: Store) -> None:
    answer = await ask(build(home, kettle_world("f000", "f001")), "kettle", max_tier=3)
    assert answer.outcome is Outcome.UNRESOLVED
    assert answer.tiers[-1].result is TierResult.MISSING
    assert "max_tier 3" in answer.needs


async def test_a_voted_thing_that_looks_like_something_else_is_rejected(home: Store) -> None:
    other = {f: [detection("kettle", 2.0, 2.0, 0.9, feature=-FEATURE)] for f in ("f000", "f001", "f002")}
    world = kettle_world()
    world.seen = {key: tuple(value) for key, value in other.items()}
    answer = await ask(build(home, world), "kettle")
    assert answer.outcome is Outcome.UNRESOLVED
    assert answer.tiers[2].result is TierResult.REJECTED
    assert answer.rejected[0].label == "kettle"


async def test_the_likeliest_region_is_searched_first(home: Store) -> None:
    world = kettle_world("f000", "f001", "f002")
    await ask(build(home, world), "kettle")
    assert world.grounded == ["f000", "f001", "f002"]


async def test_an_instance_that_was_rejected_is_not_found_again_in_the_history(home: Store) -> None:
    seen = {f"f{k:03d}": [detection("cup", 1.5, 2.0, 0.8, color=DARK)] for k in range(4)}
    answer = await ask(build(home, kitchen(objects=[CUP1], seen=seen)), "red mug")
    assert answer.outcome is Outcome.UNRESOLVED
    assert answer.tiers[1].result is TierResult.REJECTED
    assert [candidate.object_id for candidate in answer.rejected] == ["cup1"]


# Tier 4 planned


async def test_a_piano_is_unresolved_and_the_answer_says_what_tier_4_would_need(home: Store) -> None:
    answer = await ask(build(home, kitchen(groundable=lambda word: word != "piano")), "piano")
    assert (answer.outcome, answer.tier) == (Outcome.UNRESOLVED, 4)
    assert [report.result for report in answer.tiers] == [
        TierResult.MISSING,
        TierResult.MISSING,
        TierResult.MISSING,
        TierResult.WAITING,
    ]
    assert "no way to see 'piano'" in answer.tiers[2].why
    assert "a robot to visit" in answer.needs
    assert "2 regions" in answer.needs
    assert "a grounder that can see 'piano'" in answer.needs
    assert answer.coverage is not None
    assert answer.coverage.planned > 0
    assert answer.coverage.visited == 0
    assert not answer.coverage.complete


async def test_an_empty_scene_answers_honestly(home: Store) -> None:
    answer = await ask(build(home, World()), "mug")
    assert answer.outcome is Outcome.UNRESOLVED
    assert "no regions" in answer.needs
    assert answer.tiers[0].why == "the map holds no objects yet"
    assert answer.coverage is None


async def test_min_tier_4_skips_the_others(home: Store) -> None:
    answer = await ask(build(home, kitchen()), "table", min_tier=4)
    assert [report.result for report in answer.tiers] == [*[TierResult.SKIPPED] * 3, TierResult.WAITING]


async def test_events_come_in_order_and_the_answer_last(home: Store) -> None:
    events = [event async for _, event in build(home, kitchen()).find(Query("home", "piano"))]
    kinds = [type(event).__name__ for event in events]
    assert kinds == [*["TierStarted", "TierReport"] * 4, "Answer"]
    assert [event.tier for event in events if isinstance(event, TierStarted)] == [1, 2, 3, 4]


# Purposes


async def test_a_purpose_without_a_vlm_gives_ranked_candidates(home: Store) -> None:
    chair = mapped("c1", "chair", box_at(1, 1, 0.5, 0.4))
    features = {"sit": FEATURE, "chair": FEATURE}
    world = kitchen(objects=[chair], features=features, space="minilm")
    answer = await ask(build(home, world), "somewhere to sit")
    assert answer.outcome is Outcome.UNRESOLVED
    assert answer.candidates[0].object_id == "c1"
    assert any(fallback.startswith("purpose") for fallback in answer.fallbacks)


async def test_a_vlm_names_what_serves_a_purpose(home: Store) -> None:
    chair = mapped("c1", "chair", box_at(1, 1, 0.5, 0.4))
    vlm = ScriptedVlm(lambda *_: {"objects": ["bench", "chair"]})
    answer = await ask(build(home, kitchen(objects=[chair]), vlm), "somewhere to sit")
    assert answer.outcome is Outcome.FOUND
    assert answer.object is not None
    assert answer.object.object_id == "c1"


# Bad input


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"text": ""}, "expected a thing to look for"),
        ({"text": "x" * 501}, "at most 500"),
        ({"max_tier": 5}, "max_tier"),
        ({"min_tier": 3, "max_tier": 2}, "min_tier"),
        ({"robot_pose": np.full((4, 4), np.nan)}, "pose"),
        ({"robot_radius": -1.0}, "radius"),
        ({"robot_radius": float("nan")}, "radius"),
        ({"scene": "a b"}, "scene"),
    ],
)
async def test_bad_input_is_refused_saying_what_was_expected(
    home: Store, changes: dict[str, Any], said: str
) -> None:
    query = replace(Query("home", "mug"), **changes)
    with pytest.raises(InvalidInput, match=said):
        [event async for event in build(home, kitchen()).find(query)]


async def test_an_unknown_scene_is_not_found(home: Store) -> None:
    with pytest.raises(NotFound, match="nowhere"):
        [event async for event in build(home, kitchen()).find(Query("nowhere", "mug"))]


# Active search


class Robot:
    """Answers viewpoints with frames of its own: what it sees is decided by `sees(position)`."""

    def __init__(self, world: World, sees: Callable[[F64], list[Any]] = lambda _: []) -> None:
        self.world = world
        self.sees = sees
        self.viewpoints: list[Viewpoint] = []

    def look(self, viewpoint: Viewpoint) -> Observation:
        self.viewpoints.append(viewpoint)
        frame_id = f"f{100 + len(self.world.history):03d}"
        pose = pose_at(*viewpoint.position[:2], viewpoint.yaw)
        self.world.history.append(frame(frame_id, pose))
        self.world.seen[frame_id] = tuple(self.sees(viewpoint.position))
        return Observation(viewpoint.viewpoint_id, frame_id)


async def drive(
    retrieval: Retrieval, first: Any, answer_to: Callable[[Viewpoint], Any], hang_up_after: int = 10_000
) -> tuple[str, list[Any]]:
    """Runs a search; `answer_to` says what the robot sends for a viewpoint. -> search id, events."""
    queue: list[Any] = [first]

    async def sending() -> AsyncIterator[Any]:
        while queue:
            yield queue.pop(0)

    events: list[tuple[str, Any]] = []
    sent = 0
    async for pair in retrieval.search(sending()):
        events.append(pair)
        if isinstance(pair[1], Viewpoint) and sent < hang_up_after:
            sent += 1
            queue.append(answer_to(pair[1]))
    return events[-1][0], [event for _, event in events]


START = Query("home", "kettle", robot_pose=pose_at(1.0, 1.0, 0.0), min_tier=4)


async def test_a_robot_finds_what_three_frames_agree_on(home: Store) -> None:
    world = kettle_world()
    robot = Robot(world, lambda _: [detection("kettle", 2.0, 2.0, 0.9, feature=FEATURE)])
    _, events = await drive(build(home, world), START, robot.look)
    answer = events[-1]
    assert isinstance(answer, Answer)
    assert (answer.outcome, answer.tier) == (Outcome.FOUND, 4)
    assert len(robot.viewpoints) == 3
    assert [v.index for v in robot.viewpoints] == [1, 2, 3]
    assert answer.coverage is not None
    assert answer.coverage.visited == 3
    assert answer.goal is not None
    assert answer.tiers[-1].result is TierResult.FOUND


async def test_a_search_that_sees_everything_and_nothing_ends_in_absent(home: Store) -> None:
    world = kettle_world()
    robot = Robot(world)
    search_id, events = await drive(build(home, world), START, robot.look)
    answer = events[-1]
    assert isinstance(answer, Answer)
    assert (answer.outcome, answer.tier) == (Outcome.ABSENT, 4)
    coverage = answer.coverage
    assert coverage is not None
    assert coverage.planned == coverage.visited == len(robot.viewpoints) == robot.viewpoints[0].total
    assert coverage.complete
    assert all(r.seen > 0.9 for r in coverage.regions)
    # prior .8 (a kettle in a kitchen); seen at least once everywhere leaves less than half
    assert coverage.posterior_present < 0.6
    text, stored = await build(home, world).get_search("home", search_id)
    assert text == "kettle"
    assert stored is not None
    assert stored.outcome is Outcome.ABSENT


async def test_the_kitchen_comes_first_for_a_kettle_and_paths_lead_there(home: Store) -> None:
    world = kettle_world()
    robot = Robot(world)
    await drive(build(home, world), START, robot.look)
    assert robot.viewpoints[0].region_id == "r1"
    moved = robot.viewpoints[6]
    assert moved.viewpoint_id.split(".")[0] != robot.viewpoints[0].viewpoint_id.split(".")[0]
    np.testing.assert_allclose(moved.path[-1, :2], moved.position[:2], atol=0.3)


async def test_unreachable_places_are_counted_and_absence_is_not_complete(home: Store) -> None:
    world = kettle_world()
    robot = Robot(world)
    blocked: set[str] = set()

    def sometimes(viewpoint: Viewpoint) -> Observation:
        waypoint = viewpoint.viewpoint_id.split(".")[0]
        if not blocked or waypoint in blocked:
            blocked.add(waypoint)
            return Observation(viewpoint.viewpoint_id, unreachable=True)
        return robot.look(viewpoint)

    _, events = await drive(build(home, world), START, sometimes)
    answer = events[-1]
    assert answer.outcome is Outcome.ABSENT
    assert answer.coverage.unreachable == 6
    assert not answer.coverage.complete


async def test_where_nothing_can_be_reached_nothing_is_concluded(home: Store) -> None:
    world = kettle_world()
    _, events = await drive(
        build(home, world), START, lambda v: Observation(v.viewpoint_id, unreachable=True)
    )
    assert events[-1].outcome is Outcome.UNRESOLVED
    assert "reach" in events[-1].needs


async def test_a_used_up_budget_leaves_it_unresolved(home: Store) -> None:
    world = kettle_world()
    robot = Robot(world)
    _, events = await drive(build(home, world), replace(START, max_viewpoints=2), robot.look)
    answer = events[-1]
    assert answer.outcome is Outcome.UNRESOLVED
    assert answer.tiers[-1].result is TierResult.EXHAUSTED
    assert len(robot.viewpoints) == 2
    assert "budget" in answer.needs


async def test_another_replica_goes_on_where_the_robot_was(home: Store) -> None:
    world = kettle_world()
    robot = Robot(world)
    whole = kettle_world()
    other = Robot(whole)
    search_id, events = await drive(build(home, world), START, robot.look, hang_up_after=4)
    assert isinstance(events[-1], Viewpoint)
    assert await build(home, world).get_search("home", search_id) == ("kettle", None)
    _, rest = await drive(build(home, world), Resume(f"home/{search_id}"), robot.look)
    await drive(build(home, whole), START, other.look)
    assert [v.viewpoint_id for v in robot.viewpoints] == [v.viewpoint_id for v in other.viewpoints]
    assert rest[-1].outcome is Outcome.ABSENT
    _, again = await drive(build(home, world), Resume(search_id), robot.look)
    assert len(again) == 1
    assert again[0].outcome is Outcome.ABSENT


async def test_a_duplicate_observation_changes_nothing(home: Store) -> None:
    world = kettle_world()
    robot = Robot(world)
    first: list[Observation] = []

    def twice(viewpoint: Viewpoint) -> Observation:
        if len(first) == 1:
            first.append(first[0])
            return first[0]
        observation = robot.look(viewpoint)
        first.append(observation)
        return observation

    _, events = await drive(build(home, world), START, twice)
    due = [event.viewpoint_id for event in events if isinstance(event, Viewpoint)]
    assert due[1] == due[2]
    assert events[-1].coverage.visited == events[-1].coverage.planned


async def test_a_search_can_be_cancelled_and_stays_cancelled(home: Store) -> None:
    world = kettle_world()
    robot = Robot(world)
    sent: list[Any] = []

    def once(viewpoint: Viewpoint) -> Any:
        sent.append(viewpoint)
        return robot.look(viewpoint) if len(sent) == 1 else Cancel()

    search_id, events = await drive(build(home, world), START, once)
    assert events[-1].outcome is Outcome.UNRESOLVED
    assert "cancelled" in events[-1].tiers[-1].why
    _, again = await drive(build(home, world), Resume(search_id), robot.look)
    assert [type(event) for event in again] == [Answer]


async def test_a_search_answered_by_tier_1_never_sends_the_robot(home: Store) -> None:
    _, events = await drive(build(home, kitchen()), Query("home", "table"), lambda _: pytest.fail("sent"))
    assert events[-1].outcome is Outcome.FOUND
    assert events[-1].tier == 1


async def test_a_word_that_cannot_be_seen_ends_unresolved_not_absent(home: Store) -> None:
    world = kettle_world(groundable=lambda _: False)
    _, events = await drive(build(home, world), START, Robot(world).look)
    assert events[-1].outcome is Outcome.UNRESOLVED
    assert "grounder" in events[-1].needs


async def test_a_frame_that_perception_does_not_hold_is_refused_and_the_search_stays(home: Store) -> None:
    world = kettle_world()
    seen: list[str] = []

    async def sending() -> AsyncIterator[Any]:
        yield START
        yield Observation(seen[0], "f999")

    retrieval = build(home, world)
    ids: set[str] = set()

    async def run() -> None:
        async for search_id, event in retrieval.search(sending()):
            ids.add(search_id)
            if isinstance(event, Viewpoint):
                seen.append(event.viewpoint_id)

    with pytest.raises(NotFound, match="f999"):
        await run()
    _, events = await drive(retrieval, Resume(ids.pop()), Robot(world).look, hang_up_after=0)
    assert isinstance(events[-1], Viewpoint)


@pytest.mark.parametrize("first", [Observation("w000.0", "f000"), Cancel()])
async def test_a_search_begins_with_a_start_or_a_resume(home: Store, first: Any) -> None:
    with pytest.raises(InvalidInput, match="first message"):
        [event async for event in build(home, kitchen()).search(messages(first))]


async def test_an_unknown_search_is_not_found(home: Store) -> None:
    with pytest.raises(NotFound):
        [event async for event in build(home, kitchen()).search(messages(Resume("home/none")))]
    with pytest.raises(NotFound):
        await build(home, kitchen()).get_search("home", "none")


async def test_a_plain_question_can_be_read_again(home: Store) -> None:
    retrieval = build(home, kitchen())
    events = [pair async for pair in retrieval.find(Query("home", "table"))]
    text, answer = await retrieval.get_search("home", events[-1][0])
    assert text == "table"
    assert answer is not None
    assert answer.outcome is Outcome.FOUND


async def test_eyes_on_board_beyond_the_grounder_are_not_ruled_out(home: Store) -> None:
    # perception's own grounder knows only tables; tags show robots that see kettles by themselves
    world = kettle_world("f000", "f001", "f002", tags=("kettle", "table"))
    world.onboard = True
    world.groundable = lambda word: word == "table"
    answer = await ask(build(home, world), "kettle")
    assert answer.outcome is Outcome.FOUND


async def test_a_scene_of_a_hundred_words_is_probed_a_few_at_a_time(home: Store) -> None:
    words = tuple(f"thing {k:03d}" for k in range(100))
    world = kettle_world("f000", "f001", "f002", tags=("kettle", *words))
    world.onboard = True
    world.groundable = lambda word: word in words[:70]
    assert (await ask(build(home, world), "kettle")).outcome is Outcome.FOUND


async def test_a_search_whose_every_look_was_blind_is_not_absent(home: Store) -> None:
    world = kettle_world(tags=("teapot",), groundable=lambda _: False)
    _, events = await drive(build(home, world), START, Robot(world).look)
    assert events[-1].outcome is Outcome.UNRESOLVED
    assert events[-1].coverage.visited == events[-1].coverage.planned
    assert "known to see 'kettle'" in events[-1].needs


async def test_the_frame_history_is_read_once_and_then_only_what_is_new(home: Store) -> None:
    world = kitchen()
    retrieval = build(home, world)
    await ask(retrieval, "table")
    first = len(world.listed)
    world.history.append(frame("f004", pose_at(5.5, 1.5, 0.0)))
    answer = await ask(retrieval, "table")
    assert world.listed[first:] == ["4-0", "5-0"]
    assert np.linalg.norm(answer.path[0, :2] - [5.5, 1.5]) < 0.5


async def test_two_robots_of_one_map_share_a_search(home: Store) -> None:
    world = kettle_world()
    first, second = Robot(world), Robot(world)
    search_id, _ = await drive(build(home, world), START, first.look, hang_up_after=1)
    ends = await asyncio.gather(
        drive(build(home, world), Resume(search_id), first.look),
        drive(build(home, world), Resume(search_id), second.look),
    )
    answers = [events[-1] for _, events in ends]
    assert [answer.outcome for answer in answers] == [Outcome.ABSENT] * 2
    assert all(answer.coverage.visited == answer.coverage.planned for answer in answers)


async def test_a_budget_that_just_covers_the_plan_ends_in_absent(home: Store) -> None:
    world = kettle_world()
    robot = Robot(world)
    await drive(build(home, world), START, robot.look)
    exact = replace(START, max_viewpoints=len(robot.viewpoints))
    other = kettle_world()
    _, events = await drive(build(home, other), exact, Robot(other).look)
    assert events[-1].outcome is Outcome.ABSENT


# Storeys and what was never seen

UPSTAIRS = replace(GRID, floor=1, region_ids=("r3", "r4"))
TWO_STOREYS = replace(
    ROOMS,
    floors=(*ROOMS.floors, Floor(1, 3.0, None, 20.0)),
    regions=(
        *ROOMS.regions,
        region("r3", "office", (1.75, 1.75), ["lamp"], floor=1),
        region("r4", "bathroom", (4.75, 1.75), floor=1),
    ),
    edges=(
        RegionEdge("r2", "r4", 0.9, np.array([5.6, 1.0, 0.0]), EdgeKind.STAIRS, np.array([5.6, 2.6, 3.0])),
    ),
)
LAMP = mapped("lamp", "lamp", box_at(1.5, 2.0, 3.8))
BEYOND = Frontier(0, "r2", np.array([6.0, 1.5, 0.0]), 1.2)


def two_storeys(**changes: Any) -> World:
    return kitchen(
        **{
            "objects": [*KITCHEN, LAMP],
            "regions": TWO_STOREYS,
            "grids": {0: GRID, 1: UPSTAIRS},
            **changes,
        }
    )


async def test_the_way_to_a_lamp_upstairs_leads_over_the_stairs(home: Store) -> None:
    answer = await ask(build(home, two_storeys()), "lamp", robot_pose=pose_at(1.0, 1.0, 0.0))
    assert answer.outcome is Outcome.FOUND
    assert answer.goal is not None
    assert answer.goal.position[2] == 3.0
    assert [5.6, 1.0, 0.0] in answer.path.tolist()
    assert [5.6, 2.6, 3.0] in answer.path.tolist()
    np.testing.assert_allclose(answer.path[-1], answer.goal.position)


async def test_without_stairs_a_lamp_upstairs_is_found_and_the_missing_way_is_said(home: Store) -> None:
    world = two_storeys(regions=replace(TWO_STOREYS, edges=()))
    answer = await ask(build(home, world), "lamp", robot_pose=pose_at(1.0, 1.0, 0.0))
    assert answer.outcome is Outcome.FOUND
    assert answer.object is not None
    assert not len(answer.path)
    assert "no stairs that were seen lead from floor 0 to floor 1" in answer.object.why


async def test_a_robot_searches_both_storeys_and_walks_the_stairs_between(home: Store) -> None:
    world = two_storeys(objects=[TABLE])
    robot = Robot(world)
    _, events = await drive(build(home, world), START, robot.look)
    answer = events[-1]
    assert answer.outcome is Outcome.ABSENT
    assert answer.coverage.complete
    assert {v.position[2] for v in robot.viewpoints} == {0.0, 3.0}
    climbs = [v for v in robot.viewpoints if len(set(v.path[:, 2])) > 1]
    assert len(climbs) == 1
    assert [5.6, 2.6, 3.0] in climbs[0].path.tolist()
    assert answer.needs == ""


async def test_a_storey_out_of_reach_is_said_with_the_reason(home: Store) -> None:
    world = two_storeys(objects=[TABLE], regions=replace(TWO_STOREYS, edges=()))
    robot = Robot(world)
    _, events = await drive(build(home, world), START, robot.look)
    answer = events[-1]
    assert {v.position[2] for v in robot.viewpoints} == {0.0}
    assert not answer.coverage.complete
    assert "no stairs that were seen lead from floor 0 to floor 1" in answer.tiers[-1].why


async def test_every_viewpoint_names_the_region_it_lies_in(home: Store) -> None:
    world = two_storeys(objects=[TABLE])
    robot = Robot(world)
    await drive(build(home, world), START, robot.look)
    grids = {0: GRID, 1: UPSTAIRS}
    for viewpoint in robot.viewpoints:
        assert viewpoint.region_id == region_at(TWO_STOREYS, grids, viewpoint.position)


async def test_an_absence_with_unexplored_floor_in_reach_says_so(home: Store) -> None:
    world = kettle_world(regions=replace(ROOMS, frontiers=(BEYOND,)))
    _, events = await drive(build(home, world), START, Robot(world).look)
    answer = events[-1]
    assert answer.outcome is Outcome.ABSENT
    assert answer.tiers[-1].why.endswith("; unexplored floor begins beyond the bedroom (1.2 m wide)")
    assert answer.needs == "a look at what nobody has seen: beyond the bedroom (1.2 m wide)"


async def test_unexplored_floor_out_of_reach_or_elsewhere_than_asked_is_left_out(home: Store) -> None:
    away = replace(BEYOND, floor=1, position=np.array([6.0, 1.5, 3.0]))
    world = kettle_world(regions=replace(ROOMS, frontiers=(away,)))
    _, events = await drive(build(home, world), START, Robot(world).look)
    assert (events[-1].outcome, events[-1].needs) == (Outcome.ABSENT, "")
    world = kettle_world(regions=replace(ROOMS, frontiers=(BEYOND,)))
    in_kitchen = replace(START, region_hint="kitchen")
    _, events = await drive(build(home, world), in_kitchen, Robot(world).look)
    assert (events[-1].outcome, events[-1].needs) == (Outcome.ABSENT, "")


async def test_floor_explored_while_searching_is_no_longer_unexplored(home: Store) -> None:
    world = kettle_world(regions=replace(ROOMS, frontiers=(BEYOND, replace(BEYOND, width=0.7))))
    robot = Robot(world)

    def exploring(viewpoint: Viewpoint) -> Observation:
        world.partition = replace(ROOMS, revision=4, frontiers=(replace(BEYOND, region_id="r1", width=0.7),))
        return robot.look(viewpoint)

    _, events = await drive(build(home, world), START, exploring)
    assert events[-1].needs == "a look at what nobody has seen: beyond the kitchen (0.7 m wide)"
