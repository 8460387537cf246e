"""Every error this system raises on purpose, each with its gRPC and HTTP status as data.

OvipError
├── InvalidInput            what was sent is wrong; says what was expected        INVALID_ARGUMENT     422
│   └── TooLarge            larger than the limit, which it names                 RESOURCE_EXHAUSTED   413
├── NotFound                no such scene, object, frame, search                  NOT_FOUND            404
├── Conflict                made on an older version, or someone else holds it    ABORTED              409
│   └── LeaseLost           another writer took over; stop writing                ABORTED              409
├── NotConfigured           a setting is missing; names it                        FAILED_PRECONDITION  409
├── Unreliable              what was measured does not settle it; says what was   FAILED_PRECONDITION  409
├── NotAuthorized           missing or wrong key                                  UNAUTHENTICATED      401
├── Exhausted               a budget or rate limit is used up; says when again    RESOURCE_EXHAUSTED   429
├── Unavailable             a service or the store cannot be reached; try again   UNAVAILABLE          503
├── DeadlineExceeded        took longer than the caller allowed                   DEADLINE_EXCEEDED    504
└── Corrupt                 stored bytes are not what was written                 DATA_LOSS            500
"""

from __future__ import annotations

from typing import ClassVar


class OvipError(Exception):
    """Base of the tree; `code` is a gRPC status name, `http` an HTTP status, `slug` the problem type."""

    code: ClassVar[str] = "INTERNAL"
    http: ClassVar[int] = 500
    slug: ClassVar[str] = "internal"


class InvalidInput(OvipError):
    """What was sent is wrong; the message says what was expected."""

    code = "INVALID_ARGUMENT"
    http = 422
    slug = "invalid-input"


class TooLarge(InvalidInput):
    """Larger than the limit that the message names."""

    code = "RESOURCE_EXHAUSTED"
    http = 413
    slug = "too-large"


class NotFound(OvipError):
    """No such scene, object, frame or search."""

    code = "NOT_FOUND"
    http = 404
    slug = "not-found"


class Conflict(OvipError):
    """Made on an older version, or someone else holds the thing."""

    code = "ABORTED"
    http = 409
    slug = "conflict"


class LeaseLost(Conflict):
    """Another writer took over this scene; this one must stop writing."""

    slug = "lease-lost"


class NotConfigured(OvipError):
    """A setting is missing; the message names it."""

    code = "FAILED_PRECONDITION"
    http = 409
    slug = "not-configured"


class Unreliable(OvipError):
    """What was measured does not settle what was asked; the message says what was measured and what would do."""

    code = "FAILED_PRECONDITION"
    http = 409
    slug = "unreliable"


class NotAuthorized(OvipError):
    """The API key is missing or wrong."""

    code = "UNAUTHENTICATED"
    http = 401
    slug = "not-authorized"


class Exhausted(OvipError):
    """A budget or rate limit is used up; the message says when to try again."""

    code = "RESOURCE_EXHAUSTED"
    http = 429
    slug = "exhausted"


class Unavailable(OvipError):
    """A service or the store cannot be reached; trying again may help."""

    code = "UNAVAILABLE"
    http = 503
    slug = "unavailable"


class DeadlineExceeded(OvipError):
    """It took longer than the caller allowed."""

    code = "DEADLINE_EXCEEDED"
    http = 504
    slug = "deadline-exceeded"


class Corrupt(OvipError):
    """Stored bytes are not what was written."""

    code = "DATA_LOSS"
    http = 500
    slug = "corrupt"


def from_status(code: str, message: str, slug: str = "") -> OvipError:
    """The error that a gRPC status stands for: by its `slug` (sent as metadata) where known, else by code."""
    for kind in _all_kinds(OvipError):
        if slug and kind.slug == slug:
            return kind(message)
    for kind in _all_kinds(OvipError):
        if kind.code == code:
            return kind(message)
    return OvipError(f"{code}: {message}")


def _all_kinds(kind: type[OvipError]) -> list[type[OvipError]]:
    return [kind, *(deep for child in kind.__subclasses__() for deep in _all_kinds(child))]
