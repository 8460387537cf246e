"""The error tree: what travels over the wire comes back as the same kind."""

from __future__ import annotations

import grpc
import pytest

from ovip import errors
from ovip.errors import (
    Exhausted,
    InvalidInput,
    LeaseLost,
    NotFound,
    OvipError,
    TooLarge,
    Unavailable,
    from_status,
)


def _kinds(kind: type[OvipError] = OvipError) -> list[type[OvipError]]:
    return [kind, *(deep for child in kind.__subclasses__() for deep in _kinds(child))]


@pytest.mark.parametrize("kind", _kinds())
def test_every_error_comes_back_from_its_slug_as_itself(kind: type[OvipError]) -> None:
    again = from_status(kind.code, "why", kind.slug)

    assert type(again) is kind
    assert str(again) == "why"


@pytest.mark.parametrize("kind", _kinds())
def test_every_error_has_a_grpc_status_that_exists_and_an_http_error_status(kind: type[OvipError]) -> None:
    assert kind.code in grpc.StatusCode.__members__
    assert 400 <= kind.http < 600


def test_slugs_are_unique() -> None:
    slugs = [kind.slug for kind in _kinds()]

    assert len(slugs) == len(set(slugs))


def test_the_tree_drawn_in_the_docstring_is_the_tree() -> None:
    drawn = errors.__doc__ or ""

    for kind in _kinds():
        line = next(line for line in drawn.splitlines() if kind.__name__ in line.split())
        if kind is not OvipError:
            assert line.split()[-2:] == [kind.code, str(kind.http)]


def test_without_a_slug_the_status_decides() -> None:
    assert type(from_status("NOT_FOUND", "m")) is NotFound
    assert type(from_status("UNAVAILABLE", "m")) is Unavailable
    assert type(from_status("ABORTED", "m")) is errors.Conflict


def test_a_message_over_the_transport_limit_reads_as_too_large() -> None:
    """gRPC itself refuses it, with RESOURCE_EXHAUSTED and no slug."""
    assert type(from_status("RESOURCE_EXHAUSTED", "larger than max")) is TooLarge
    assert type(from_status("RESOURCE_EXHAUSTED", "m", Exhausted.slug)) is Exhausted


def test_an_unknown_status_keeps_its_name() -> None:
    again = from_status("CANCELLED", "gone")

    assert type(again) is OvipError
    assert str(again) == "CANCELLED: gone"


def test_an_unknown_slug_falls_back_to_the_status() -> None:
    assert type(from_status("INVALID_ARGUMENT", "m", "from-the-future")) is InvalidInput


def test_losing_a_lease_is_a_conflict() -> None:
    assert issubclass(LeaseLost, errors.Conflict)
