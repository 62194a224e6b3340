"""Figures and sentences as text, with units as people write them."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

from axiscal.language.spoken import WORDS, decimals, later, said

if TYPE_CHECKING:
    pass

U_OF_TABLES = later("U of the tables: U² of the volume and (k times what they leave)² add up to its square.")

UNITS = {"um": "µm", "urad": "µrad", "um/m": "µm/m", "arcsec": "″", "deg": "°", "mm": "mm", "min": "min"}
_SHOWN = {"um": "µm", "urad": "µrad", "degC": "°C"}
_UNIT = re.compile(r"(?<=[0-9])[ \u00a0](?:(um|urad|degC)\b|%)")
_LONG = 1e6
"""From here on a number is written with an exponent."""
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_NARROW_SPACE = "\u202f"
_NO_BREAK = "\u00a0"


def unit_text(unit: str) -> str:
    """Return a unit as people write it: um -> µm."""
    return UNITS.get(unit, unit)


def spelt(text: str) -> str:
    """Return a sentence with the units of its numbers as people write them; "um" is a word in other languages."""
    return _UNIT.sub(lambda found: _NO_BREAK + _SHOWN.get(found[1], "%"), text)


def percent(share: float) -> str:
    """Return a share as "12.3 %"."""
    return f"{decimals(f'{100 * share:.1f}')} %"


def figure(value: float, digits: int = 3) -> str:
    """Return value with so many significant digits, without an exponent where a person would write none."""
    size, shown = abs(value), f".{digits - 1}e"
    if size == 0:
        return "0"
    if not 1e-3 <= float(f"{size:{shown}}") < _LONG:
        mantissa, exponent = f"{value:{shown}}".split("e")
        return _minus(decimals(f"{mantissa} × 10{str(int(exponent)).translate(_SUPERSCRIPT)}"))
    return to_decimals(value, max(0, digits - 1 - math.floor(math.log10(float(f"{size:{shown}}")))))


def quantity(value: float, unit: str, digits: int = 3) -> str:
    """Return value and unit with a space that does not break (none before degree and second signs)."""
    sign = unit_text(unit)
    return f"{figure(value, digits)}{sign if sign in '°″' else _NO_BREAK + sign}"


def to_decimals(value: float, digits: int) -> str:
    """Return value with so many decimals."""
    shown = f"{value:,.{digits}f}".replace(",", _NARROW_SPACE)
    return _minus(decimals(shown.removeprefix("-") if float(f"{value:.{digits}f}") == 0 else shown))


def coordinate(value: float) -> str:
    """Return a coordinate to a thousandth, without trailing zeros."""
    text = f"{value:.3f}".rstrip("0").rstrip(".") if abs(value) < 1e9 else f"{value:.4g}"
    return _minus("0" if text == "-0" else decimals(text))


def axis_unit(axis: str) -> str:
    """Return the display unit of an axis' coordinate: A, B and C turn (ISO 841)."""
    return "deg" if axis[:1] in "ABC" else "mm"


def _minus(text: str) -> str:
    return text.replace("-", "−")


_CAUSES = WORDS["type_b"]


def cause_words(name: str, owner: str) -> str:
    """Return a cause in words.  name : of its row; owner : the instrument or set-up that it belongs to, if any"""
    return said(_CAUSES[name], owner=said(owner) if owner else "")
