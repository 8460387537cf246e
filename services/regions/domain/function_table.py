"""What rooms objects belong in: words by function, for homes and offices without a VLM (SPEC 6).

Source: written by hand for this project from common sense, over the indoor class names of COCO, LVIS v1, ScanNet
and Replica, words that robots' detectors report, and the labels of the furnished house that tests use. It is no
measured statistic. A word under `typical` speaks for its function by itself, so it holds what hardly ever strays;
a word under `possible` only supports it (a chair or a toy is in many); a word of `NEUTRAL_WORDS` stands, hangs or
is carried anywhere and says nothing.
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
        typical="""stove, gas stove, stovetop, cooktop, hob, cooker, oven, microwave, microwave oven,
        refrigerator, fridge, freezer, ice maker, dishwasher, range hood, fume hood, extractor hood, kitchen
        cabinet, kitchen counter, kitchen island, kitchen sink, kitchen unit, toaster, toaster oven, kettle,
        teakettle, coffee maker, coffee machine, espresso machine, blender, food processor, mixer, eggbeater,
        juicer, cutting board, chopping board, frying pan, pan, saucepan, wok, griddle, hotplate, cooking pot, pot
        lid, casserole, cooking utensil, spatula, ladle, whisk, colander, strainer, grater, peeler, masher, rolling
        pin, slotted turner, wooden spoon, tongs, spice rack, spice jar, dish rack, dish drainer, utensil rack,
        utensil holder, knife block, knife holder, knife set, dish soap, dishwasher detergent, dishrag, dish towel,
        dishtowel, kitchen towel, oven mitt, oven glove, potholder, can opener, measuring cup, bread bin, waffle
        iron, pressure cooker, rice cooker, air fryer, crock pot, slow cooker, egg carton, canister, tinfoil,
        aluminum foil, cooking oil, olive oil, oil bottle, vinegar""",
        possible="""sink, faucet, water faucet, cupboard, cabinet, counter, countertop, knife, fork, spoon,
        cutlery, bowl, plate, cup, mug, glass, jar, can, tin, carton, pot, teapot, coffeepot, pitcher, jug, thermos,
        thermos bottle, apron, sponge, towel, paper towel, dish, tray, drawer, table, kitchen table, kitchen chair,
        stool, bar stool, scale, salt shaker, saltshaker, shaker, pepper mill, condiment, corkscrew, bottle opener,
        funnel, lunch box, cooler, soap dispenser, dustbin, water dispenser, water jug, wine bottle, wine rack, beer
        bottle, beer can, scissors, washing machine, food, fruit, vegetable, fruit bowl, banana, apple, orange,
        mandarin orange, lemon, lime, pear, peach, grape, strawberry, pineapple, watermelon, mango, avocado, carrot,
        broccoli, cauliflower, tomato, onion, potato, sweet potato, garlic, ginger, lettuce, cucumber, zucchini,
        eggplant, pepper, bell pepper, chili, mushroom, celery, green bean, bread, bun, bagel, tortilla, cheese, egg,
        butter, milk, yogurt, juice, orange juice, honey, jam, sugar, flour, pasta, rice, meat, ham, sausage,
        chicken, cookie, chocolate bar, snack, sandwich, pizza, tea bag, hot sauce, food container""",
    ),
    "dining area": FunctionWords(
        typical="""dining table, dining chair, dining room table, place mat, placemat, tablecloth, table runner,
        napkin holder, gravy boat, candelabrum, china cabinet, highchair, high chair, salad plate, soup bowl, soup
        tureen""",
        possible="""chair, table, plate, bowl, wine glass, wineglass, flute glass, shot glass, glass, cup, mug, fork,
        spoon, soupspoon, knife, steak knife, cutlery, chopstick, napkin, chinaware, teapot, teacup, saucer, wine
        bottle, wine bucket, cake, birthday cake, pie, pizza, sandwich, food, fruit, salad, fruit bowl, chandelier,
        tray, platter, bench, pitcher, carafe, candle, candle holder, candlestick, sugar bowl, cream pitcher, salt
        shaker, saltshaker, pepper mill, dish, coaster, sideboard, buffet, donut, doughnut, hot dog, vase""",
    ),
    "living room": FunctionWords(
        typical="""sofa, couch, loveseat, settee, sectional sofa, chaise longue, coffee table, tv stand, tv cabinet,
        tv unit, media console, armchair, recliner, lounge chair, fireplace, mantel, ottoman, pouf, entertainment
        center, sofa bed, futon, footstool, home theater, soundbar, subwoofer, dvd player, game console, record
        player""",
        possible="""television, television set, tv, tv screen, tv monitor, remote control, remote, cushion, throw
        pillow, pillow, blanket, rug, carpet, lamp, floor lamp, side table, end table, table, chair, bookshelf,
        bookcase, book, magazine, newspaper, speaker, stereo, amplifier, cd player, phonograph record, videotape,
        piano, music stool, guitar, violin, drum, rocking chair, vase, candle, glass, mug, cup, game controller,
        joystick, chess set, chessboard, aquarium, fishbowl, birdcage, beanbag, ashtray, cabinet, display cabinet,
        sideboard, stool, figurine, christmas tree, poker, chandelier, tapestry""",
    ),
    "bedroom": FunctionWords(
        typical="""bed, double bed, single bed, bunk bed, daybed, crib, cradle, cot, bassinet, nightstand, night
        table, bedside table, wardrobe, armoire, mattress, headboard, dresser, bedspread, comforter, duvet, quilt, bed
        sheet, bedding, bed frame, pajama, pajamas, nightshirt, alarm clock, bedside lamp, vanity table, dressing
        table, jewelry box, baby monitor, changing table""",
        possible="""pillow, blanket, sheet, lamp, table lamp, rug, closet, chest of drawers, drawer, clothes hanger,
        coat hanger, hanger, clothes, clothing, teddy bear, stuffed animal, doll, slipper, robe, bathrobe, hair
        dryer, hair drier, curling iron, sock, underwear, shirt, dress, skirt, sweater, sweatshirt, jean, jeans,
        trousers, belt, necktie, blouse, jewelry, necklace, bracelet, earring, perfume, lotion, sleep mask, diaper,
        pacifier, mirror, trunk, suitcase, backpack, handbag, hat, jacket, coat, shoe, desk, desk lamp,
        laundry basket, remote control, television, tv""",
    ),
    "bathroom": FunctionWords(
        typical="""toilet, bathtub, bath, shower, shower head, showerhead, shower curtain, shower door, shower stall,
        shower cabin, shower wall, shower screen, washbasin, wash basin, bathroom sink, bathroom vanity, toilet
        paper, toilet paper holder, toilet paper dispenser, toilet tissue, toothbrush, toothbrush holder,
        toothpaste, dental floss, mouthwash, shampoo, shower gel, bath mat, bathmat, bath towel, hand towel, floral
        towel, towel rack, towel bar, towel rail, towel holder, urinal, bidet, plunger, toilet brush, toilet seat,
        medicine cabinet, bathroom cabinet, mirror cabinet, shower cap, razor, razorblade, shaver, shaving cream,
        loofah, soap dish, cotton swab, grab bar, hand dryer""",
        possible="""sink, faucet, mirror, towel, soap, soap dispenser, soap bottle, bathrobe, hair dryer, hair drier,
        scale, lotion, comb, hairbrush, hairpin, sponge, perfume, nailfile, medicine, cabinet, laundry basket, laundry
        hamper, clothes hamper, hamper, washing machine, automatic washer, scrubbing brush, tissue paper, cosmetic,
        makeup, paper towel dispenser""",
    ),
    "office": FunctionWords(
        typical="""desk, office chair, office desk, swivel chair, computer, desktop computer, computer tower,
        computer monitor, monitor, computer keyboard, keyboard, computer mouse, mouse, mousepad, laptop stand, docking
        station, printer, copier, photocopier, filing cabinet, file cabinet, file folder, stapler, scanner, paper
        shredder, shredder, desk lamp, desk organizer, pen holder, pencil cup, pencil holder, paper tray, paper
        cutter, calculator, bulletin board, corkboard, hole puncher, puncher, paper clip, inkpad, typewriter, server
        rack, cubicle""",
        possible="""laptop, laptop computer, book, binder, folder, pen, pencil, pencil box, pencil sharpener, eraser,
        marker, highlighter, ruler, notebook, notepad, clipboard, paper, envelope, business card, tape, scissors,
        bookshelf, bookcase, chair, table, cabinet, drawer, telephone, webcam, headset, globe, calendar, map,
        briefcase, router, whiteboard, blackboard, projector, telescope, microscope, power strip, water cooler,
        paperweight, mug, cup""",
    ),
    "meeting room": FunctionWords(
        typical="""conference table, meeting table, conference phone, conference chair, flip chart, flipchart,
        lectern, podium, projector screen""",
        possible="whiteboard, projector, marker, office chair, microphone, easel",
    ),
    "laundry": FunctionWords(
        typical="""washing machine, washer, automatic washer, dryer, clothes dryer, ironing board, iron, laundry
        detergent, fabric softener, laundry sink""",
        possible="""laundry basket, laundry hamper, clothes hamper, hamper, detergent, drying rack, clothesline,
        clothespin, bleach, cleansing agent, mop, broom, bucket, vacuum cleaner, clothes hanger, hanger, clothes,
        water heater, boiler, dustpan, cleaning product, spray bottle, sewing machine""",
    ),
    "hallway": FunctionWords(
        typical="""shoe rack, shoe cabinet, coat rack, coatrack, coat hook, coat stand, umbrella stand, doormat, door
        mat, welcome mat, hat rack, key holder, key rack, hallstand, hall tree, doorbell, intercom, mailbox, mail
        slot, front door, entrance door, entrance mat, shoehorn, elevator, elevator door, turnstile""",
        possible="""shoe, boot, sandal, slipper, sneaker, flip flop, umbrella, coat, jacket, raincoat, parka, scarf,
        glove, hat, cap, console table, sideboard, bench, backpack, handbag, suitcase, key, keycard, dog leash,
        walking stick, walking cane, security camera, stair rail, banister, handrail, mirror, telephone, wheelchair,
        stroller, baby buggy, vending machine, exit sign""",
    ),
    "gym": FunctionWords(
        typical="""treadmill, exercise bike, exercise machine, stationary bicycle, elliptical trainer, weight bench,
        bench press, barbell, dumbbell, kettlebell, yoga mat, exercise mat, gym mat, punching bag, boxing glove,
        rowing machine, weight plate, jump rope, fitness equipment, gym equipment, weight rack, dumbbell rack,
        pull-up bar, cross trainer, foam roller, medicine ball""",
        possible="""exercise ball, fitness ball, yoga ball, trampoline, mat, sports ball, sweatband, sportswear,
        basketball hoop, table-tennis table, ping pong table, bench""",
    ),
    "playroom": FunctionWords(
        typical="""toy box, toy chest, toy kitchen, dollhouse, doll house, playpen, play mat, rocking horse, ball pit,
        play tent, foosball table, pool table, billiard table, train set, building block, toy block, toy shelf,
        activity table, kids table, kids chair""",
        possible="""toy, toy car, toy truck, toy train, toy animal, doll, rag doll, lego, board game, gameboard, teddy
        bear, stuffed animal, stuffed toy, puppet, puzzle, jigsaw puzzle, ball, sports ball, crayon, coloring
        material, easel, tricycle, balloon, kite, dartboard, table-tennis table, ping pong table, arcade machine,
        pinwheel, beanbag""",
    ),
    "storage": FunctionWords(
        typical="storage rack, storage shelf, pallet, shelving unit, metal shelf, storage container, moving box",
        possible="""storage box, storage bin, cardboard box, crate, container, locker, toolbox, ladder, step ladder,
        stepladder, drill, hammer, wrench, screwdriver, pliers, saw, nail, tool, water heater, boiler, broom, mop,
        dustpan, bucket, vacuum cleaner, paint can, paintbrush, extension cord, cart, hand truck, handcart,
        suitcase, sleeping bag, tent, skateboard, ski, hose, barrel, fuse box, christmas tree""",
    ),
    "garage": FunctionWords(
        typical="""car, truck, pickup truck, minivan, motorcycle, motor scooter, workbench, lawn mower, tire, car
        battery, garage door, generator, wheelbarrow, barrow, snow shovel, chainsaw, trailer""",
        possible="""bicycle, toolbox, tool, ladder, helmet, shovel, rake, hose, surfboard, ski, ski pole, snowboard,
        skateboard, scooter, drill, saw, handsaw, hammer, wrench, screwdriver, sawhorse, clamp, vise, pegboard,
        kayak, oar, sled, fishing rod, golf club, pitchfork, gas can, freezer""",
    ),
    "balcony": FunctionWords(
        typical="""patio chair, patio table, deck chair, garden chair, lawn chair, outdoor chair, outdoor table,
        outdoor sofa, watering can, barbecue, grill, barbecue grill, sun umbrella, patio umbrella, parasol, awning,
        hammock, balcony railing, planter box, window box, garden hose, bird feeder, birdfeeder, birdhouse,
        birdbath, sun lounger, patio heater, wind chime, satellite dish, lamppost""",
        possible="""flowerpot, flower pot, planter, bicycle, clothesline, drying rack, folding chair, railing, bench,
        wicker chair, garden tool, telescope, picnic table, chair""",
    ),
}
"""Function -> its words."""

NEUTRAL_WORDS = """picture, picture frame, photo frame, photo, photograph, painting, poster, wall art, artwork, canvas,
wall decoration, decoration, ornament, sculpture, statue, sign, plaque, flag, switch, light switch, wall switch, dimmer,
wall plug, power outlet, outlet, electrical outlet, wall socket, socket, plug, power socket, adapter, charger, cable,
wire, radiator, heater, space heater, air conditioner, air purifier, air vent, vent, fan, ceiling fan, thermostat,
humidifier, dehumidifier, ceiling lamp, ceiling light, pendant light, pendant lamp, light, light fixture, lightbulb,
wall lamp, wall light, spotlight, lantern, lampshade, smoke detector, fire alarm, fire extinguisher, sprinkler, motion
sensor, alarm, alarm panel, camera, camcorder, tripod, curtain, curtain rod, blinds, window blind, blind, shade,
window, window sill, windowsill, window frame, door, door frame, doorway, doorknob, door handle, handle, knob, hinge,
latch, padlock, lock, wall, floor, ceiling, beam, pillar, column, pipe, stair, stairs, staircase, step, object, thing,
item, unknown, other, structure, furniture, box, bag, plastic bag, shopping bag, paper bag, tote bag, purse, pouch,
basket, bin, trash can, trashcan, trash bin, garbage bin, garbage can, garbage, waste bin, wastebasket, recycling bin,
bottle, water bottle, bottle cap, lid, shelf, wall shelf, rack, hook, wall hook, clock, wall clock, watch, radio, radio
receiver, cell phone, cellular telephone, mobile phone, smartphone, phone, phone charger, tablet, ipod, headphones,
earphone, battery, glasses, spectacles, sunglasses, wallet, coin, money, card, receipt, letter, tissue box, tissue,
handkerchief, cat, dog, bird, person, man, woman, child, ribbon, bow, string, rope, rubber band, stone, leaf, wreath,
flashlight, lighter, matchbox, cigarette, step stool, screen, cover, strap, cloth, fabric, plant, potted plant,
houseplant, indoor plant, artificial plant, flower, flower arrangement, bouquet, first-aid kit, bell, magnet, sticker,
label, tag"""
"""Words that say nothing of where they are: comma-separated, singular, lower case."""
