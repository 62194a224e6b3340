"""The kinematic chain of a machine as a string in the manner of ISO 10791-6: "w-C'-B'-b-Y-X-Z-t"."""

from __future__ import annotations

import re
from dataclasses import dataclass

from axiscal.document import shown
from axiscal.exceptions import ChainError
from axiscal.language.spoken import said
from axiscal.machine.axis import LINEAR_LETTERS, ROTARY_LETTERS

MOST_AXES = 6
"""More axes have not been tried; nothing else ends there."""
_LONGEST = 200
"""Characters; a chain of six axes has thirty."""
_LINK = re.compile(rf"(?P<name>[{LINEAR_LETTERS}{ROTARY_LETTERS}][1-9]?)(?P<prime>'?)")
_SPINDLE = re.compile(rf"\([{ROTARY_LETTERS}][1-9]?\)")
_PRIMES = str.maketrans(dict.fromkeys("’‘′´`", "'"))
_EXAMPLE = "Write the chain from the workpiece w over the bed b to the tool t, such as \"w-X'-Y'-b-Z-t\""


@dataclass(frozen=True, slots=True)
class Link:
    """One axis in the chain; workpiece_side: primed, between workpiece and bed."""

    name: str
    workpiece_side: bool


def parse_chain(text: str) -> tuple[Link, ...]:
    """Return the axes of a chain from the workpiece to the tool; a spindle in parentheses is left out.

    text : "w-C'-B'-b-Y-X-Z-(C)-t" or "[w C' B' b Y X Z (C) t]", one to six axes, each once
    Raises ChainError: w, b or t missing or misplaced, an axis unknown, twice, or primed on the wrong side.
    """
    words = _words(text)
    before, after = _sides(words, text)
    links = [_link(word, True, text) for word in before]
    links += [_link(word, False, text) for word in after if not _SPINDLE.fullmatch(word)]
    _check_names([link.name for link in links], text)
    return tuple(links)


def _words(text: str) -> list[str]:
    """Return the parts of a chain string between dashes, or between blanks inside brackets."""
    plain = text.translate(_PRIMES).strip()
    if len(plain) > _LONGEST:
        raise ChainError("a chain of {count} characters is too long", _EXAMPLE, count=len(plain))
    if plain.startswith("[") and plain.endswith("]"):
        return plain[1:-1].split()
    return [word.strip() for word in plain.split("-")]


def _sides(words: list[str], text: str) -> tuple[list[str], list[str]]:
    """Return the words between w and b and those between b and t."""
    for end, word in ((0, "w"), (-1, "t")):
        if not words or words[end] != word:
            what = "the chain {text} does not begin with w, the workpiece"
            what = what if word == "w" else "the chain {text} does not end with t, the tool"
            raise ChainError(what, _EXAMPLE, text=shown(text))
    inner = words[1:-1]
    if inner.count("b") != 1:
        what = "the chain {text} has more than one bed b" if "b" in inner else "the chain {text} has no bed b"
        raise ChainError(what, _EXAMPLE, text=shown(text))
    bed = inner.index("b")
    return inner[:bed], inner[bed + 1 :]


def _link(word: str, workpiece_side: bool, text: str) -> Link:
    """Return one axis; raises ChainError for a word that is none, or whose prime does not fit its side of the bed."""
    found = _LINK.fullmatch(word)
    if found is None:
        what = "{word} in the chain {text} is not an axis"
        raise ChainError(what, _word_remedy(word), word=shown(word), text=shown(text))
    name, primed = found["name"], bool(found["prime"])
    if workpiece_side and not primed:
        remedy = "Axes between w and b carry the workpiece and have a prime: write {name}', or put it behind b"
        raise ChainError("{name} in the chain {text} has no prime", remedy, name=name, text=shown(text))
    if primed and not workpiece_side:
        remedy = "Axes between b and t carry the tool and have no prime: write {name}, or put it before b"
        raise ChainError("{name}' in the chain {text} has a prime", remedy, name=name, text=shown(text))
    return Link(name, workpiece_side)


def _word_remedy(word: str) -> str:
    if _LINK.fullmatch(word.upper()):
        return said("Axes are written in capitals: {word}", word=word.upper())
    if _SPINDLE.fullmatch(word.replace("'", "")):
        return said(
            "A spindle in parentheses stands behind b; a table that is positioned is written without parentheses"
        )
    return said("Axes are X Y Z U V W P Q R (linear) and A B C (rotary), with one digit after them if needed")


def _check_names(names: list[str], text: str) -> None:
    """Raise ChainError unless there are one to six axes, each once."""
    twice = next((name for place, name in enumerate(names) if name in names[:place]), None)
    if twice:
        what = "{axis} stands twice in the chain {text}"
        remedy = "Every axis stands in the chain once; name a second one {letter}2 or with another letter"
        raise ChainError(what, remedy, axis=twice, text=shown(text), letter=twice[0])
    if not 1 <= len(names) <= MOST_AXES:
        what = "the chain {text} has {count} axes"
        raise ChainError(what, "One to {most} axes are possible", text=shown(text), count=len(names), most=MOST_AXES)
