"""Figures and sentences of the report as text, and the templates that lay them out."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Collection, Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from axiscal.estimation.accuracy.expanded import BAND
from axiscal.language.spoken import WORDS, capital, counted, decimals, joined, later, said, spoken_now
from axiscal.present.summary import ConstantSummary, CurveSummary, HistoryRow, Iso230, Position, Summary

if TYPE_CHECKING:
    from jinja2 import Environment

UNSAID = later("not stated")
U_OF_TABLES = later("U of the tables: U² of the volume and (k times what they leave)² add up to its square.")

UNITS = {"um": "µm", "urad": "µrad", "um/m": "µm/m", "arcsec": "″", "deg": "°", "mm": "mm", "min": "min"}
_SHOWN = {"um": "µm", "urad": "µrad", "degC": "°C"}
_UNIT = re.compile(r"(?<=[0-9])[ \u00a0](?:(um|urad|degC)\b|%)")
_LONG = 1e6
"""From here on a number is written with an exponent."""
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_TOUCHED = 0.1
"""Share of the variance that readings take away: of less nobody would see it in the picture."""
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


def short(value: float) -> str:
    """Return a value that a person chose, such as a target, without trailing zeros."""
    text, point = figure(value), decimals(".")
    return text.rstrip("0").rstrip(point) if point in text and "×" not in text else text


def quantity(value: float, unit: str, digits: int = 3) -> str:
    """Return value and unit with a space that does not break (none before degree and second signs)."""
    sign = unit_text(unit)
    return f"{figure(value, digits)}{sign if sign in '°″' else _NO_BREAK + sign}"


def values_text(values: Sequence[float], *units: str) -> str:
    """Return the numbers of one reading as "1.20 / 0.30 um", or "1.20 um / 3.00 urad"; "" where there is none.

    units : of each number, or the one that all have
    """
    if not values or len(set(units)) == 1:
        return "" if not values else f"{' / '.join(map(as_read, values))}{_NO_BREAK}{unit_text(units[0])}"
    return " / ".join(values_text([value], unit) for value, unit in zip(values, units, strict=True))


def as_read(value: float) -> str:
    """Return a number that was read: to a hundredth, finer than which hardly an instrument reads."""
    return figure(value) if abs(value) >= _LONG else to_decimals(value, 2)


def to_decimals(value: float, digits: int) -> str:
    """Return value with so many decimals."""
    shown = f"{value:,.{digits}f}".replace(",", _NARROW_SPACE)
    return _minus(decimals(shown.removeprefix("-") if float(f"{value:.{digits}f}") == 0 else shown))


def volume_words(summary: Summary) -> str:
    """Return over what travel the error of the volume is drawn, "" where it is not."""
    volume = summary.volume
    if volume is None:
        return ""
    told = {"axes": ", ".join(sorted(volume.axes)), "parked": volume.parked.replace(" deg", "°")}
    parked = "How the tool travels straight lines over the travel of {axes} with {parked}."
    alone = "How the tool travels straight lines over the travel of {axes}."
    return said(parked if volume.parked else alone, **told)


def left_out_words(block: Iso230) -> str:
    """Return which readings a test after ISO 230-2 does without, "" where it has all."""
    if not block.left_out:
        return ""
    numbers = joined([str(number) for number in block.left_out])
    return counted(
        "Without the run of reading {numbers}, which was not believed.",
        "Without the runs of readings {numbers}, which were not believed.",
        len(block.left_out),
        numbers=numbers,
    )


def curve_note(curve: CurveSummary) -> str:
    """Return in a line how well a curve is known now, 95 %, was before, and how much of that the readings did."""
    now, before = BAND * root_mean_square(curve.std), BAND * root_mean_square(curve.prior_std)
    size = quantity(now, curve.value_unit)
    if curve.from_readings < _TOUCHED:
        return said("±{now}, hardly touched by the readings", now=size)
    known = "±{now}, stated ±{before}; {share:.0%} from readings"
    return said(known, now=size, before=figure(before), share=float(curve.from_readings))


def constant_note(constant: ConstantSummary) -> str:
    """Return a constant as "12.10 ± 2.21 µrad" (95 %)."""
    return with_band(constant.mean, BAND * constant.std, constant.unit)


def with_band(value: float, half: float, unit: str) -> str:
    """Return a value and its ±, "12.10 ± 2.21 µrad": as many decimals as the ± has.  unit : "" for none"""
    shown, point = figure(half), decimals(".")
    band = quantity(half, unit) if unit else shown
    if half == 0 or "×" in shown or abs(value) >= _LONG:
        return f"{figure(value)} ± {band}"
    return f"{to_decimals(value, len(shown.partition(point)[2]))} ± {band}"


def constant_rows(summary: Summary) -> list[list[str]]:
    """Return name, words, estimate and band before measuring of each constant.

    Constants of set-ups in which nothing was read are left out, where anything was.
    """
    silent = tuple(f"{use.name}: " for use in summary.setups if summary.readings and not use.readings)
    return [
        [each.name, spelt(each.words), constant_note(each), f"± {quantity(BAND * each.prior_std, each.unit)}"]
        for each in summary.constants
        if not each.name.startswith(silent)
    ]


def approach_words(row: HistoryRow) -> str:
    """Return from which sides a place was come to: "X+ Y−"."""
    return _minus(row.approach)


def position_text(position: Position | None) -> str:
    """Return {"X": 120.0, "B": 30.0} as "X 120 · B 30"."""
    return "–" if position is None else " · ".join(f"{axis} {coordinate(v)}" for axis, v in position.items())


def position_heading(rows: Iterable[HistoryRow]) -> str:
    """Return what stands above positions, with the units that occur: of linear axes, of rotary ones or of both."""
    return heading_in({axis_unit(axis) for row in rows for axis in row.position or ()})


def heading_in(units: Collection[str]) -> str:
    """Return what stands above positions in "mm", in "deg", or in both."""
    if {*units} == {"deg"}:
        return said("position, °")
    return said("position, mm and °") if "deg" in units else said("position, mm")


def coordinate(value: float) -> str:
    """Return a coordinate to a thousandth, without trailing zeros."""
    text = f"{value:.3f}".rstrip("0").rstrip(".") if abs(value) < 1e9 else f"{value:.4g}"
    return _minus("0" if text == "-0" else decimals(text))


def iso_name(name: str) -> str:
    """Return the sign of an ISO 230-2 figure: A_up -> A↑."""
    return name.replace("_up", "↑").replace("_down", "↓").replace("_mean", f" {said('mean')}")


def axis_unit(axis: str) -> str:
    """Return the display unit of an axis' coordinate: A, B and C turn (ISO 841)."""
    return "deg" if axis[:1] in "ABC" else "mm"


def root_mean_square(values: ArrayLike) -> float:
    """Return the root of the mean square; 0 of no values.  values : of any shape"""
    sizes = np.abs(np.asarray(values, dtype=float))
    largest = float(sizes.max(initial=0.0))
    return largest * math.sqrt(np.sum((sizes / (largest or 1.0)) ** 2) / max(sizes.size, 1))


def _minus(text: str) -> str:
    return text.replace("-", "−")


_CAUSES = WORDS["type_b"]


def cause_words(name: str, owner: str) -> str:
    """Return a cause in words.  name : of its row; owner : the instrument or set-up that it belongs to, if any"""
    return said(_CAUSES[name], owner=said(owner) if owner else "")


def environment(written: Callable[[object], object] | None = None) -> Environment:
    """Return what renders templates.

    A name that has no value is a fault, and no value is markup. All functions here are filters.
    written : how a value is written, as markup, in a template that is not HTML
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined  # which no question needs

    made = Environment(
        loader=PackageLoader("axiscal.present"),
        optimized=False,  # a text that a filter says is said in the language of each rendering
        autoescape=True,
        undefined=StrictUndefined,
        finalize=written,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters |= {name: each for name, each in globals().items() if callable(each)} | {"capital": capital}
    made.globals |= {"said": said, "counted": counted, "language": spoken_now}
    return made
