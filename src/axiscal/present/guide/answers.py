"""What a person types at the prompt: a value, or a word for something else."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from axiscal.exceptions import ReadingError
from axiscal.language.spoken import counted, said
from axiscal.measurement.instrument import INSTRUMENTS, values_of
from axiscal.measurement.reading import reading_unit
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.units import parse_quantity

_PLAIN = re.compile(r"[+−-]?(?:[0-9]+[.,]?[0-9]*|[.,][0-9]+)(?:[eE][+-]?[0-9]+)?")
_SEVERAL = re.compile(r"\s*[;/]\s*|\s*,\s+|(?<=[^\W\d]),|\s+(?=[+−-]?[.,]?[0-9])")


@dataclass(frozen=True, eq=False, slots=True)
class Value:
    """A reading.  values : (k,) m or rad"""

    values: Array


@dataclass(frozen=True, slots=True)
class Word:
    """Something else than a reading.

    action : "show", or one of ACTIONS; text : what followed, such as the reason of a skip
    """

    action: str
    text: str = ""


ACTIONS = ("undo", "skip", "note", "leave", "stop", "pause", "help", "more")
"""What can be typed instead of a reading; `more` once a target is reached."""
_SHORT = {"u": "undo", "s": "skip", "n": "note", "l": "leave", "q": "pause", "p": "pause", "?": "help", "h": "help"}
_SHORT |= {"quit": "pause", "exit": "pause", "finish": "stop", "end": "stop"}


def action(word: str) -> str | None:
    """Return what a word asks for, in English or in the language that is spoken; None for none, "" for no word."""
    known = _SHORT | {each: each for each in ACTIONS} | {said(each).lower(): each for each in ACTIONS}
    return known.get(word.lower()) if word else ""


def answer(text: str, setup: Setup) -> Value | Word:
    """Return what was typed, a number in the unit of the set-up where none is said; raises ReadingError or UnitError.

    Decimals come after a point or a comma. Three values are parted by blanks, semicolons or commas with a blank.
    """
    word, _, rest = text.strip().partition(" ")
    if not word:
        return Word("show")
    if (wanted := action(word)) is not None:
        return Word(wanted, rest.strip())
    if word[0].isalpha():
        what = said('"{text}" is no reading and no word known here', text=text.strip())
        raise ReadingError(what, said("Type ? for what can be typed"))
    return Value(np.array([_value(part, setup) for part in value_texts(text.strip(), setup)]))


def value_texts(text: str, setup: Setup) -> list[str]:
    """Return the texts of the values of a reading; a unit after the last alone is of all. Raises ReadingError."""
    count = values_of(setup)
    parts = _SEVERAL.split(text.strip()) if count > 1 else [text]
    if len(parts) != count:
        given = counted("one value", "{count} values", len(parts))
        what = said('"{text}" is {given}, and the instrument gives {count}', text=text, given=given, count=count)
        example = " ".join(("1.2", "-0.4", "0.8", "0.3")[:count]) + " um"
        if setup.stations:
            raise ReadingError(what, said("Type one from each station in its order, as in {example}", example=example))
        raise ReadingError(what, said("Type those along x, y and z, as in {example}", example=example))
    numbers = [_PLAIN.match(part) for part in parts]
    bare = [number is not None and number.end() == len(part) for part, number in zip(parts, numbers, strict=True)]
    if all(bare[:-1]) and (last := numbers[-1]) is not None:
        unit = parts[-1][last.end() :]
        return [*(part + unit for part in parts[:-1]), parts[-1]]
    if any(bare):
        what = said('"{text}" has a unit for some of its values', text=text)
        raise ReadingError(what, said("Give one unit after the last, or one for each"))
    return parts


def _value(text: str, setup: Setup) -> float:
    dimension = INSTRUMENTS[setup.instrument].reads
    number = _PLAIN.match(text)
    if number is None:
        return parse_quantity(text, dimension)
    plain = number[0].replace(",", ".").replace("−", "-")
    return parse_quantity(plain + (text[number.end() :].strip() or reading_unit(setup)), dimension)
