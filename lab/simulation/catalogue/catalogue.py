"""The catalogue of models: Debian's Sweet Home 3D furniture, and composed shapes for what it lacks."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from lab.simulation.catalogue.composed import composed_shelf
from lab.simulation.catalogue.dressing import dressed
from lab.simulation.catalogue.model import Model, Shelf, Size, Undressed, Variant
from lab.simulation.catalogue.models import FEW
from lab.simulation.catalogue.sweet_home import FURNITURE, sweet_home_shelf
from ovip.errors import InvalidInput, NotFound


class Catalogue:
    """Variants by label from one or more shelves, built on demand; what was built stays in memory.

    source: in a few words, where the models come from.
    """

    def __init__(self, source: str, shelves: Sequence[Shelf]) -> None:
        self.source = source
        self._by_label: dict[str, tuple[Variant, ...]] = {}
        self._shelf_of: dict[str, Shelf] = {}
        for shelf in shelves:
            for variant in shelf.variants:
                self._by_label[variant.label] = (*self._by_label.get(variant.label, ()), variant)
                self._shelf_of[variant.name] = shelf
        self._made: dict[tuple[str, Size], Undressed] = {}

    @property
    def labels(self) -> frozenset[str]:
        """Every label that has a variant; the same with and without the package."""
        return frozenset(self._by_label)

    def variants(self, label: str) -> tuple[Variant, ...]:
        """The models of a label, in a fixed order. NotFound for a label that the catalogue does not have."""
        if label not in self._by_label:
            raise NotFound(f"no model of {label!r}; the catalogue has {', '.join(sorted(self._by_label))}")
        return self._by_label[label]

    def build(self, variant: Variant, attribute: str | None = None, size: Size | None = None) -> Model:
        """The variant, in a colour or pattern of its `attributes`, stretched to `size` metres if given.

        InvalidInput for an attribute that it cannot have.
        """
        if attribute is not None and attribute not in variant.attributes:
            raise InvalidInput(
                f"{variant.name} can be {variant.attributes or 'nothing else'}, not {attribute!r}"
            )
        measure = variant.size if size is None else size
        made = self._make(variant, measure)
        mesh = made.mesh if attribute is None else dressed(made.mesh, made.main, attribute)
        top = None if variant.top is None else variant.top * measure[2] / variant.size[2]
        return Model(mesh, measure, top, made.attribution)

    def _make(self, variant: Variant, size: Size) -> Undressed:
        key = (variant.name, size)
        if key not in self._made:
            self._made[key] = self._shelf_of[variant.name].make(variant, size)
        return self._made[key]


def open_catalogue(folder: Path | None = None) -> Catalogue:
    """The models in the `.sh3f` files of `folder`, None = where Debian puts them; what they lack is composed.

    Where the folder is absent everything is composed. Labels are the same either way.
    """
    where = FURNITURE if folder is None else folder
    everything = composed_shelf()
    carriers = {variant.label for variant in everything.variants if variant.top is not None}
    real = sweet_home_shelf(where, carriers)
    if not real.variants:
        return Catalogue("composed shapes", [everything])
    have = {variant.label for variant in real.variants} - FEW
    lacking = {variant.label for variant in everything.variants} - have
    return Catalogue("Sweet Home 3D furniture library", [real, composed_shelf(lacking)])
