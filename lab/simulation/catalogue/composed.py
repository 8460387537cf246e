"""The catalogue of composed shapes: every label, with no package installed."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass

from lab.simulation.catalogue.model import Shelf, Size, Undressed, Variant, fitted
from lab.simulation.catalogue.sculpt import Sculpt
from lab.simulation.catalogue.words import ATTRIBUTES, elevation_of

Shape = Callable[[Sculpt, float, float, float], None]
"""Puts a thing of width, depth, height together."""

COMPOSED = "Composed shape by the authors of this software, Apache-2.0"


@dataclass(frozen=True, slots=True)
class Recipe:
    """How a label is composed. finish: of its main parts. sizes: one per variant.

    top: height of the surface that carries things, as a share of the height; None = it carries nothing.
    """

    shape: Shape
    finish: str
    sizes: tuple[Size, ...]
    top: float | None = None


class ComposedShelf:
    """Recipes as a shelf of a catalogue; `labels` None = all of them."""

    def __init__(self, recipes: dict[str, Recipe], labels: Collection[str] | None = None) -> None:
        self._recipes = recipes
        self.variants: tuple[Variant, ...] = tuple(
            Variant(
                label=label,
                name=f"composed/{label}/{number}",
                size=size,
                top=None if recipe.top is None else recipe.top * size[2],
                attributes=ATTRIBUTES.get(label, ()),
                elevation=elevation_of(label),
            )
            for label, recipe in sorted(recipes.items())
            if labels is None or label in labels
            for number, size in enumerate(recipe.sizes, start=1)
        )

    def make(self, variant: Variant, size: Size) -> Undressed:
        """The shape put together to measure `size`."""
        recipe = self._recipes[variant.label]
        sculpt = Sculpt(recipe.finish)
        recipe.shape(sculpt, *size)
        return Undressed(fitted(sculpt.mesh(), size), (0,), COMPOSED)


def composed_shelf(labels: Collection[str] | None = None) -> Shelf:
    """Composed shapes of these labels; None = of all labels."""
    from lab.simulation.catalogue.shapes import RECIPES

    return ComposedShelf(RECIPES, labels)
