"""What the words of Sweet Home 3D homes mean here: models, rooms, named colours."""

from __future__ import annotations

import re

import numpy as np

from lab.simulation.home import Material

OTHER = "other"
"""The label of a shape that is nothing in particular: a beam, a pipe, a partition. Never an instance."""

_MODELS: dict[str, str] = {
    "air conditioner": "airConditioner",
    "aquarium": "aquarium",
    "armchair": "armchair armchair2",
    "bathtub": "bath fittedBath",
    "bed": "bed bed90x190 bed140x190 bunkBed90x190 cornerBunkBed90x190 loftBed140x190",
    "blinds": "blind",
    "bookshelf": "bookcase filledBookcase",
    "ceiling lamp": "pendantLamp spotlight",
    "chair": "chair chair2",
    "chest of drawers": "chest dresser",
    "coffee table": "coffeeTable",
    "crib": "crib",
    "cupboard": "kitchenUpperCabinet glassDoorCabinet",
    "curtain": "curtains",
    "desk": "desk",
    "desk lamp": "workLamp",
    "dishwasher": "dishwasher",
    "fireplace": "fireplace",
    "floor lamp": "floorUplight",
    "kitchen cabinet": "kitchenCabinet",
    "lamp": "lamp",
    "laptop": "laptop",
    "nightstand": "bedsideTable",
    "oven": "oven",
    "piano": "piano",
    "picture frame": "frame",
    "plant": "plant flowers",
    "radiator": "electricRadiator hotWaterRadiator",
    "range hood": "hood",
    "refrigerator": "fridge fridgeFreezer",
    "shower": "shower",
    "sink": "sink",
    "sofa": "sofa sofa2 cornerSofa",
    "stairs": "staircase curveStaircase spiralStaircase",
    "stool": "stool",
    "stove": "cooker",
    "table": "table squareTable roundTable",
    "toilet": "toiletUnit",
    "tv": "flatTV",
    "tv stand": "tvUnit",
    "wall lamp": "wallUplight",
    "wardrobe": "wardrobe slidingDoors",
    "washbasin": "washbasin washbasinWithCabinet",
    "washing machine": "clothesWasher",
}
_LABEL_OF_MODEL = {model: label for label, models in _MODELS.items() for model in models.split()}

_LABEL_OF_NAME: dict[str, str] = {
    "bank": "bench",
    "bedside table": "nightstand",
    "cabinet": "cupboard",
    "carpet": "rug",
    "coffee table": "coffee table",
    "fireplace": "fireplace",
    "garage door": "door",
    "hood": "range hood",
    "kitchen cabinet": "kitchen cabinet",
    "mirror": "mirror",
    "shelf": "shelf",
    "table": "table",
    "tv table": "tv stand",
}
"""What a piece is called speaks before what it is modelled by: a box may be a carpet."""

_GROUPS = {"fireplace": "fireplace", "bed": "bed", "staircase": "stairs", "railing": OTHER, "roof": OTHER}
_GROUPS["main roof"] = OTHER

_ROOMS: tuple[tuple[str, str], ...] = (
    (r"bed(ro+m|rom)|chambre|schlafzimmer|dormitorio|slaapkamer|camera da letto", "bedroom"),
    (r"bath|salle de bain|badezimmer|bad$|baño|badkamer|bagno|shower room|toilet|\bwc\b", "bathroom"),
    (r"kitchen|cuisine|küche|cocina|keuken|cucina", "kitchen"),
    (r"dining|salle à manger|esszimmer|comedor|eetkamer|sala da pranzo", "dining area"),
    (r"living|salon|séjour|wohnzimmer|sala de estar|woonkamer|soggiorno|lounge", "living room"),
    (r"office|study|bureau|büro|arbeitszimmer|oficina|despacho|ufficio|kantoor", "office"),
    (r"laundry|buanderie|waschküche|lavadero|lavanderia", "laundry"),
    (
        r"^hall|entrance|entryway|entrée|vestibule|diele|recibidor|ingresso|corridor|hallway|couloir|flur",
        "entryway",
    ),
    (r"garage|garaje", "garage"),
    (r"balcon|terrace|terrasse|terraza|terrazza|patio|loggia|veranda", "balcony"),
    (r"attic|cellar|storage|dressing|closet|pantry|grenier|cave|dachboden|keller|ático|soffitta", "storage"),
    (r"playroom|salle de jeux|spielzimmer", "playroom"),
    (r"gym|fitness", "gym"),
)

_NAMED: dict[str, tuple[float, float, float]] = {
    "amber": (0.58, 0.27, 0.0),
    "archwhite": (0.90, 0.89, 0.85),
    "archwhite2": (0.90, 0.89, 0.85),
    "black": (0.0, 0.0, 0.0),
    "bluegrey": (0.33, 0.38, 0.45),
    "bluteal": (0.08, 0.26, 0.20),
    "bone": (0.90, 0.76, 0.43),
    "bone2": (0.90, 0.80, 0.55),
    "brown": (0.09, 0.02, 0.0),
    "brzskin": (0.38, 0.29, 0.21),
    "dkblue": (0.05, 0.06, 0.25),
    "dkdkgrey": (0.02, 0.02, 0.02),
    "dkgrey": (0.05, 0.05, 0.05),
    "dkred": (0.23, 0.0, 0.0),
    "flblack": (0.0, 0.0, 0.0),
    "flblonde": (0.57, 0.33, 0.04),
    "flbrown": (0.30, 0.16, 0.08),
    "fldkdkgrey": (0.02, 0.02, 0.02),
    "fldkgrey": (0.05, 0.05, 0.05),
    "flesh": (0.53, 0.41, 0.34),
    "flgrey": (0.50, 0.50, 0.50),
    "flltbrown": (0.42, 0.25, 0.14),
    "flltgrey": (0.62, 0.62, 0.62),
    "florange": (1.0, 0.17, 0.0),
    "fltan": (0.66, 0.46, 0.13),
    "flwhite": (0.95, 0.95, 0.95),
    "flwhite1": (0.95, 0.95, 0.95),
    "flyellow": (1.0, 0.67, 0.0),
    "grey": (0.36, 0.36, 0.36),
    "iris": (0.25, 0.30, 0.60),
    "jetflame": (0.80, 0.45, 0.10),
    "lavendar": (0.22, 0.09, 0.35),
    "lighttan": (0.78, 0.66, 0.46),
    "lighttan2": (0.78, 0.66, 0.46),
    "lighttannew": (0.78, 0.66, 0.46),
    "ltgrey": (0.62, 0.62, 0.62),
    "offwhite.warm": (0.92, 0.89, 0.82),
    "red": (0.77, 0.0, 0.0),
    "redwood": (0.26, 0.03, 0.0),
    "ruby": (0.80, 0.0, 0.0),
    "sand_stone": (0.74, 0.62, 0.46),
    "silver": (0.62, 0.62, 0.62),
    "sky_blue": (0.56, 0.72, 0.86),
    "tan": (0.66, 0.52, 0.22),
    "teeth": (0.98, 0.80, 0.47),
    "white": (1.0, 1.0, 1.0),
    "white.001": (1.0, 1.0, 1.0),
    "yellow": (1.0, 0.67, 0.0),
    "yellow_green": (0.19, 0.41, 0.0),
    "yellowbrt": (1.0, 0.85, 0.0),
}

NAMED_MATERIALS: dict[str, Material] = {
    name: Material(np.array([round(255 * part) for part in color], np.uint8))
    for name, color in _NAMED.items()
}
"""Materials that models without an MTL file name, in colours close to those that Sweet Home 3D shows."""


def label_of_piece(model: str, name: str) -> str:
    """The label of a piece by the model's file name and its own name; `OTHER` for a shape of no kind."""
    return _LABEL_OF_NAME.get(name.strip().lower()) or _LABEL_OF_MODEL.get(model, OTHER)


def label_of_group(name: str) -> str | None:
    """The label of a group that is one thing; None where its parts are things of their own."""
    return _GROUPS.get(name.strip().lower())


def function_of_room(name: str) -> str:
    """The function that a room's name says, in one of several languages; "unknown" where it says none."""
    word = name.strip().lower()
    return next((function for pattern, function in _ROOMS if re.search(pattern, word)), "unknown")
