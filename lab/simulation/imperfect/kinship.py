"""Which indoor words are near synonyms, which name things of one kind, and what parts of things are called.

The table was written for this project. Words of one set between semicolons are taken for one another (a mug and
a cup); words of one line are of a kind (mugs and plates); every word stands once.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

_TABLE = """
seats: sofa, couch, sofa bed, loveseat; armchair, chair, dining chair, office chair, recliner, desk chair;
  stool, bar stool, step stool; bench, weight bench; ottoman, footstool, pouf; rocking chair; high chair; bean
  bag
beds and bedding: bed, bunk bed, mattress; cushion, pillow; blanket, quilt, comforter, bedspread, duvet; crib;
  headboard
fabrics: towel, bath towel, hand towel, dishtowel, cloth; rug, carpet, mat, bath mat, doormat; curtain, drape,
  shower curtain, blinds; tablecloth; towel rack, towel rail; coat rack, coat hanger
tables: table, dining table, coffee table, side table, kitchen table, desk, console table; nightstand, bedside
  table; counter, countertop, kitchen counter, kitchen island; plant stand; tv stand, sideboard, media console
storage: cabinet, cupboard, kitchen cabinet, wall cabinet, file cabinet, filing cabinet; dresser, drawer, chest
  of drawer; wardrobe, closet, armoire; shelf, wall shelf, shelf board; bookcase, bookshelf; shoe rack; rack,
  spice rack, utensil rack, dish rack; box, storage box, carton, crate; basket, hamper, laundry basket, clothes
  hamper; bin, trash can, waste bin, garbage; bucket, vat
cups and dishes: mug, cup, teacup, coffee mug; glass, wineglass, wine glass; bowl, fruit bowl, soup bowl; plate,
  dish, saucer, platter; tray; pitcher, water jug; teapot, coffeepot; coaster, place mat; napkin, paper towel
vessels: bottle, wine bottle, water bottle, beer bottle; jar, spice jar, canister; can; vase, urn; candle,
  candle holder; pot, flowerpot, plant pot; indoor plant, potted plant, plant, house plant; flower arrangement,
  bouquet
kitchen tools: spoon, wooden spoon, soupspoon, ladle; fork; knife, steak knife; knife holder, knife block, knife
  stand; spatula, slotted turner, slotted spatula; whisk, eggbeater; tongs; chopping board, cutting board; can
  opener; corkscrew; strainer, colander; grater; saltshaker, salt shaker, pepper mill; kitchen utensil, cooking
  utensil; scissors
cooking: oven, toaster oven; stove, gas stove, cooktop, hotplate; microwave oven, microwave; refrigerator,
  fridge, freezer; dishwasher; toaster; blender, food processor, mixer; kettle, teakettle; coffee maker, coffee
  machine, coffee press; pan, frying pan, saucepan, wok; crock pot, casserole; range hood, fume hood, cooker
  hood
washing: sink, kitchen sink, washbasin; faucet, water faucet, tap; bathtub, bath; shower, shower head; toilet;
  toilet tissue, toilet paper, tissue paper, tissue box; soap, soap dispenser; toothbrush; toothpaste; shampoo;
  mirror; hair dryer; hairbrush, comb; sponge, scrubbing brush; washing machine, automatic washer, clothes
  dryer, dryer; vacuum cleaner; broom, mop; dustpan; ironing board; iron; detergent; drying rack; toilet brush;
  scale; water heater
screens and machines: television, tv, tv screen, television set; monitor, computer monitor, screen; laptop,
  laptop computer; computer keyboard, keyboard; mouse, computer mouse; tablet, tablet computer, ipod; telephone,
  phone, cellular telephone, cell phone; intercom; remote, remote control, tv remote, control; speaker, stereo,
  subwoofer; radio, radio receiver; printer; projector; camera, security camera, webcam; router; game console;
  joystick, game controller; headphones, headset, earphone; record player; microphone; computer tower, computer
lights and air: lamp, table lamp, desk lamp, floor lamp, lampshade; chandelier, ceiling lamp; wall lamp, sconce;
  lightbulb; lantern; fan, ceiling fan; heater, radiator; air conditioner; vent, air vent; fireplace; thermostat
on the wall: picture, painting, poster, picture frame, photo frame; panel, bulletin board, corkboard; clock,
  wall clock, alarm clock; switch, light switch; wall plug, wall socket, socket, outlet; smoke detector, fire
  alarm; mirror frame; calendar; tapestry; blackboard, whiteboard; fire extinguisher; hook
paper and office: book, hardback book, paperback book, notebook; magazine, newspaper, booklet; envelope, packet;
  pen, pencil, marker; stapler; binder, clipboard; desk organizer, pencil box, pen holder; calculator; map;
  globe; tape measure
ornaments: sculpture, statue, figurine; award, trophy cup; wreath; hourglass; teddy bear, doll, toy, toy car;
  aquarium; ball, exercise ball, beachball, soccer ball; basketball, football
sport and music: barbell, dumbbell, weight; treadmill, exercise bike; bicycle; tennis racket; yoga mat; piano;
  guitar; violin; drum
tools: hammer; drill; toolbox; ladder; screwdriver; wrench
clothes and bags: backpack, handbag, shoulder bag, bag; suitcase, briefcase; shoe, boot, slipper, sandal; hat,
  cap; coat, jacket; shirt, sweater, clothes; umbrella; glove; scarf; belt; sock; wallet
structure: wall, partition wall; floor; ceiling; ceiling beam, beam, pillar, column; door, sliding door, folding
  door; window; stairs; handle, door handle, doorknob, knob; pipe; window sill
food: apple; orange; banana; lemon; pear; bread; tomato; cake; egg; cheese; pizza; sandwich
"""

_ALSO_TAKEN_FOR = {
    "sofa": ("cushion", "bench"),
    "cushion": ("sofa",),
    "pillow": ("blanket",),
    "bed": ("sofa",),
    "picture": ("window", "tv screen"),
    "television": ("picture", "monitor"),
    "tv": ("picture", "monitor"),
    "mirror": ("window", "picture"),
    "tv stand": ("cabinet", "table"),
    "nightstand": ("cabinet", "table"),
    "vase": ("bottle", "pot"),
    "bowl": ("plate", "cup"),
    "mug": ("bowl",),
    "bottle": ("vase", "jar"),
    "jar": ("bottle", "mug"),
    "stove": ("oven",),
    "wall shelf": ("cabinet",),
    "switch": ("wall plug",),
    "wall plug": ("switch",),
    "remote": ("phone",),
    "tablet": ("book", "laptop"),
    "towel": ("blanket", "curtain"),
    "dishwasher": ("oven",),
    "monitor": ("television",),
    "book": ("magazine", "box"),
}
"""Words of other sets that a detector falls for; the first is the likeliest."""

_PARTS = {
    "sofa": ("cushion", "sofa"),
    "couch": ("cushion", "couch"),
    "armchair": ("cushion", "armchair"),
    "bed": ("mattress", "bed", "blanket"),
    "cabinet": ("drawer", "cabinet"),
    "kitchen cabinet": ("drawer", "counter", "cabinet"),
    "wardrobe": ("door", "wardrobe"),
    "dresser": ("drawer", "dresser"),
    "tv stand": ("drawer", "tv stand"),
    "bookcase": ("shelf", "book", "bookcase"),
    "bookshelf": ("shelf", "book", "bookshelf"),
    "refrigerator": ("door", "refrigerator"),
    "desk": ("table", "drawer"),
    "counter": ("cabinet", "counter"),
}


@dataclass(frozen=True, slots=True)
class Kin:
    """Where a word stands: its kind, and its set of near synonyms, the word itself among them."""

    kind: str
    synonyms: tuple[str, ...]


def kin_of(label: str) -> Kin | None:
    """The kin of a normalised word; None where the table does not have it."""
    return _kin().get(label)


def kin_words() -> tuple[str, ...]:
    """Every word of the table, sorted."""
    return tuple(sorted(_kin()))


def near_synonyms(label: str) -> tuple[str, ...]:
    """Other words for the same thing, in the table's order; none for an unknown word."""
    kin = kin_of(label)
    return tuple(word for word in kin.synonyms if word != label) if kin else ()


def lookalikes(label: str) -> tuple[str, ...]:
    """Words of other sets that a detector falls for, the likeliest first, then the heads of its kind's other sets."""
    kin = kin_of(label)
    heads = () if kin is None else _heads()[kin.kind]
    likely = _ALSO_TAKEN_FOR.get(label, ())
    avoid = {label, *likely, *(kin.synonyms if kin else ())}
    return (*likely, *(word for word in heads if word not in avoid))


def part_words(label: str) -> tuple[str, ...]:
    """What a detector calls a piece of a thing; its own name where no part has one."""
    return _PARTS.get(label, (label,))


@cache
def _kin() -> dict[str, Kin]:
    kin: dict[str, Kin] = {}
    for kind, sets in _sets().items():
        for synonyms in sets:
            kin.update({word: Kin(kind, synonyms) for word in synonyms})
    return kin


@cache
def _heads() -> dict[str, tuple[str, ...]]:
    """The first word of every set, by kind."""
    return {kind: tuple(synonyms[0] for synonyms in sets) for kind, sets in _sets().items()}


@cache
def _sets() -> dict[str, tuple[tuple[str, ...], ...]]:
    lines = _TABLE.strip().replace("\n  ", " ").splitlines()
    parted = (line.partition(":") for line in lines)
    return {
        kind: tuple(tuple(word.strip() for word in words.split(",")) for words in sets.split(";"))
        for kind, _, sets in parted
    }
