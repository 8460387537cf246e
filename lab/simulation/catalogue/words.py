"""What labels can be told apart by, and how high above the floor they usually hang."""

from __future__ import annotations

PAINT = ("white", "black", "red", "green", "blue", "yellow")
CHINA = ("white", "red", "green", "blue", "yellow", "floral", "striped")
CLOTH = ("plain", "floral", "striped", "checked", "dotted", "red", "green", "blue", "yellow", "gray")
WOOD = ("white", "black", "brown", "gray")
BODY = ("white", "black", "gray", "red")

_ATTRIBUTES: tuple[tuple[tuple[str, ...], str], ...] = (
    (
        CHINA,
        """mug, cup, plate, bowl, teapot, vase, jar""",
    ),
    (
        CLOTH,
        """towel, cushion, pillow, blanket, curtain, rug, bath mat, bed, ironing board, clothes, doormat""",
    ),
    (
        PAINT,
        """bottle, book, box, bag, backpack, suitcase, basket, laundry basket, bin, bucket, kettle, toaster, pot,
        pan, candle, remote control, game controller, headphones, slipper, shoe, hat, umbrella, toy car, ball,
        teddy bear, doll, toothbrush, soap, soap dispenser, sponge, chair, stool, sofa, armchair, ottoman, lamp,
        desk lamp, floor lamp, ceiling lamp, clock, picture frame, stapler, scissors, pen holder, yoga mat,
        dumbbell, bicycle, toolbox, radio, iron, mixer, guitar, tray, cell phone, office chair""",
    ),
    (
        WOOD,
        """table, dining table, coffee table, desk, nightstand, wardrobe, chest of drawers, shelf,
        bookshelf, tv stand, sideboard, cupboard, kitchen cabinet, shoe rack, bench, crate, coat rack, piano""",
    ),
    (
        BODY,
        """refrigerator, coffee maker, blender, microwave, laptop, telephone, fan, vacuum cleaner, filing cabinet""",
    ),
)


def _listed(words: str) -> list[str]:
    return [" ".join(word.split()) for word in words.split(",")]


ATTRIBUTES: dict[str, tuple[str, ...]] = {
    label: names for names, words in _ATTRIBUTES for label in _listed(words)
}
"""What a label can be built with: colours and patterns. A label that is not named has one look."""

_ELEVATIONS: dict[str, float] = {
    "wall plug": 0.25,
    "switch": 1.15,
    "smoke detector": 2.2,
    "radiator": 0.1,
    "air conditioner": 2.0,
    "wall lamp": 1.6,
    "ceiling lamp": 1.9,
    "intercom": 1.3,
    "security camera": 2.1,
    "coat rack": 1.6,
    "water heater": 1.5,
    "cupboard": 1.45,
    "range hood": 1.6,
    "towel rack": 1.0,
    "towel": 1.0,
    "toilet paper": 0.65,
    "mirror": 1.2,
    "picture frame": 1.4,
    "whiteboard": 1.0,
    "clock": 1.8,
    "curtain": 0.05,
    "blinds": 1.0,
}


def elevation_of(label: str) -> float:
    """Metres above the floor where such a thing usually hangs; 0 = it stands or lies on something."""
    return _ELEVATIONS.get(label, 0.0)
