"""Every key in the store, in one place; all keys of one scene share one hash tag, so one cluster slot.

SCENES                        set of scene names
{default/SCENE}:stream:NAME   a product's log: frames, detections, map, regions; edits, snapshots of the map
{default/SCENE}:once:NAME     hash, key of an entry -> its id in the log NAME, where entries are kept once a key
{default/SCENE}:sequences     hash, "robot.session" -> last sequence in the frame log
{default/SCENE}:frame-ids     hash, frame id -> id of its entry in the frame log
{default/SCENE}:lease:STAGE   the one writer of a stage: owner, with expiry
{default/SCENE}:fence:STAGE   counts lease holders; a writer with an older number is refused
{default/SCENE}:state:STAGE   hash: cursors (last input committed of each log) and the stage's small values
{default/SCENE}:doc:KIND      hash, name -> revision and bytes of a compare-and-set document
bucket:NAME, counter:NAME, cache:KEY    the gateway's budgets, statistics and replies
"""

from __future__ import annotations

import re

from ovip.errors import InvalidInput

SCENES = "ovip:scenes"
TENANT = "default"
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,63}")


def check_name(name: str, what: str) -> str:
    """`name` itself, where it can stand in keys, file names and frame ids; else InvalidInput."""
    if not _NAME.fullmatch(name):
        raise InvalidInput(
            f"{what} {name[:80]!r}: expected 1 to 64 letters, digits, '_' or '-', starting with a letter or digit"
        )
    return name


def log_order(log_id: str) -> tuple[int, int]:
    """Where an entry's id stands in its log; an empty id stands before all."""
    first, _, second = log_id.partition("-")
    return int(first or 0), int(second or 0)


def stream(scene: str, name: str) -> str:
    return f"{_tag(scene)}:stream:{name}"


def sequences(scene: str) -> str:
    return f"{_tag(scene)}:sequences"


def frame_ids(scene: str) -> str:
    return f"{_tag(scene)}:frame-ids"


def once(scene: str, name: str) -> str:
    return f"{_tag(scene)}:once:{name}"


def lease(scene: str, stage: str) -> str:
    return f"{_tag(scene)}:lease:{stage}"


def fence(scene: str, stage: str) -> str:
    return f"{_tag(scene)}:fence:{stage}"


def state(scene: str, stage: str) -> str:
    return f"{_tag(scene)}:state:{stage}"


def documents(scene: str, kind: str) -> str:
    return f"{_tag(scene)}:doc:{kind}"


def bucket(name: str) -> str:
    return f"ovip:bucket:{name}"


def counter(name: str) -> str:
    return f"ovip:counter:{name}"


def cache(key: str) -> str:
    return f"ovip:cache:{key}"


def _tag(scene: str) -> str:
    return f"{{{TENANT}/{check_name(scene, 'scene')}}}"
