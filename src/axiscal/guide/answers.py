"""What a person types at the prompt: a value, or a word for something else."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from axiscal.exceptions import ReadingError
from axiscal.language.spoken import counted, said
from axiscal.measurement.instrument import INSTRUMENTS, values_of
from axiscal.measurement.place_texts import reading_unit
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.units import from_unit, parse_quantity

_PLAIN = re.compile(r"[+−-]?(?:[0-9]+[.,]?[0-9]*|[.,][0-9]+)")
_SEVERAL = re.compile(r"\s*[;/]\s*|\s*,\s+|\s+(?=[+−-]?[.,]?[0-9])")


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
    return Value(_values(text.strip(), setup))


def _values(text: str, setup: Setup) -> Array:
    count = values_of(setup)
    parts = _SEVERAL.split(text) if count > 1 else [text]
    if len(parts) != count:
        given = counted("one value", "{count} values", len(parts))
        what = said('"{text}" is {given}, and the instrument gives {count}', text=text, given=given, count=count)
        raise ReadingError(what, said("Type them in one line, as in {example}", example="1.2 -0.4 0.8"))
    return np.array([_value(part, setup) for part in parts])


def _value(text: str, setup: Setup) -> float:
    number = _PLAIN.match(text)
    unit = "" if number is None else text[number.end() :].strip()
    if number is None:
        return parse_quantity(text, INSTRUMENTS[setup.instrument].reads)
    plain = number[0].replace(",", ".").replace("−", "-")
    if not unit:
        return float(from_unit(float(plain), reading_unit(setup)))
    return parse_quantity(plain + text[number.end() :], INSTRUMENTS[setup.instrument].reads)
