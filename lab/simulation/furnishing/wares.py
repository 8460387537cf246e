"""Chooses models from the catalogue: of a label, that fit, in a colour that tells them from their like."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from lab.simulation.catalogue import Catalogue, Model, Variant
from lab.simulation.home import Mesh
from ovip.scene.types import F64


class Posture(Enum):
    """How a thing is held: as made; a book on its lower edge, spine to the front; a wall thing under a ceiling."""

    AS_MADE = "as made"
    UPRIGHT = "upright"
    FACING_DOWN = "facing down"


@dataclass(frozen=True, slots=True, eq=False)
class Ware:
    """A thing that can be placed. attributes: what it was asked to look like."""

    label: str
    attributes: tuple[str, ...]
    model: Model

    @property
    def width(self) -> float:
        """Along its x, metres."""
        return self.model.size[0]

    @property
    def depth(self) -> float:
        """Along its y, metres."""
        return self.model.size[1]

    @property
    def height(self) -> float:
        """Metres."""
        return self.model.size[2]


Size = tuple[float, float, float]
_ANY: Size = (9.0, 9.0, 9.0)
_ROTATIONS: dict[Posture, F64] = {
    # on its side, the spine (left edge) to the front: x -> -y, y -> z, z -> -x
    Posture.UPRIGHT: np.array([[0.0, 0, -1], [1, 0, 0], [0, 1, 0]]),
    # the front to below: y -> z, z -> -y
    Posture.FACING_DOWN: np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]),
}
_SHRINK = 0.6  # how far a model may be scaled down to fit


class Wares:
    """Picks wares from a catalogue by chance, and keeps what it built.

    Things of one label and place come in different colours as long as there are any.
    """

    def __init__(self, catalogue: Catalogue, rng: np.random.Generator) -> None:
        self._catalogue = catalogue
        self._rng = rng
        self._postures: dict[tuple[str, str | None, Size, Posture], Model] = {}
        self._used: dict[tuple[str, int], list[str]] = {}

    def pick(
        self,
        label: str,
        place: int = 0,
        most: Size = _ANY,
        least: Size = (0.0, 0.0, 0.0),
        colored: float = 0.8,
        posture: Posture = Posture.AS_MADE,
        exact: tuple[float | None, float | None, float | None] = (None, None, None),
    ) -> Ware | None:
        """A ware of a label between two sizes (metres, as held); scaled down a little if none is small enough.

        place: where it is for (an area's id): there its colour differs from its like. colored: the chance that
        it gets a colour at all. exact: sizes to stretch it to. None where there is nothing that fits.
        """
        if label not in self._catalogue.labels:
            return None
        fits = [v for v in self._catalogue.variants(label) if _within(v.size, least, most, posture)]
        sizes = {v.name: v.size for v in fits}
        if not fits:
            for variant in self._catalogue.variants(label):
                if size := _shrunk(variant.size, least, most, posture):
                    fits.append(variant)
                    sizes[variant.name] = size
        if not fits:
            return None
        variant = fits[int(self._rng.integers(len(fits)))]
        size = sizes[variant.name]
        size = (exact[0] or size[0], exact[1] or size[1], exact[2] or size[2])
        attribute = self._attribute(variant, place) if self._rng.random() < colored else None
        return self.ware(variant, attribute, size, posture)

    def ware(self, variant: Variant, attribute: str | None, size: Size, posture: Posture) -> Ware:
        """That variant, so big and so held."""
        key = (variant.name, attribute, size, posture)
        if key not in self._postures:
            model = self._catalogue.build(variant, attribute, size if size != variant.size else None)
            self._postures[key] = _held(model, posture)
        return Ware(variant.label, (attribute,) if attribute else (), self._postures[key])

    def _attribute(self, variant: Variant, place: int) -> str | None:
        if not variant.attributes:
            return None
        used = self._used.setdefault((variant.label, place), [])
        fresh = [name for name in variant.attributes if name not in used] or list(variant.attributes)
        chosen = fresh[int(self._rng.integers(len(fresh)))]
        used.append(chosen)
        return chosen

    def has(self, labels: Collection[str]) -> tuple[str, ...]:
        """Those of the labels that the catalogue knows, in their order."""
        return tuple(label for label in labels if label in self._catalogue.labels)


def _as_held(size: Size, posture: Posture) -> Size:
    if posture is Posture.AS_MADE:
        return size
    turned = np.abs(_ROTATIONS[posture]) @ np.array(size)
    return (float(turned[0]), float(turned[1]), float(turned[2]))


def _within(size: Size, least: Size, most: Size, posture: Posture) -> bool:
    held = _as_held(size, posture)
    return all(low <= side <= high for low, side, high in zip(least, held, most, strict=True))


def _shrunk(size: Size, least: Size, most: Size, posture: Posture) -> Size | None:
    held = _as_held(size, posture)
    scale = min(1.0, *(high / side for side, high in zip(held, most, strict=True)))
    if scale < _SHRINK or not all(side * scale >= low for side, low in zip(held, least, strict=True)):
        return None
    return (round(size[0] * scale, 4), round(size[1] * scale, 4), round(size[2] * scale, 4))


def _held(model: Model, posture: Posture) -> Model:
    if posture is Posture.AS_MADE:
        return model
    turn = _ROTATIONS[posture]
    vertices = model.mesh.vertices @ turn.T
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    middle = np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]])
    mesh: Mesh = replace(
        model.mesh,
        vertices=(vertices - middle).astype(np.float32),
        normals=(model.mesh.normals @ turn.T).astype(np.float32),
    )
    return replace(model, mesh=mesh, size=_as_held(model.size, posture), top=None)
