"""The one shared normaliser of words: tags, labels and queries meet in the form it gives."""

from __future__ import annotations

import re

_SPACES = re.compile(r"[\s_]+")
_EDGES = re.compile(r"^[^\w]+|[^\w]+$")
_IRREGULAR = {
    "knives": "knife",
    "shelves": "shelf",
    "bookshelves": "bookshelf",
    "loaves": "loaf",
    "people": "person",
    "mice": "mouse",
    "children": "child",
    "leaves": "leaf",
    "scarves": "scarf",
    "men": "man",
    "women": "woman",
    "teeth": "tooth",
    "feet": "foot",
    "halves": "half",
    "buses": "bus",
    "lenses": "lens",
    "canvases": "canvas",
    "cookies": "cookie",
    "brownies": "brownie",
    "movies": "movie",
    "hoodies": "hoodie",
    "niches": "niche",
}
_INVARIANT = frozenset(
    [
        "glasses",
        "scissors",
        "jeans",
        "trousers",
        "pants",
        "shorts",
        "pajamas",
        "tongs",
        "pliers",
        "headphones",
        "stairs",
        "blinds",
        "binoculars",
        "christmas",
        "canvas",
        "gas",
        "bus",
        "lens",
        "chess",
        "tennis",
        "iris",
        "cactus",
        "asparagus",
        "cosmos",
        "citrus",
        "atlas",
        "bias",
        "goggles",
        "sunglasses",
        "clothes",
        "series",
        "species",
        "news",
    ]
)


def normalize_word(text: str) -> str:
    """Lower case, trimmed, single-spaced, its last word singular: `" Coffee_Mugs. "` -> `"coffee mug"`."""
    word = _normalize_once(text)
    while (again := _normalize_once(word)) != word:  # "mug's" first becomes "mug'"
        word = again
    return word


def _normalize_once(text: str) -> str:
    words = _EDGES.sub("", _SPACES.sub(" ", text.strip().lower())).split(" ")
    return " ".join([*words[:-1], _singular(words[-1])])


def _singular(word: str) -> str:
    if word in _IRREGULAR:
        return _IRREGULAR[word]
    if word in _INVARIANT or len(word) < 3 or not word.endswith("s") or word.endswith(("ss", "us", "is")):
        return word
    if word.endswith("ies") and len(word) > 4:
        return word[:-3] + "y"
    if word.endswith("zzes"):
        return word[:-3]
    if word.endswith(("ches", "shes", "sses", "xes")):
        return word[:-2]
    if word.endswith("oes"):
        return word[:-1] if word in {"shoes", "toes", "canoes", "hoes"} else word[:-2]
    return word[:-1]
