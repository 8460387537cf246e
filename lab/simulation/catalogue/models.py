"""Which models of the Sweet Home 3D furniture libraries stand for which label: looked at one by one.

Left out are vehicles, animals, people, gardens, and whatever shows two things in one or none clearly.
"""

from __future__ import annotations

from dataclasses import dataclass

_LIBRARIES = {
    "C0": "BlendSwap-CC-0",
    "BY": "BlendSwap-CC-BY",
    "KL": "KatorLegaz",
    "SC": "Scopia",
}

_MODELS: dict[str, str] = {
    "air conditioner": "SC/internal-unity-air-conditioning",
    "aquarium": "SC/aquarium",
    "armchair": """C0/armchair2 C0/modernArmchair C0/winchesterArmchair BY/armchair1 BY/fotel BY/armChair2
        KL/mid-century-chair SC/armchair3 SC/armchair SC/armchair1 SC/armchair2 SC/modern_armchair""",
    "backpack": "BY/backpack",
    "bag": "C0/handbag C0/briefcase",
    "ball": "C0/basketball BY/ballonFoot",
    "basket": "SC/shopping-basket",
    "bath mat": "KL/bathmat",
    "bathtub": "BY/bath_jay_hardy SC/islandBath",
    "bed": """C0/bed1 C0/bed2 C0/bedWithTexture C0/bed3 BY/juniorBed BY/lettoCloud SC/bed1 SC/iron_bed
        SC/children_bed SC/captains-bed""",
    "bench": "C0/bench C0/pianoBench KL/bench",
    "bicycle": "BY/bike SC/bicycle",
    "bin": "C0/dustbin KL/bullet-trash-can",
    "blender": "BY/kitchenblender",
    "blinds": "KL/window-blinds",
    "book": "BY/book",
    "bookshelf": "KL/full-bookcase",
    "bottle": """C0/yogurtBottle C0/tetrapak BY/beer_bottle KL/red-wine-bottle-01 KL/spray-bottle SC/wine_bottle
        SC/com_bath SC/com_bath2_jabon_pijo SC/medicoscopia_bottle2""",
    "bowl": "SC/bowl SC/bowlWithSalad",
    "box": "SC/cardboard-box C0/ammoBox BY/gift KL/trunk-large",
    "bread": "C0/bread",
    "broom": "SC/broom",
    "cake": "SC/birthday_cake",
    "camera": "SC/basic_camera SC/reflex_camera",
    "candle": "SC/candle",
    "ceiling lamp": "BY/hangingLight KL/hanging-restaurant-light C0/lamp2",
    "cell phone": "C0/iphone BY/mobile",
    "chair": """C0/oakChair C0/plasticChair C0/sillaBlanca C0/antiqueChair C0/chairWithCushion C0/chair2
        C0/osakaChair C0/thonet C0/chair BY/cafe_set_mota_chair BY/cafe_set_tonon_chair BY/chairWithCushion
        BY/ella_chair_f BY/foldingChair BY/plaidChair BY/kitchenChair BY/chair3 BY/chair4 KL/dining-chair SC/chair3
        SC/chair4 SC/chair SC/tubular_chair SC/plastic_chair SC/white_kitchen_chair""",
    "chest of drawers": "BY/chest BY/dresserWithDrawers",
    "clock": "C0/cuckooClock",
    "clothes": "SC/folded_clothes",
    "coat rack": "SC/wall-hanger",
    "coffee maker": "KL/coffee-maker C0/coffeeBrewer SC/coffee_machine",
    "coffee table": """BY/coffeeTable SC/saloon_table SC/table_wood_and_iron SC/coffee-table2
        SC/rattanTable""",
    "crate": "C0/crate",
    "crib": "SC/crib C0/babyRockingBed",
    "cup": "C0/caffe_final SC/cup BY/coffee_cup",
    "cupboard": "C0/upperCabinet C0/smallUpperCabinet BY/kitchenUpperCabinet BY/kitchenSmallUpperCabinet",
    "curtain": "SC/curtain",
    "cutting board": "BY/choppingBoard",
    "desk": """BY/biurko3 BY/simpleDesk BY/officeTable SC/kids_desk_table SC/kids_wooden_desk C0/lbDesk
        SC/wooden_office_alder_table""",
    "desk lamp": "C0/desklamp SC/desk_lamp1 SC/desk_lamp2",
    "dining table": """C0/table KL/glass-dining-table SC/black_table SC/metal_glass_table SC/wooden_table_office
        SC/table-with-leaning-feet""",
    "doll": "SC/doll",
    "doormat": "SC/doormat",
    "drill": "SC/perceuse-electrique",
    "dryer": "SC/dryer_machine",
    "drying rack": "SC/clothes-horse",
    "exercise bike": "SC/indoor-bike",
    "fan": "C0/tableFan",
    "filing cabinet": "KL/filing-cabinet",
    "fire extinguisher": "C0/fireExtinguisher",
    "fireplace": "SC/fireplace1",
    "floor lamp": "SC/living_lamp",
    "fork": "BY/fork",
    "fruit bowl": "SC/bowlWithFruits SC/apples",
    "game console": "SC/playstation4",
    "game controller": "SC/ps4-joystick",
    "glass": "KL/12-oz-glass KL/highball-glass",
    "guitar": "C0/electricGuitar",
    "hammer": "SC/marteau",
    "hat": "SC/chapeau SC/casquette",
    "headphones": "C0/headphones",
    "intercom": "SC/intercom_with_screen SC/intercom",
    "jar": "SC/pottery SC/sugar",
    "kettle": "BY/boiler",
    "kitchen cabinet": """C0/lowerCabinet C0/drawersCabinet BY/kitchenLowerCabinet BY/kitchenSmallLowerCabinet
        BY/kitchenDrawersCabinet""",
    "kitchen island": "BY/kitchenIsland",
    "knife": "BY/kitchenKnife BY/knife",
    "knife block": "SC/kitchenKnifeStandSet",
    "ladder": "SC/step-ladder-metal SC/step-ladder-wood",
    "lamp": """BY/lamp KL/pedestal-vase-lamp SC/little_lamp1 SC/little_lamp2 SC/livingroom_lamp1
        SC/table_lamp""",
    "laptop": "BY/laptop KL/apple-ibook-2001",
    "laundry basket": "SC/clothes-basket",
    "microwave": "BY/microwave",
    "mixer": "C0/kitchenaid",
    "mug": "KL/coffee-mug",
    "newspaper": "KL/newspaper",
    "nightstand": "C0/bedsideTable2 BY/bedsideTable",
    "office chair": "KL/office-chair SC/office_chair SC/kids_desk_chair",
    "oven": "C0/oven",
    "paper towel": "SC/paperTowelHolder",
    "pen holder": "SC/penbox",
    "piano": "BY/piano C0/pianoAQueue",
    "picture frame": "SC/frame1 SC/frame2",
    "plant": """C0/littlePlant C0/augalas C0/cactus C0/decorativePlant C0/orchids C0/plant BY/luckyBamboo
        BY/mediumIndoorPlant BY/decorativePlant BY/spider_plant BY/succulentPlant BY/yuccaPlant SC/maceta
        SC/bonsai-tree SC/ficus""",
    "plate": "KL/bread-plate KL/dinner-plate",
    "pot": "BY/largePan",
    "printer": "SC/inkjet_and_scanner_printer",
    "radiator": "C0/radiator1 C0/radiator3 BY/modernRadiator",
    "radio": "BY/radio",
    "range hood": "BY/hood C0/rangeHood",
    "refrigerator": "C0/refrigerator C0/largeFridge KL/fridge",
    "remote control": "SC/tv-remote-control",
    "rug": "SC/round-carpet",
    "salt shaker": "BY/saltShaker",
    "scale": "SC/electronicScale",
    "scissors": "C0/cissors_swap",
    "sculpture": "C0/deer",
    "security camera": "BY/surveillanceCamera",
    "shelf": "C0/shelves C0/verticalShelves KL/utility-shelving SC/kids_shelves",
    "shoe": "SC/sneakers SC/woman_shoes SC/mocassin",
    "shower": "C0/showerStall",
    "sink": "C0/sinkCabinet BY/kitchenSink",
    "slipper": "C0/slippers",
    "smoke detector": "SC/smoke-detector",
    "soap dispenser": "SC/com_bath2_soap",
    "sofa": """C0/couch C0/sofa2 C0/winchesterSofa BY/sofa2 BY/sofa3 BY/couch3 KL/futon-couch KL/mid-century-sofa
        SC/clear_sofa SC/simple_sofa SC/beige_sofa_2seats SC/beige_sofa SC/burlap_sofa SC/leather_sofa
        SC/sofa_white_beige""",
    "speaker": "C0/speaker2 C0/speaker3",
    "spice rack": "SC/spiceTower",
    "sponge": "SC/com_bath2_esponja",
    "spoon": "BY/spoon",
    "stapler": "KL/stapler",
    "stool": "C0/stool2 BY/green_stool SC/kitchen_stool SC/bar_chair KL/bar-stool",
    "stove": "BY/largeStove",
    "suitcase": "BY/suitcase",
    "switch": """SC/rounded-switch SC/square-switch SC/switch-whites SC/rounded-double-switch
        SC/square-double-switch SC/double-switch-whites SC/rounded-dimmer""",
    "table": """C0/oakTable BY/cafe_set_mota_table BY/cafe_set_tonon_table BY/table SC/table4
        SC/white_kitchen_table SC/round-table""",
    "tablet": "SC/tablet",
    "teapot": "SC/teapot",
    "teddy bear": "C0/teddyBear",
    "telephone": "SC/phone BY/wirelessOfficePhone3",
    "toaster": "SC/toaster",
    "toilet": "C0/toiletsUnit BY/toilets_unit_jay_hardy BY/modernToilet",
    "toilet brush": "C0/toiletBrush",
    "toilet paper": "KL/bathroom-tissue C0/toiletPaperDispenser",
    "towel": "C0/towel2 SC/com_bath3_toalla",
    "towel rack": "KL/towel-rack",
    "toy car": "BY/carrito-de-madera",
    "tray": "SC/tray",
    "treadmill": "BY/treadmill",
    "tv": "C0/led_tv SC/wall-flat-tv",
    "tv stand": "BY/tvStand",
    "umbrella": "C0/umbrellaFolded",
    "vase": "SC/vase1 SC/vase2 SC/vase3 SC/jar SC/old_jar",
    "wall plug": """SC/rounded-plug-TypeE SC/square-plug-TypeE SC/plug-TypeE-whites SC/rounded-plug-TypeCFlat
        SC/square-plug-TypeCFlat SC/plug-TypeG-whites SC/rounded-plug-TypeB""",
    "wall lamp": "KL/porch-light",
    "wardrobe": "C0/wardrobeWithSlidingDoors BY/wardrobe BY/wardrobe2 SC/wardrobe1",
    "washbasin": "C0/washbasin BY/washbasin_jay_hardy",
    "washing machine": "SC/clothes_washing_machine",
    "water heater": "SC/electric_water_heater SC/gaz_water_heater",
    "wine glass": "BY/glass BY/cocktailGlass",
}

FEW = frozenset(
    {"rug", "book", "picture frame", "towel", "clock", "mug", "tv", "curtain", "floor lamp", "box", "bag"}
)
"""Labels whose few models are all of one kind: composed shapes stand beside them."""

_SCALES = {
    "SC/bowl": 0.5,
    "KL/dinner-plate": 1.1,
    "C0/caffe_final": 1.4,
    "SC/shopping-basket": 0.6,
    "BY/suitcase": 0.7,
    "C0/ammoBox": 0.4,
    "KL/trunk-large": 0.6,
    "SC/vase1": 0.8,
    "SC/old_jar": 0.9,
    "SC/com_bath3_toalla": 1.9,
    "SC/frame1": 1.5,
    "SC/frame2": 1.2,
    "SC/cardboard-box": 0.8,
}
"""Made larger or smaller where a model is not of the size that its label has at home."""

_TURNS: dict[str, float] = {}
"""Degrees counter-clockwise about z for a model whose front does not face the front."""

_TOPS: dict[str, float] = {"BY/largeStove": 0.81, "KL/futon-couch": 0.30}
"""Height in metres of what carries things, where the library's own is none or wrong; 0 = it carries nothing."""

_STANDING = frozenset({"SC/frame1", "SC/frame2", "SC/com_bath3_toalla", "C0/radiator3"})
"""Models that stand or lie on something though their like mostly hang."""

_ONE_LOOK = frozenset(
    {
        "SC/armchair2",
        "C0/bedWithTexture",
        "SC/iron_bed",
        "SC/children_bed",
        "SC/captains-bed",
        "C0/iphone",
        "BY/book",
        "SC/doll",
        "KL/full-bookcase",
        "SC/frame1",
        "SC/kitchen_stool",
        "SC/toaster",
        "C0/upperCabinet",
        "C0/smallUpperCabinet",
        "C0/wardrobeWithSlidingDoors",
        "SC/beige_sofa",
        "SC/beige_sofa_2seats",
        "SC/sofa_white_beige",
        "BY/officeTable",
        "C0/lowerCabinet",
        "C0/drawersCabinet",
        "C0/refrigerator",
    }
)
"""Models that do not look like a thing of another colour when their widest materials are painted."""


@dataclass(frozen=True, slots=True)
class Mapped:
    """What a model stands for.

    scale: of its catalogue size. turn: degrees about z. top: metres, None = its own. stands: though its like hang.
    one_look: takes no attribute.
    """

    label: str
    scale: float
    turn: float
    top: float | None
    stands: bool
    one_look: bool


def _full(key: str) -> str:
    library, _, model = key.partition("/")
    return f"{_LIBRARIES[library]}/{model}"


LABEL_OF: dict[str, Mapped] = {
    _full(key): Mapped(
        label=label,
        scale=_SCALES.get(key, 1.0),
        turn=_TURNS.get(key, 0.0),
        top=_TOPS.get(key),
        stands=key in _STANDING,
        one_look=key in _ONE_LOOK,
    )
    for label, keys in _MODELS.items()
    for key in keys.split()
}
"""Library and model ("Scopia/toaster") to what it stands for."""
