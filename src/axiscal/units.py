"""Quantities with their units: "12 um" <-> SI. The only place where a unit has a name.

Inside the package every number is in metres, radians, seconds (and kelvin). Files, the command line, the page and the
report write quantities as text with a unit; they come in through `parse_quantity` and `from_unit` and leave through
`format_quantity` and `to_unit`.
"""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import TYPE_CHECKING, Literal, TypeVar

from axiscal.exceptions import DescriptionError, UnitError
from axiscal.language.spoken import WORDS, put, said

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

Dimension = Literal[
    "length",
    "angle",
    "time",
    "speed",
    "rotation_speed",
    "acceleration",
    "rotation_acceleration",
    "temperature",
    "temperature_difference",
    "expansion",
]

Number = TypeVar("Number", float, "NDArray[np.float64]")

_TABLES = tomllib.loads(resources.files("axiscal").joinpath("units.toml").read_text(encoding="utf-8"))
EXAMPLES: dict[Dimension, str] = _TABLES["examples"]
_NOUNS: dict[Dimension, str] = WORDS["dimensions"]

# The factor to SI is kept as a ratio (times, by) of exact numbers, so that "120 mm" is exactly 0.12.
_Scale = tuple[float, float]
_OF_PI = {name: (times * math.pi, by) for name, (times, by) in _TABLES["angle_of_pi"].items()}
_ANGLES: dict[str, _Scale] = _TABLES["angle"] | _OF_PI


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit of one dimension: value in SI = value · times / by + plus."""

    dimension: Dimension
    times: float
    by: float
    plus: float = 0.0


def _units() -> Iterator[tuple[str, Unit]]:
    """Yield every unit with its name; only K has two dimensions."""
    bases: list[tuple[dict[str, _Scale], Dimension, Dimension, Dimension]] = [
        (_TABLES["length"], "length", "speed", "acceleration"),
        (_ANGLES, "angle", "rotation_speed", "rotation_acceleration"),
    ]
    for scales, base, speed, acceleration in bases:
        for name, (times, by) in scales.items():
            yield name, Unit(base, times, by)
            for second, (per, over) in _TABLES["time"].items() if "/" not in name else ():
                yield f"{name}/{second}", Unit(speed, times * over, by * per)
                yield f"{name}/{second}^2", Unit(acceleration, times * over**2, by * per**2)
    yield from ((name, Unit("time", *scale)) for name, scale in _TABLES["time"].items())
    yield from ((name, Unit("expansion", *scale)) for name, scale in _TABLES["expansion"].items())
    yield "rpm", Unit("rotation_speed", math.tau, 60)
    yield "degC", Unit("temperature", 1, 1, 273.15)
    yield "K", Unit("temperature", 1, 1)
    yield "K", Unit("temperature_difference", 1, 1)


_UNITS = {(name, unit.dimension): unit for name, unit in _units()}
_NUMBER = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_QUANTITY = re.compile(rf"({_NUMBER})\s*(\S.*)?", re.DOTALL)
_DECIMAL_COMMA = re.compile(r"[+-]?[0-9]+(?:,[0-9]+)+(?![0-9])")
_NOT_FINITE = re.compile(r"[+-]?(nan|inf|infinity)\b", re.IGNORECASE)
_CANONICAL = str.maketrans({"µ": "u", "μ": "u", "²": "^2", "º": "°", "−": "-"})


def parse_quantity(text: str, dimension: Dimension) -> float:
    """Return the quantity in SI units: m, rad, s, m/s, rad/s, m/s², rad/s², K, 1/K.

    text : a number with a decimal point, then a unit: "12 um", "12 µm", "0.5 arcsec", "10 m/min"
    Raises UnitError, which names the text, what was expected and an example.
    """
    number, unit_name = _split(text, dimension)
    unit = _UNITS.get((unit_name, dimension))
    if unit is None:
        raise _misfit(text, unit_name, dimension)
    value = float(number) * unit.times / unit.by + unit.plus
    if not math.isfinite(value):
        raise UnitError("{text} is too large to be a number", _expected(dimension), text=_quoted(text))
    return value


def within(text: str, dimension: Dimension, least: float, most: float = math.inf) -> float:
    """Return a quantity in SI units between two limits; raises UnitError, or DescriptionError where it is outside."""
    value = parse_quantity(text, dimension)
    if least <= value <= most:
        return value
    what = "{text} is too small" if value < least else "{text} is too large"
    what = "{text} is negative" if value < 0 <= least else "{text} is zero" if value == 0 else what
    remedy = "Write a value from {low} to {high}" if most < math.inf else "Write a value from {low} on"
    unit = _split(text, dimension)[1]
    low, high = (format_quantity(limit, unit) for limit in (least, most))
    raise DescriptionError(what, remedy, text=_quoted(text), low=low, high=high)


def from_unit(value: Number, unit: str) -> Number:
    """Return a number, or an array of them, given in `unit`, in SI units; raises UnitError for an unknown unit."""
    known = find_unit(unit)
    return value * known.times / known.by + known.plus


def to_unit(value: Number, unit: str) -> Number:
    """Return a number, or an array of them, given in SI units, in `unit`; raises UnitError for an unknown unit."""
    known = find_unit(unit)
    return (value - known.plus) * known.by / known.times


def format_quantity(value: float, unit: str, digits: int = 6) -> str:
    """Return an SI value as text in `unit`, as `parse_quantity` reads it back; digits: significant ones."""
    return f"{to_unit(value, unit):.{digits}g} {unit}"


def said_quantity(value: float, unit: str, digits: int = 3) -> str:
    """Return an SI value for a sentence: in `unit`, decimals as its language writes them, large ones in whole units."""
    shown = float(to_unit(value, unit))
    form = f".{digits}g" if abs(shown) < 10**digits - 0.5 else ".0f"
    return put(f"{{value:{form}}} {{unit}}", value=shown, unit=unit)


_NEAR = 0.1
"""Share of a limit within which a number has three digits."""


def digits(value: float, limit: float = math.inf) -> str:
    """Return a number with two digits, three where a limit is near, without an exponent."""
    count = 3 if abs(value - limit) < _NEAR * limit < math.inf else 2
    if value == 0:
        return "0"
    places = count - 1 - math.floor(math.log10(abs(float(f"{value:.{count - 1}e}"))))
    return put(f"{{value:.{max(places, 0)}f}}", value=round(value, places))


def um_text(value: float) -> str:
    """Return so many um for a sentence."""
    return said_quantity(from_unit(value, "um"), "um")


@cache
def find_unit(name: str) -> Unit:
    """Return the unit of that name, spelt as in `parse_quantity`; raises UnitError for an unknown one.

    "K" alone is a temperature.
    """
    canonical = _canonical(name)
    for (known, _), unit in _UNITS.items():
        if known == canonical:
            return unit
    remedy = _suggestion(canonical) or said("Units are written like um, mm, arcsec, urad, s")
    raise UnitError("{text} is not a unit", remedy, text=_quoted(name))


def _split(text: str, dimension: Dimension) -> tuple[str, str]:
    """Return number and canonical unit name of a quantity."""
    plain = text.strip().replace("−", "-")
    found = _QUANTITY.fullmatch(plain)
    if _NOT_FINITE.match(plain):
        raise UnitError("{text} is not a finite number", _expected(dimension), text=_quoted(text))
    if _DECIMAL_COMMA.match(plain):
        remedy = said("{write}, and its decimals after a point", write=_expected(dimension))
        raise UnitError("{text} has a comma in its number", remedy, text=_quoted(text))
    if found is None or found[2] is None:
        what = "{text} is not a number with a unit"
        what = what if found is None else "{text} has no unit (missing unit)"
        raise UnitError(what, _expected(dimension), text=_quoted(text))
    return found[1], _canonical(found[2])


def _canonical(name: str) -> str:
    """Return a unit name in the spelling of the table: µ as u, ² as ^2, °C as degC, no blanks about a slash."""
    plain = re.sub(r"\s*([/^])\s*", r"\1", name.strip().translate(_CANONICAL)).replace("°C", "degC")
    plain = re.sub(r"(?<=/)(us|ms|s|min|h)2$", r"\1^2", plain)
    return re.sub(r"/\(m[ *·]K\)$|/m/degC$", "/m/K", plain)


def _misfit(text: str, unit_name: str, dimension: Dimension) -> UnitError:
    """Return the failure for a unit that is unknown, or of another dimension."""
    others = [unit for (name, _), unit in _UNITS.items() if name == unit_name]
    if others:
        found, wanted = (said(_NOUNS[each]) for each in (others[0].dimension, dimension))
        what = said("{text} is {found}, not {wanted}", text=_quoted(text), found=found, wanted=wanted)
        return UnitError(what, _expected(dimension))
    hint, unit = _suggestion(unit_name, dimension), _quoted(unit_name)
    return UnitError("{text} has an unknown unit {unit}", hint or _expected(dimension), text=_quoted(text), unit=unit)


def _suggestion(name: str, dimension: Dimension | None = None) -> str | None:
    """Return a sentence with the nearest unit, of the wanted dimension when there is one."""
    names = [known for known, of in _UNITS if dimension in (None, of)]
    near = next((each for each in _TABLES["synonyms"].get(name.casefold(), ()) if each in names), None)
    near = near or nearest(name, names)
    return said("Perhaps {word} is meant", word=f'"{near}"') if near else None


def nearest(word: str, known: Iterable[str]) -> str | None:
    """Return the known word that was probably meant, if any is near."""
    from difflib import get_close_matches

    words = list(known)
    same = [candidate for candidate in words if candidate.casefold() == word.casefold()]
    near = same or get_close_matches(word[:80], words, 1, 0.6)
    return near[0] if near else None


def _expected(dimension: Dimension) -> str:
    example = EXAMPLES[dimension]
    return said('Write {what} with its unit, such as "{example}"', what=said(_NOUNS[dimension]), example=example)


def shortened(text: str, most: int = 60) -> str:
    """Return what somebody wrote for a message: not longer than that, and what cannot be printed as its number."""
    text = text if len(text) <= most else text[: most - 3] + "..."
    return "".join(c if c.isprintable() else f"\\x{ord(c):02x}" for c in text)


def _quoted(text: str) -> str:
    return f'"{shortened(text)}"'
