"""A question read once: the noun asked for, its attributes, its relations (CARA's parse, SPEC 4)."""

from __future__ import annotations

import re
from dataclasses import dataclass
from enum import StrEnum

from ovip.errors import InvalidInput
from ovip.scene.words import normalize_word
from services.retrieval.domain.vocabulary import is_known

MAX_TEXT = 500
ANYTHING = "thing"


class AttributeKind(StrEnum):
    COLOUR = "colour"
    SIZE = "size"
    OTHER = "other"


@dataclass(frozen=True, slots=True)
class Attribute:
    """What the target must be like; OTHER needs eyes (pattern, material, content)."""

    kind: AttributeKind
    word: str


class RelationKind(StrEnum):
    ON = "on"
    IN = "in"
    NEXT_TO = "next to"
    UNDER = "under"
    ABOVE = "above"
    OTHER = "other"


@dataclass(frozen=True, slots=True)
class Relation:
    """Where the target must be; `words` as said, `anchor` the normalised noun of the other thing or place."""

    kind: RelationKind
    words: str
    anchor: str
    anchor_attributes: tuple[Attribute, ...] = ()


@dataclass(frozen=True, slots=True)
class Target:
    """The thing asked for.

    phrase: the noun phrase as said, without question words. noun: its normalised noun, maybe a compound, or
    ANYTHING ("what is on the table"). purpose: set where the question names a use and no thing ("something to
    sit on").
    """

    text: str
    phrase: str
    noun: str
    attributes: tuple[Attribute, ...] = ()
    relations: tuple[Relation, ...] = ()
    purpose: str = ""

    @property
    def plain(self) -> bool:
        """Whether a class name alone settles it."""
        return not self.attributes and not self.relations and not self.purpose


def parse(text: str) -> Target:
    """Reads a question; InvalidInput where there is no text, too much of it, or nothing in it to look for."""
    if not text.strip():
        raise InvalidInput('text: expected a thing to look for, such as "white mug", got nothing')
    if len(text) > MAX_TEXT:
        raise InvalidInput(f"text: expected at most {MAX_TEXT} characters, got {len(text)}")
    said = _said(text)
    if use := _PURPOSE.match(said):
        purpose = use.group("purpose").strip()
        return Target(text=text, phrase=said, noun=ANYTHING, purpose=purpose)
    head, relations = _split_relations(said)
    attributes, noun = _split_attributes(head)
    if noun in _PLACEHOLDERS:
        noun = ANYTHING if attributes or relations else ""
    if not re.search(r"\w", noun):
        raise InvalidInput(f'text: expected a thing to look for, such as "white mug", got only {text[:80]!r}')
    return Target(text, said, noun, attributes, relations)


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


COLOURS = {
    "white": "white",
    "black": "black",
    "grey": "grey",
    "gray": "grey",
    "silver": "grey",
    "red": "red",
    "maroon": "red",
    "crimson": "red",
    "green": "green",
    "olive": "green",
    "blue": "blue",
    "navy": "blue",
    "turquoise": "blue",
    "teal": "blue",
    "yellow": "yellow",
    "golden": "yellow",
    "gold": "yellow",
    "brown": "brown",
    "beige": "brown",
    "tan": "brown",
    "orange": "orange",
    "purple": "purple",
    "violet": "purple",
    "pink": "pink",
}
"""Colour words and the eleven basic colours that they count as."""

LARGE = frozenset({"large", "big", "huge", "largest", "biggest", "bigger", "larger", "giant"})
SMALL = frozenset({"small", "little", "tiny", "smallest", "smaller", "mini", "littlest"})
TALL = frozenset({"tall", "tallest", "high", "highest"})
SHORT = frozenset({"short", "shortest", "low", "lowest"})
LONG = frozenset({"long", "longest", "wide", "widest"})
SIZES = LARGE | SMALL | TALL | SHORT | LONG

_QUALITIES = _words(
    """
    floral flowery striped stripy checked checkered plaid patterned plain dotted spotted printed
    colorful colourful wooden metal metallic plastic glass ceramic leather fabric cotton stone marble
    steel iron brass copper paper cardboard wicker bamboo transparent translucent clear shiny matte
    round square rectangular oval curved soft hard old new dirty clean empty full open closed broken
    folded wet dry hot cold dark light bright pale left right left-hand right-hand first second third
    last other same two-tier double single vintage modern antique electric digital analog portable
    foldable folding black-and-white
    """
)
_PLACEHOLDERS = _words(
    """
    thing something anything object item stuff one what which everything it that somewhere someplace
    place
    """
)
_SHADES = frozenset({"dark", "light", "bright", "pale", "deep"})
_ARTICLES = _words(
    """
    the a an my your our his her their its some any this that these those one all every each please
    there here of me us again now exactly currently located
    """
)
_LEADS = re.compile(
    r"^(?:(?:hey|ok|okay|please|hi|hello)[\s,]+)*"
    r"(?:"
    r"(?:can|could|would|will) you (?:please )?"
    r"(?:find|locate|show|get|bring|fetch|take|see|tell|go|look|point)(?: me| us)?"
    r"(?: (?:where|to|for|at|out|if there)(?: (?:is|are|can i find|can we find))?)*"
    r"|(?:do you|did you|have you) (?:know where|see|seen|spot|find|found|have)(?: (?:is|are))?"
    r"|(?:i|we)(?: am|'m| are|'re)? (?:looking|searching) for"
    r"|(?:i|we) (?:need|want|lost|would like|am after|cannot find|can't find|can not find)"
    r"|(?:where|what|which)(?:'s|s)? "
    r"(?:is|are|was|were|did i (?:put|leave)|(?:can|could|do) (?:i|we) find|do you keep)"
    r"|where's|wheres|what about|how about"
    r"|(?:is|are) there"
    r"|(?:find|locate|search for|look for|seek|show|get|fetch|bring|give|hand)(?: (?:me|us))?"
    r"|(?:go|take me|take us|bring me|bring us|navigate|drive|walk|move|lead me|guide me) to"
    r"|point (?:me )?(?:to|at|out)"
    r")\b[\s,:]*"
)
_PURPOSE = re.compile(
    r"^(?:(?:something|anything|a thing|things|stuff|an object|objects|an item"
    r"|somewhere|someplace|a place|a spot)"
    r"(?: (?:that|which) (?:i|we|you) can(?: use)?(?: to)?"
    r"| (?:i|we) can(?: use to)?| to| for| which can| that can| that)"
    r"|(?:where|what) can (?:i|we)(?: use to)?)"
    r"\s+(?P<purpose>\S.*)$"
)
_INDIRECT = re.compile(r"^where (?P<thing>\S.*) (?:is|are|was|were)$")
_TAIL = re.compile(
    r"(?:\s+(?:please|now|right now|at|currently|located|gone|anywhere|around|then|again|here))+$"
)
_GROUPS = re.compile(r"^(?:a |the |my )?(?:pair|piece|set|couple|bunch) of\s+")

_PREPOSITIONS = (
    (r"on top of", RelationKind.ON),
    (
        r"(?:to the )?(?:left|right) of|in front of|opposite|facing|behind|between|among|across from",
        RelationKind.OTHER,
    ),
    (
        r"(?:right )?(?:next to|close to|near(?: to)?|besides?|by the side of|alongside|adjacent to|by)",
        RelationKind.NEXT_TO,
    ),
    (r"underneath|under|beneath|below", RelationKind.UNDER),
    (r"above|over", RelationKind.ABOVE),
    (r"inside of|inside|within|in", RelationKind.IN),
    (r"attached to|hanging on|hanging from|with|from|at|against", RelationKind.OTHER),
    (r"upon|on", RelationKind.ON),
)
_KINDS = [(re.compile(rf"^(?:{pattern})$"), kind) for pattern, kind in _PREPOSITIONS]
_RELATION = re.compile(
    r"\s+(?:(?:that|which|who) (?:is|are) "
    r"|(?:is|are|standing|lying|sitting|placed|located|hanging|kept|stored) )*"
    rf"(?P<words>{'|'.join(pattern for pattern, _ in _PREPOSITIONS)})\s+(?=\S)"
)


def _said(text: str) -> str:
    """Lower case, one space, no end marks, without the words that only ask."""
    said = re.sub(r"\s+", " ", text.lower().replace("\u2019", "'")).strip(" \t.?!,;:\"'")
    said = said.replace("black and white", "black-and-white")
    if _PURPOSE.match(said):
        return said
    for _ in range(3):
        shorter = _LEADS.sub("", said, count=1).strip(" ,:")
        if shorter == said:
            break
        said = shorter
    if indirect := _INDIRECT.match(said):
        said = indirect.group("thing")
    return _TAIL.sub("", _GROUPS.sub("", said)).strip()


def _split_relations(said: str) -> tuple[str, tuple[Relation, ...]]:
    """`mug on the table next to the sink` -> `mug`, (on table, next to sink)."""
    cuts = list(_RELATION.finditer(f" {said}"))
    if not cuts:
        return said, ()
    head = f" {said}"[: cuts[0].start()].strip() or ANYTHING
    ends = [cut.start() for cut in cuts[1:]] + [len(said) + 1]
    pieces = [
        (cut.group("words"), f" {said}"[cut.end() : end].strip()) for cut, end in zip(cuts, ends, strict=True)
    ]
    return head, tuple(_relation(words, rest) for words, rest in pieces if _content(rest))


def _relation(words: str, rest: str) -> Relation:
    attributes, anchor = _split_attributes(rest)
    kind = next(kind for pattern, kind in _KINDS if pattern.match(words))
    return Relation(kind, words, anchor, attributes)


def _split_attributes(phrase: str) -> tuple[tuple[Attribute, ...], str]:
    """`large dark red wine glass` -> (large, dark, red), `wine glass`; what is not known as a quality stays
    in the noun.
    """
    words = _content(phrase)
    if len(words) > 1 and words[0] in _PLACEHOLDERS:
        words = [*words[1:], ANYTHING]
    words, contents = _split_contents(words)
    attributes: list[Attribute] = []
    while len(words) > 1 and not is_known(normalize_word(" ".join(words))):
        attribute = _attribute(words[0])
        if attribute is None:
            break
        attributes.append(attribute)
        words = words[1:]
    has_colour = any(a.kind is AttributeKind.COLOUR for a in attributes)
    kept = tuple(a for a in attributes if not (has_colour and a.word in _SHADES))
    return (*kept, *contents), normalize_word(" ".join(words))


def _content(phrase: str) -> list[str]:
    words = [word.strip(",.;:\"'()") for word in phrase.replace(" and ", " ").split()]
    words = [re.sub(r"'s$", "", word) for word in words]
    while words and words[0] in _ARTICLES:
        words = words[1:]
    return [word for word in words if word and word not in {"the", "a", "an", "my", "your"}]


def _split_contents(words: list[str]) -> tuple[list[str], tuple[Attribute, ...]]:
    """`cup of tea` -> `cup`, (of tea)."""
    if "of" not in words[1:-1] or is_known(normalize_word(" ".join(words))):
        return words, ()
    at = words.index("of", 1)
    return words[:at], (Attribute(AttributeKind.OTHER, " ".join(words[at:])),)


def _attribute(word: str) -> Attribute | None:
    bare = re.sub(r"(?:d?ish|-ish|-?colou?red)$", "", word) or word
    if bare in COLOURS:
        return Attribute(AttributeKind.COLOUR, COLOURS[bare])
    if word in SIZES:
        return Attribute(AttributeKind.SIZE, word)
    if word in _QUALITIES:
        return Attribute(AttributeKind.OTHER, word)
    return None
