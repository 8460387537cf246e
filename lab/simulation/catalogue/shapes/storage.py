"""What holds things: cabinets, shelves, boxes, baskets, bags, composed."""

from __future__ import annotations

from lab.simulation.catalogue.composed import Recipe
from lab.simulation.catalogue.sculpt import Sculpt


def cabinet(s: Sculpt, w: float, d: float, h: float, rows: int, columns: int, foot: float = 0.05) -> None:
    """A body with `rows` x `columns` fronts, each with a handle."""
    body = h - foot
    s.box((0, 0.01, foot + body / 2), (w, d - 0.02, body))
    s.box((0, 0.03, foot / 2), (w - 0.06, d - 0.08, foot), "dark")
    for row in range(rows):
        for column in range(columns):
            x = -w / 2 + w * (column + 0.5) / columns
            z = foot + body * (row + 0.5) / rows
            s.box((x, -d / 2 + 0.01, z), (w / columns - 0.01, 0.02, body / rows - 0.01))
            if rows > 1:
                s.box((x, -d / 2 - 0.008, z), (0.14, 0.016, 0.014), "steel")
            else:
                side = 1 if column < columns / 2 else -1
                s.box((x + side * (w / columns / 2 - 0.05), -d / 2 - 0.008, z), (0.014, 0.016, 0.16), "steel")


def chest_of_drawers(s: Sculpt, w: float, d: float, h: float) -> None:
    """Drawers 22 cm high."""
    cabinet(s, w, d, h, max(2, round(h / 0.22)), 1 if w < 0.9 else 2)


def wardrobe(s: Sculpt, w: float, d: float, h: float) -> None:
    """Doors half a metre wide."""
    cabinet(s, w, d, h, 1, max(2, round(w / 0.5)))


def kitchen_cabinet(s: Sculpt, w: float, d: float, h: float) -> None:
    """Doors under a worktop."""
    cabinet(s, w, d - 0.02, h - 0.04, 1, max(1, round(w / 0.5)), 0.1)
    s.box((0, 0, h - 0.02), (w, d, 0.04), "gray")


def cupboard(s: Sculpt, w: float, d: float, h: float) -> None:
    """Hangs on the wall."""
    cabinet(s, w, d, h, 1, max(1, round(w / 0.45)), 0.0005)


def filing_cabinet(s: Sculpt, w: float, d: float, h: float) -> None:
    """Drawers 30 cm high."""
    cabinet(s, w, d, h, max(2, round(h / 0.3)), 1, 0.02)


def nightstand(s: Sculpt, w: float, d: float, h: float) -> None:
    """Two drawers."""
    cabinet(s, w, d, h, 2, 1, 0.08)


def tv_stand(s: Sculpt, w: float, d: float, h: float) -> None:
    """Two doors, an open middle."""
    s.box((0, 0, h - 0.015), (w, d, 0.03))
    s.box((0, 0, 0.06), (w, d, 0.03))
    s.box((0, d / 2 - 0.01, h / 2), (w, 0.02, h - 0.05))
    for x in (-1, 1):
        s.box((x * w / 3, 0, h / 2), (w / 3, d - 0.01, h - 0.06))
        s.box((x * w * 0.2, -d / 2 - 0.008, h / 2), (0.014, 0.016, 0.12), "steel")
    s.box((0, 0, 0.025), (w * 0.9, d * 0.8, 0.05), "dark")


def shelf(s: Sculpt, w: float, d: float, h: float) -> None:
    """Open boards 35 cm apart, nothing on them."""
    for x in (-1, 1):
        s.box((x * (w / 2 - 0.012), 0, h / 2), (0.024, d, h))
    count = max(2, round(h / 0.35))
    for i in range(count + 1):
        s.box((0, 0, 0.03 + (h - 0.05) * i / count), (w - 0.03, d, 0.022))
    s.box((0, d / 2 - 0.006, h / 2), (w, 0.012, h))


def bookshelf(s: Sculpt, w: float, d: float, h: float) -> None:
    """A shelf, books on all boards but the highest."""
    shelf(s, w, d, h)
    count = max(2, round(h / 0.35))
    for i in range(count - 1):
        z = 0.04 + (h - 0.05) * i / count
        tall = 0.75 * h / count
        wide = (w - 0.06) * (0.97 - 0.14 * ((i * 7) % 3))
        s.box((-(w - 0.06 - wide) / 2, 0.02, z + tall / 2), (wide, 0.7 * d, tall), "books", whole=True)


def shoe_rack(s: Sculpt, w: float, d: float, h: float) -> None:
    """Three boards on two cheeks."""
    for x in (-1, 1):
        s.box((x * (w / 2 - 0.015), 0, h / 2), (0.03, d, h))
    for z in (0.1, 0.52, 0.97):
        s.box((0, 0, z * h), (w, d, 0.02))


def box(s: Sculpt, w: float, d: float, h: float) -> None:
    """Closed, a lid of another tone."""
    s.box((0, 0, 0.42 * h), (0.97 * w, 0.97 * d, 0.84 * h))
    s.box((0, 0, 0.9 * h), (w, d, 0.2 * h))
    s.box((0, 0, 0.999 * h), (0.25 * w, 1.002 * d, 0.004), "cream")


def crate(s: Sculpt, w: float, d: float, h: float) -> None:
    """Slats around a floor, open above."""
    s.box((0, 0, 0.01), (w, d, 0.02))
    for z in (0.25, 0.55, 0.88):
        for side in (-1, 1):
            s.box((0, side * (d / 2 - 0.008), z * h), (w, 0.016, 0.2 * h))
            s.box((side * (w / 2 - 0.008), 0, z * h), (0.016, d, 0.2 * h))
    for x in (-1, 1):
        for y in (-1, 1):
            s.box((x * (w / 2 - 0.03), y * (d / 2 - 0.03), h / 2), (0.03, 0.03, h))


def basket(s: Sculpt, w: float, _d: float, h: float) -> None:
    """Woven, wider at its rim, empty."""
    r = w / 2
    s.turned(((0, 0), (0.78 * r, 0), (0.96 * r, 0.9 * h), (r, 0.92 * h), (r, h), (0.93 * r, h)), smooth=False)
    s.turned(((0.93 * r, h), (0.76 * r, 0.02), (0, 0.02)))


def bin_(s: Sculpt, w: float, _d: float, h: float) -> None:
    """A bucket of tin with a swing lid."""
    r = w / 2
    s.turned(((0, 0), (0.86 * r, 0), (r, 0.82 * h)))
    s.turned(((r, 0.82 * h), (r, 0.86 * h), (0.5 * r, h), (0, h)), finish="dark", smooth=False)


def bucket(s: Sculpt, w: float, _d: float, h: float) -> None:
    """Open, with a handle."""
    r = w / 2
    s.turned(((0, 0), (0.75 * r, 0), (r, 0.78 * h), (0.94 * r, 0.78 * h), (0.7 * r, 0.03), (0, 0.03)))
    arc = ((-r, 0, 0.75 * h), (-0.7 * r, 0, 0.93 * h), (0, 0, h), (0.7 * r, 0, 0.93 * h), (r, 0, 0.75 * h))
    s.tube(arc, 0.004, "steel")


def bag(s: Sculpt, w: float, d: float, h: float) -> None:
    """A shoulder bag with two handles."""
    s.soft((0, 0, 0.31 * h), (w, d, 0.62 * h), power=0.35)
    for y in (-1, 1):
        arc = ((-0.25, 0.55), (-0.2, 0.85), (0, 0.98), (0.2, 0.85), (0.25, 0.55))
        s.tube([(x * w, y * 0.25 * d, z * h) for x, z in arc], 0.008, "brown")


def backpack(s: Sculpt, w: float, d: float, h: float) -> None:
    """A pocket in front, two straps behind."""
    s.soft((0, 0.05 * d, h / 2), (w, 0.7 * d, h), power=0.4)
    s.soft((0, -0.3 * d, 0.32 * h), (0.8 * w, 0.38 * d, 0.45 * h), power=0.35)
    for x in (-1, 1):
        strap = ((0.36, 0.9), (0.5, 0.65), (0.5, 0.35), (0.36, 0.12))
        s.tube([(x * 0.25 * w, y * d, z * h) for y, z in strap], 0.012, "dark")


def suitcase(s: Sculpt, w: float, d: float, h: float) -> None:
    """Upright on wheels, its handle pulled out."""
    s.soft((0, 0, 0.4 * h + 0.02), (w, d, 0.76 * h), power=0.2)
    for x in (-1, 1):
        s.box((x * 0.3 * w, 0, 0.015), (0.04, 0.8 * d, 0.03), "black")
        s.box((x * 0.22 * w, 0.25 * d, 0.87 * h), (0.014, 0.014, 0.24 * h), "steel")
    s.box((0, 0.25 * d, h - 0.012), (0.5 * w, 0.03, 0.024), "black")


def tray(s: Sculpt, w: float, d: float, h: float) -> None:
    """A floor and a rim."""
    s.box((0, 0, 0.1 * h), (w, d, 0.2 * h))
    for side in (-1, 1):
        s.box((0, side * (d / 2 - 0.006), h / 2), (w, 0.012, h))
        s.box((side * (w / 2 - 0.006), 0, h / 2), (0.012, d, h))


RECIPES: dict[str, Recipe] = {
    "chest of drawers": Recipe(chest_of_drawers, "wood", ((0.9, 0.45, 0.85), (1.3, 0.48, 0.8)), 1.0),
    "wardrobe": Recipe(wardrobe, "wood", ((1.5, 0.6, 2.1), (1.0, 0.58, 2.0)), None),
    "kitchen cabinet": Recipe(kitchen_cabinet, "white", ((0.6, 0.6, 0.88), (1.0, 0.6, 0.88)), 1.0),
    "kitchen island": Recipe(kitchen_cabinet, "white", ((1.5, 0.9, 0.9),), 1.0),
    "cupboard": Recipe(cupboard, "white", ((0.6, 0.35, 0.7), (0.9, 0.35, 0.7)), None),
    "filing cabinet": Recipe(filing_cabinet, "gray", ((0.42, 0.55, 0.68), (0.42, 0.55, 1.3)), 1.0),
    "nightstand": Recipe(nightstand, "wood", ((0.45, 0.4, 0.5), (0.5, 0.42, 0.55)), 1.0),
    "tv stand": Recipe(tv_stand, "wood", ((1.5, 0.42, 0.48), (1.2, 0.4, 0.45)), 1.0),
    "sideboard": Recipe(wardrobe, "wood", ((1.6, 0.45, 0.8),), 1.0),
    "shelf": Recipe(shelf, "wood", ((0.8, 0.35, 1.1), (0.6, 0.3, 1.7)), 1.0),
    "bookshelf": Recipe(bookshelf, "wood", ((0.9, 0.32, 1.8), (1.2, 0.32, 1.1)), 1.0),
    "shoe rack": Recipe(shoe_rack, "wood", ((0.8, 0.3, 0.5),), 1.0),
    "box": Recipe(box, "crust", ((0.4, 0.3, 0.25), (0.3, 0.2, 0.14), (0.55, 0.38, 0.32)), 1.0),
    "crate": Recipe(crate, "wood", ((0.55, 0.4, 0.3),), None),
    "basket": Recipe(basket, "woven", ((0.36, 0.36, 0.3), (0.28, 0.28, 0.2)), None),
    "laundry basket": Recipe(basket, "woven", ((0.45, 0.45, 0.6),), None),
    "bin": Recipe(bin_, "steel", ((0.28, 0.28, 0.42), (0.34, 0.34, 0.6)), None),
    "bucket": Recipe(bucket, "blue", ((0.3, 0.3, 0.36),), None),
    "bag": Recipe(bag, "brown", ((0.36, 0.14, 0.36), (0.28, 0.12, 0.26)), None),
    "backpack": Recipe(backpack, "blue", ((0.32, 0.24, 0.46),), None),
    "suitcase": Recipe(suitcase, "dark", ((0.42, 0.26, 0.7),), None),
    "tray": Recipe(tray, "wood", ((0.42, 0.3, 0.04),), 0.25),
}
