"""What rooms objects belong in: words by function, for homes and offices without a VLM (SPEC 6).

Source: written by hand for this project from common sense, over the indoor class names of COCO and LVIS v1,
words that robots' detectors report, and the labels of the furnished house that tests use. It is no measured
statistic. A word under `typical` speaks for its function by itself, so it holds what hardly ever strays; a word
under `possible` only supports it (a chair or a toy is anywhere).
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class FunctionWords:
    """The words of one function, comma-separated, singular, lower case."""

    typical: str
    possible: str = ""


FUNCTION_WORDS: dict[str, FunctionWords] = {
    "kitchen": FunctionWords(
        typical="""stove, gas stove, oven, microwave, microwave oven, refrigerator, fridge, freezer,
        dishwasher, range hood, kitchen cabinet, kitchen counter, kitchen island, kitchen sink, toaster,
        toaster oven, kettle, teakettle, coffee maker, coffee machine, blender, food processor, mixer,
        cutting board, chopping board, frying pan, pan, saucepan, cooking pot, pot lid, wok, spatula, ladle,
        whisk, colander, strainer, grater, rolling pin, slotted turner, wooden spoon, tongs, spice rack,
        spice jar, dish rack, utensil rack, knife block, dish soap, dishrag, oven mitt, can opener,
        measuring cup, bread bin, salt shaker, pepper mill, waffle iron, pressure cooker, rice cooker, egg
        carton, crock pot""",
        possible="""sink, faucet, cupboard, cabinet, countertop, knife, fork, spoon, bowl, plate, cup, mug,
        bottle, wine glass, glass, jar, can, tray, teapot, apron, sponge, banana, apple, orange, carrot,
        broccoli, tomato, onion, potato, lemon, bread, cheese, egg, sandwich, pizza, food, fruit, vegetable,
        oil bottle, paper towel, trash can, drawer, dish, dishtowel, kitchen table, stool, bar stool""",
    ),
    "dining area": FunctionWords(
        typical="dining table, dining chair, placemat, tablecloth, napkin holder, dining room table",
        possible="""chair, plate, bowl, cup, mug, wine glass, glass, fork, spoon, knife, napkin, table,
        teapot, teacup, saucer, wine bottle, bottle, cake, pizza, sandwich, food, fruit bowl, fruit,
        chandelier, tray, bench, pitcher, vase, candle, candelabrum, gravy boat, soup bowl, sugar bowl, high
        chair, highchair, dish, coaster, pepper, salt, donut, hot dog""",
    ),
    "living room": FunctionWords(
        typical="""sofa, couch, loveseat, settee, coffee table, tv stand, tv cabinet, armchair, recliner,
        fireplace, ottoman, entertainment center, sofa bed, footstool, home theater""",
        possible="""television, tv, tv monitor, television set, remote control, remote, rug, carpet, cushion,
        pillow, side table, floor lamp, lamp, bookshelf, bookcase, speaker, stereo, painting, picture,
        picture frame, vase, potted plant, plant, houseplant, magazine, book, chair, rocking chair, piano,
        guitar, blanket, candle, curtain, game controller, game console, joystick, throw pillow, record
        player, aquarium, clock, wall clock, chandelier, beanbag, dvd player, table, newspaper, ashtray,
        stool""",
    ),
    "bedroom": FunctionWords(
        typical="""bed, double bed, single bed, bunk bed, crib, cradle, nightstand, bedside table, wardrobe,
        mattress, headboard, dresser, bedspread, comforter, duvet, quilt, bed frame, armoire, pajama, alarm
        clock, bedside lamp, vanity table, dressing table, jewelry box, sleeping bag""",
        possible="""pillow, blanket, sheet, lamp, table lamp, closet, mirror, curtain, chest of drawers,
        hanger, clothes, teddy bear, doll, slipper, robe, bathrobe, picture, picture frame, rug, clock,
        book, hair dryer, sock, shirt, dress, hat, drawer""",
    ),
    "bathroom": FunctionWords(
        typical="""toilet, bathtub, shower, shower head, shower curtain, washbasin, bathroom sink, toilet
        paper, toilet tissue, toothbrush, toothpaste, shampoo, bath mat, bath towel, hand towel, towel rack,
        soap dispenser, urinal, bidet, plunger, toilet brush, medicine cabinet, bathroom cabinet, shower
        cap, razor, loofah, toilet seat, toothbrush holder, soap dish, mouthwash, shower door""",
        possible="""sink, faucet, mirror, towel, soap, bathrobe, hair dryer, scale, tissue box, tissue,
        lotion, comb, hairbrush, sponge, trash can, cotton swab, perfume, bottle, floral towel""",
    ),
    "office": FunctionWords(
        typical="""desk, office chair, office desk, computer, computer monitor, desktop computer, printer,
        whiteboard, filing cabinet, file cabinet, stapler, projector, projector screen, scanner,
        photocopier, paper shredder, desk lamp, desk organizer, monitor, swivel chair, calculator,
        conference table, bulletin board, router, hole puncher""",
        possible="""laptop, mouse, computer mouse, keyboard, computer keyboard, book, bookshelf, bookcase,
        chair, pen, pencil, notebook, telephone, phone, tablet, paper, binder, folder, headphones, webcam,
        lamp, cup, mug, trash can, speaker, table, scissors, tape, cell phone, cabinet, clipboard, globe,
        calendar, marker, envelope, briefcase, clock, water cooler""",
    ),
    "laundry": FunctionWords(
        typical="""washing machine, washer, dryer, clothes dryer, ironing board, iron, laundry basket,
        laundry hamper, detergent, clothes hamper, drying rack, clothesline, clothespin, automatic washer""",
        possible="""basket, mop, broom, bucket, vacuum cleaner, hanger, clothes, sink, water heater, dustpan,
        cleaning product, towel""",
    ),
    "entryway": FunctionWords(
        typical="""shoe rack, shoe cabinet, coat rack, coat hook, umbrella stand, doormat, welcome mat, hat
        rack, key holder, hallstand, doorbell, intercom, mailbox, front door, entrance mat""",
        possible="""shoe, boot, umbrella, coat, jacket, handbag, backpack, mirror, bench, hat, suitcase, key,
        door, door handle, security camera, console table, bag, scarf""",
    ),
    "gym": FunctionWords(
        typical="""treadmill, exercise bike, elliptical trainer, weight bench, bench press, barbell,
        dumbbell, kettlebell, exercise ball, yoga mat, exercise mat, punching bag, rowing machine, weight
        plate, jump rope, fitness ball, gym equipment, weight rack, trampoline""",
        possible="sports ball, fan, mirror, towel, water bottle, bench, mat, ball",
    ),
    "playroom": FunctionWords(
        typical="""toy box, dollhouse, playpen, rocking horse, tricycle, pool table, foosball table, ping
        pong table, ball pit, play tent""",
        possible="""toy, toy car, doll, building block, lego, board game, teddy bear, stuffed animal, puzzle,
        ball, beanbag, crayon, easel, sports ball, balloon, kite""",
    ),
    "storage": FunctionWords(
        typical="storage rack, storage shelf, pallet, shelving unit",
        possible="""storage box, cardboard box, box, crate, basket, shelf, suitcase, container, bin, bag,
        tool, toolbox, ladder, step ladder, stepladder, drill, hammer, wrench, screwdriver, water heater,
        broom, mop, dustpan, bucket, vacuum cleaner, paint can, extension cord, carton, locker, cart,
        skateboard""",
    ),
    "garage": FunctionWords(
        typical="""car, truck, motorcycle, workbench, lawn mower, tire, garage door, generator, wheelbarrow,
        snow shovel""",
        possible="""bicycle, toolbox, ladder, helmet, shovel, hose, surfboard, ski, snowboard, skateboard,
        drill, saw""",
    ),
    "balcony": FunctionWords(
        typical="""patio chair, patio table, deck chair, garden chair, lawn chair, flowerpot, watering can,
        barbecue, grill, sun umbrella, parasol, hammock, railing, planter, garden hose, bird feeder, sun
        lounger""",
        possible="""potted plant, plant, bicycle, bench, clothesline, drying rack, chair, flower, telescope""",
    ),
}
"""Function -> its words."""
