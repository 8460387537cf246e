"""One name for each function: what a VLM or a person calls a room -> the word that regions use for it."""

from __future__ import annotations

from ovip.scene.words import normalize_word
from services.regions.domain.partition import UNKNOWN_FUNCTION

LONGEST_NAME = 40
_OPEN = {
    "",
    "none",
    "any",
    "anywhere",
    "other",
    "n/a",
    "general",
    "misc",
    "miscellaneous",
    "various",
    "unclear",
}
_ROOM_WORDS = ("area", "zone", "corner", "space", "nook", "room")
_SYNONYMS = {
    "kitchen": "kitchenette, galley, cooking, food preparation, food prep, pantry, break",
    "dining area": "dining, dinette, breakfast, eating, dining hall, canteen, cafeteria",
    "living room": """living, lounge, sitting, family, tv, parlor, parlour, drawing, den, salon, seating, media,
        entertainment, relaxation, common, reading""",
    "bedroom": """bed, sleeping, guest, guest bedroom, main bedroom, master bedroom, kid bedroom, child bedroom,
        nursery, dormitory""",
    "bathroom": """bath, wc, toilet, restroom, washroom, shower, powder, lavatory, ensuite, en suite, half bath, guest
        bathroom, master bathroom, water closet""",
    "office": "home office, study, work, working, workspace, workstation, desk, computer, open office, cubicle",
    "meeting room": "meeting, conference, board, boardroom",
    "laundry": "utility, washing, ironing",
    "hallway": """entryway, entry, entrance, entrance hall, entry hall, foyer, hall, corridor, lobby, vestibule,
        passage, passageway, mudroom, mud, landing, stairwell""",
    "gym": "home gym, exercise, fitness, workout, training, weight",
    "playroom": "play, game, kid, child, kid play, child play, toy, recreation, rec",
    "storage": "store, storeroom, closet, walk-in closet, utility closet, attic, cellar, warehouse",
    "garage": "carport, parking",
    "balcony": "terrace, patio, deck, porch, veranda, loggia",
}


def function_name(text: str) -> str:
    """The one name of a room's function: `"Home Office"` and `"study area"` -> `"office"`.

    A name that is no synonym of ours, as "wine cellar", is kept in the shared form of words; what names nothing,
    or is longer than a name, is "unknown".
    """
    word = _form(text)
    if len(word) > LONGEST_NAME or word in _OPEN:
        return UNKNOWN_FUNCTION
    return _NAMES.get(word) or _NAMES.get(_bare(word)) or word


def _form(text: str) -> str:
    return normalize_word(text.replace("-", " ").replace("'s ", " "))


def _bare(word: str) -> str:
    """Without the word for a piece of a home that it ends in: "kids room" -> "kid"."""
    first, _, last = word.rpartition(" ")
    return _form(first) if last in _ROOM_WORDS else word


def _names() -> dict[str, str]:
    names = {}
    for name, words in _SYNONYMS.items():
        names.update({_form(word): name for word in (name, _bare(name), *words.split(","))})
    return names


_NAMES = _names()
