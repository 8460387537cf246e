"""Keys: one hash tag a scene, and names that can stand in keys, file names and frame ids."""

from __future__ import annotations

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ovip import keys
from ovip.errors import InvalidInput

NAMES = st.from_regex(r"[A-Za-z0-9][A-Za-z0-9_-]{0,63}", fullmatch=True)


@pytest.mark.parametrize("name", ["kitchen", "A", "7scenes", "my-home_2", "x" * 64])
def test_a_plain_name_is_taken(name: str) -> None:
    assert keys.check_name(name, "scene") == name


@pytest.mark.parametrize(
    "name",
    ["", " ", "-a", "_a", "a b", "a/b", "../etc", "a.b", "a\n", "a{b}", "küche", "x" * 65, "a:b", "\0"],
)
def test_a_name_that_cannot_stand_in_a_key_is_refused_in_words(name: str) -> None:
    with pytest.raises(InvalidInput, match=r"^scene .*expected 1 to 64 letters, digits"):
        keys.check_name(name, "scene")


def test_a_very_long_name_is_not_echoed_whole() -> None:
    with pytest.raises(InvalidInput) as refused:
        keys.check_name("x" * 10_000, "scene")

    assert len(str(refused.value)) < 300


@given(NAMES)
def test_all_keys_of_a_scene_share_one_hash_tag(scene: str) -> None:
    made = _keys_of(scene)

    assert {re.search(r"\{(.*?)\}", key).group(1) for key in made} == {f"default/{scene}"}  # type: ignore[union-attr]


@given(NAMES, NAMES)
def test_two_scenes_share_no_key(one: str, other: str) -> None:
    if one != other:
        assert not set(_keys_of(one)) & set(_keys_of(other))


@given(NAMES)
def test_the_keys_of_one_scene_differ(scene: str) -> None:
    made = _keys_of(scene)

    assert len(made) == len(set(made))


def test_every_key_is_listed_in_the_docstring() -> None:
    text = keys.__doc__ or ""

    for kind in (
        "stream:",
        "once:",
        "sequences",
        "frame-ids",
        "lease:",
        "fence:",
        "state:",
        "doc:",
        "bucket:",
        "counter:",
        "cache:",
    ):
        assert kind in text


def _keys_of(scene: str) -> list[str]:
    return [
        keys.stream(scene, "frames"),
        keys.stream(scene, "map"),
        keys.once(scene, "frames"),
        keys.sequences(scene),
        keys.frame_ids(scene),
        keys.lease(scene, "mapper"),
        keys.fence(scene, "mapper"),
        keys.state(scene, "mapper"),
        keys.documents(scene, "scene"),
    ]
