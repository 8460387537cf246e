"""Everything that decides how detections become objects, as one value that can be written down with the map."""

from __future__ import annotations

import dataclasses
import json
import typing
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from ovip.errors import Corrupt
from services.mapper.domain.association import AssociationParams
from services.mapper.domain.fusion import FusionParams
from services.mapper.domain.presence import PresenceParams
from services.mapper.domain.relations import RelationParams
from services.mapper.domain.upkeep import UpkeepParams


@dataclass(frozen=True, slots=True)
class MapParams:
    """voxel: metres (paper: 0.02). The others stand beside what they decide."""

    association: AssociationParams = AssociationParams()
    fusion: FusionParams = FusionParams()
    upkeep: UpkeepParams = UpkeepParams()
    presence: PresenceParams = PresenceParams()
    relations: RelationParams = RelationParams()
    voxel: float = 0.02


def params_json(params: MapParams) -> str:
    """The settings as text, the same for the same settings."""
    return json.dumps(dataclasses.asdict(params), sort_keys=True)


def params_of(text: str | bytes) -> MapParams:
    """The settings that `params_json` wrote; Corrupt where they are none, or name what this version does not know."""
    try:
        return typing.cast(MapParams, _value(MapParams, json.loads(text)))
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        raise Corrupt(f"map settings: expected what this version of the mapper writes ({error})") from error


def _value(kind: Any, plain: Any) -> Any:
    if dataclasses.is_dataclass(kind):
        kinds = typing.get_type_hints(kind)
        return kind(**{name: _value(kinds[name], value) for name, value in plain.items()})  # type: ignore[operator]
    if isinstance(kind, type) and issubclass(kind, StrEnum):
        return kind(plain)
    return tuple(plain) if isinstance(plain, list) else plain
