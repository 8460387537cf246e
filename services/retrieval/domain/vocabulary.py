"""Household words: which mean the same thing, and which rooms each is found in (SPEC 6: the bundled, sourced
table).

The first column of rooms after a word is read off ProcTHOR's placement annotations (Deitke et al., NeurIPS
2022; allenai/procthor, Apache-2.0; 2 = often, 1 = sometimes, only its four room types: kitchen, living room,
bedroom, bathroom). The second column, after `+`, is our own: rooms that ProcTHOR does not have, words that it
does not have, and the things that it sets in groups (sink, television) and therefore scores 0.
"""

from __future__ import annotations

_ROOM_CODES = {
    "K": "kitchen",
    "L": "living room",
    "B": "bedroom",
    "T": "bathroom",
    "D": "dining room",
    "O": "office",
    "H": "hallway",
    "W": "laundry room",
    "G": "garage",
    "Y": "gym",
    "C": "balcony",
}

_TABLE = """
air conditioner + L2 B2 O1 | alarm clock: B2 | aluminum foil: K1 | apple: K2 + D1 | armchair: L2 B1 + O1
backpack + B2 H2 O1 | banana + K2 D1 | barbell + Y2 | baseball bat: B2 + G1 | baseball glove + B1 G1
basket + L1 B1 W2 T1 | basketball: B1 + G2 Y1 | bathtub + T2 | bed: B2 | bench + H2 C2 Y1 D1
bicycle + G2 H1 C1 | blanket + B2 L2 | blender + K2 | blinds: K1 L1 B2 + O2 | book: K1 L1 B2 + O2
bookshelf + L2 O2 B1 | boot: L1 B1 + H2 | bottle: K1 + D2 L1 O1 | bowl: K2 L1 B2 + D2 | box: L2 B2 + G2 O1
bread: K2 + D1 | broom + K1 W2 G1 | cabinet + K2 L1 T1 O1 | cable + O2 L1 | cake + K2 D2
camera + L1 O1 B1 | candle: L1 T2 + D2 | carpet + L2 B2 H1 | cart: L1 + K1 G1 | cd: B2 + L1
ceiling fan + L2 B2 | cell phone: K1 L1 B2 + O1 | chair: K2 L2 B2 + D2 O2 | chandelier + D2 L1
charger + O2 B2 L1 | cloth: B1 T2 + K1 | clothes dryer: T1 + W2 | clock + K1 L2 B1 O1 | coat + H2 B1
coffee + K2 | coffee machine: K2 + O1 | coffee table: L1 B1 | computer + O2 B1 | copier + O2
couch: L2 B1 + O1 | countertop: K2 + T1 | credit card: K1 L2 B2 | cup: K2 + D2 L1 O1 | curtain + L2 B2
cutting board + K2 | desk: L1 B2 + O2 | desk lamp: L2 B2 + O2 | dining table: K1 L1 + D2 | dish rack + K2
dish sponge: K2 T1 | dishwasher + K2 | dog bed: L1 B1 | doll + B2 L1 | door + H2 | drawer + K1 B2 O1
dresser: L2 B2 T1 | dumbbell: B1 + Y2 | egg: K2 | exercise ball + Y2 | fan + L1 B2 O1 | faucet: K2 T2
file cabinet + O2 | fire extinguisher + K1 H2 O1 | fireplace + L2 | floor lamp: L2 + B1
flower + L2 D2 C1 | footstool: B1 T1 + L1 | fork: K2 + D2 | garbage bag: K1 + W1 | glass + K2 D2
game controller + L2 B1 | glasses + B2 L1 O1 | guitar + L1 B2 | hair drier + T2 B1 | hairbrush + T2 B2
hammer + G2 | hand towel: T2 + K1 | handbag + H2 B2 | hanger + B2 W1 H1 | hat + H2 B2
headphones + O2 B2 L1 | hot dog + K1 | heater + L1 B1 T1 | houseplant: K1 L1 B1 T1 + O1 C2 D1
instant noodle + K2 O1 | iron + W2 B1 | ironing board + W2 B1 | jar + K2 | jacket + H2 B1 | juice + K2 D1
kettle: K2 + O1 | key: L2 B2 + H2 | keyboard + O2 B1 | knife: K2 + D2 | knife holder + K2 | ladder + G2
ladle: K2 | lamp + L2 B2 O1 | laptop: L2 B2 + O2 | laundry hamper: B1 T1 + W2 | lettuce: K2
light switch: K2 L2 B2 T2 + H2 | magazine + L2 O1 T1 | mattress + B2 | medicine + T2 B1 K1
microwave: K2 + O1 | milk + K2 | mirror + T2 B2 H2 | mop + W2 K1 T1 | mouse + O2 B1 | newspaper: L2 + D1
nightstand + B2 | orange + K2 D1 | ottoman: L1 | oven + K2 | painting + L2 B1 D1 H1 | pan: K2 | paper + O2
paper towel: K1 T1 | pen: K1 L1 B2 + O2 | pencil: K1 L1 B2 + O2 | pepper shaker: K2 + D2 | piano + L2
picture + L2 B2 H2 D1 | pillow: L2 B2 | pizza + K2 D1 | plate: K2 L1 + D2 | plunger: T2 | pot: K2
potato: K2 | printer + O2 | projector + O2 L1 | radiator + L1 B1 T1 | range hood + K2 | razor + T2
refrigerator: K2 + O1 | remote: L2 B1 | router + L1 O2 H1 | rug + L2 B2 H1 | safe: K1 L1 B1
salt shaker: K2 + D2 | sandwich + K2 D1 | scale + T2 K1 | scissors + O2 K2 | screwdriver + G2
scrub brush: T2 + W1 | shampoo + T2 | shelf + L2 O2 K1 B1 T1 | shelving unit: K2 L2 B1 + O1 G1
shirt + B2 W2 | shoe + H2 B2 | shoe rack + H2 | shower + T2 | shower curtain: T2 | side table: K1 L2 B2 T1
sink + K2 T2 W1 | skateboard + G2 B1 | slipper + B2 H1 T1 | soap: T2 + K1 | soap bottle: K2 T2
sock + B2 W2 | socket + K1 L1 B1 O1 | spatula: K2 | speaker + L2 O1 B1 | spice jar + K2 | spoon: K2 + D2
spray bottle: K1 T2 + W1 | statue: K1 L2 B1 | stapler + O2 | stool: K2 L1 B1 + D1 | stove + K2
suitcase + B2 H1 G1 | table + D2 K2 L1 O1 | tablet + L2 B2 O1 | tea + K2 | teapot + K2 D2
teddy bear: B1 + L1 | television + L2 B1 | tennis racket: B1 + G1 | tie + B2 | tissue box: L1 B1 T1 + O1
toaster: K2 | toaster oven + K2 | toilet: T2 | toilet paper: T2 | tomato: K2 | toothbrush + T2
toothpaste + T2 | towel: T2 + K1 W1 | toy + B2 L2 | trash can: K2 L2 B2 T2 + O2 | treadmill + Y2
tv stand: L2 + B1 | umbrella + H2 | utensil rack + K2 | vacuum cleaner: B1 + W2 G1 | vase: K2 L2 B1 + D2
violin + L1 B1 | wallet + B2 H1 L1 | wardrobe + B2 H1 | washing machine: T1 + W2 | watch: L2 B1
water + K2 O1 D1 | watering can: L2 + C2 | weight bench + Y2 | whisk + K2 | whiteboard + O2
window + L1 B1 | wine + K1 D2 | wine bottle: K1 + D2 | wine glass + D2 K2 | yoga mat + Y2 L1
"""

_SYNONYMS = (
    ("cup", "mug", "coffee mug", "coffee cup", "teacup", "tea cup"),
    ("couch", "sofa", "settee", "loveseat", "love seat"),
    (
        "television",
        "tv",
        "tv screen",
        "television set",
        "tv set",
        "tvmonitor",
        "monitor",
        "screen",
        "display",
    ),
    ("refrigerator", "fridge", "icebox", "freezer"),
    ("dining table", "kitchen table", "dinner table"),
    ("houseplant", "plant", "potted plant", "pot plant", "indoor plant", "house plant"),
    (
        "cell phone",
        "phone",
        "mobile phone",
        "mobile",
        "smartphone",
        "cellphone",
        "telephone",
        "cellular telephone",
    ),
    ("remote", "remote control", "tv remote", "controller remote"),
    ("hair drier", "hair dryer", "hairdryer", "blow dryer"),
    (
        "trash can",
        "bin",
        "trash bin",
        "garbage can",
        "rubbish bin",
        "wastebasket",
        "waste bin",
        "dustbin",
        "garbage bin",
    ),
    ("stove", "cooker", "gas stove", "hob", "cooktop", "stove top"),
    ("oven", "baking oven"),
    ("toilet", "lavatory", "wc", "loo"),
    ("sink", "washbasin", "basin", "wash basin", "kitchen sink", "sink basin"),
    ("suitcase", "luggage", "travel bag"),
    ("backpack", "rucksack", "knapsack"),
    ("handbag", "purse", "bag", "shoulder bag"),
    ("laptop", "laptop computer", "notebook computer", "portable computer"),
    ("mouse", "computer mouse"),
    ("keyboard", "computer keyboard"),
    ("game controller", "gamepad", "joystick"),
    ("bicycle", "bike"),
    ("wine glass", "wineglass", "goblet"),
    ("rug", "carpet", "area rug"),
    ("wardrobe", "closet", "armoire"),
    ("nightstand", "bedside table", "night stand"),
    ("coffee machine", "coffee maker", "espresso machine", "coffeemaker"),
    ("washing machine", "washer", "clothes washer"),
    ("clothes dryer", "tumble dryer"),
    ("vacuum cleaner", "vacuum", "hoover"),
    ("faucet", "tap"),
    ("picture", "photo", "photograph", "picture frame", "framed picture"),
    ("bookshelf", "bookcase", "book shelf"),
    ("cabinet", "cupboard", "kitchen cabinet"),
    ("kettle", "teakettle", "electric kettle"),
    ("pan", "frying pan", "skillet"),
    ("socket", "power socket", "wall plug", "power outlet", "outlet", "wall socket"),
    ("tissue box", "tissue", "box of tissue", "facial tissue"),
    ("knife holder", "knife block", "knife stand", "knife rack"),
    ("laundry hamper", "laundry basket", "hamper"),
    ("headphones", "headphone", "headset", "earphone"),
    ("teddy bear", "plush bear", "stuffed bear"),
    ("armchair", "easy chair", "arm chair"),
    ("shoe", "sneaker", "trainer"),
    ("donut", "doughnut"),
    ("desk", "writing desk", "office desk", "study table"),
    ("dresser", "chest of drawer", "commode"),
    ("table lamp", "desk lamp", "bedside lamp"),
    ("alarm clock", "bedside clock"),
    ("glasses", "eyeglass", "spectacle"),
    ("copier", "photocopier", "copy machine"),
    ("instant noodle", "ramen", "cup noodle"),
    ("book", "paperback", "hardback"),
)

# Compounds that are no kind of what their last word names.
_NOT_OF_THEIR_HEAD = frozenset({"hot dog", "teddy bear", "gummy bear", "music stand", "rubber duck"})

# Kinds whose names do not end in what they are a kind of.
_KIND_OF = {
    "armchair": "chair",
    "recliner": "chair",
    "desk": "table",
    "flatscreen": "television",
    "teaspoon": "spoon",
    "gas stove": "oven",
    "stove": "oven",
    "futon": "couch",
}


def _read_table(table: str) -> dict[str, dict[str, float]]:
    rows: dict[str, dict[str, float]] = {}
    for row in table.replace("\n", "|").split("|"):
        word, _, codes = row.strip().replace("+", ":" if ":" not in row else " ").partition(":")
        if word:
            rows[word.strip()] = {_ROOM_CODES[code[0]]: float(code[1]) for code in codes.split()}
    return rows


ROOMS_OF = _read_table(_TABLE)
"""word -> {room function: 1 sometimes, 2 often}."""

ROOM_FUNCTIONS = tuple(_ROOM_CODES.values())

_CLASS_OF = {word: words for words in _SYNONYMS for word in words}


def synonyms(word: str) -> tuple[str, ...]:
    """Words for the same thing, the word itself first."""
    return (word, *(other for other in _CLASS_OF.get(word, ()) if other != word))


def same_thing(a: str, b: str) -> bool:
    """Whether two normalised words are equal or synonyms."""
    return a == b or b in _CLASS_OF.get(a, ())


def is_known(word: str) -> bool:
    """Whether the word, or a synonym, is a thing of its own here: then it matches by name and never by
    likeness.
    """
    return word in ROOMS_OF or word in _CLASS_OF


def is_kind_of_head(compound: str) -> bool:
    """Whether a compound is a kind of what its last word names: `wine glass` is, `teddy bear` is not."""
    return compound not in _NOT_OF_THEIR_HEAD


def kind_of(word: str) -> str:
    """What the word names a kind of, where its letters do not show it; else empty."""
    return _KIND_OF.get(word, "")


def rooms_of(word: str) -> dict[str, float]:
    """Where the thing is found, under any of its names: {room function: 1 sometimes, 2 often}; empty where
    unknown.
    """
    return next((ROOMS_OF[name] for name in synonyms(word) if name in ROOMS_OF), {})
