"""What every reader does: bytes to a message, a number on the wire to a member of an enum."""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum
from typing import TypeVar

from google.protobuf.message import DecodeError, Message

from ovip.errors import Corrupt

_Message = TypeVar("_Message", bound=Message)
_Member = TypeVar("_Member", bound=Enum)


def parsed(kind: type[_Message], data: bytes) -> _Message:
    """The message; Corrupt where the bytes are none."""
    try:
        return kind.FromString(data)
    except DecodeError as error:
        raise Corrupt(f"{kind.__name__}: {len(data)} bytes do not parse") from error


def member(members: Mapping[int, _Member], number: int, what: str) -> _Member:
    """The member that `number` stands for; Corrupt where none does (written by a newer version)."""
    if number not in members:
        raise Corrupt(f"{what} {number} is not known")
    return members[number]
