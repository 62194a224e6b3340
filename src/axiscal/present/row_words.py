"""Rows in words: their names, and numbers that have a sign, such as "Y +121 ± 3, Z −69 ± 3 um"."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from axiscal.description.target import Kind
from axiscal.language.spoken import WORDS, counted, joined, listed, put, quoted, said
from axiscal.present.answer import AnswerRow, PlannedRow, ScrewTurn, SignedNumber
from axiscal.units import digits

_KINDS: dict[Kind, str] = WORDS["rows"]
_ABOVE: dict[Kind, str] = WORDS["signs"]
_TWO = 0.3
"""Of a power of ten: below it U has two digits, so that rounding moves it by 5 % at most, else one (GUM 7.2.6)."""
_TOLD = 0.9
"""Of the U before the first reading: what is known no better was not read. Of U: what endless readings leave too."""


def row_name(kind: Kind, axes: Sequence[Sequence[str]]) -> str:
    """Return a kind with the axes of all rows; of several straightnesses the axes that move."""
    if kind == "straightness" and len(axes) == 1:
        text = said("{axis} in {other}", axis=axes[0][0], other=axes[0][1])
    elif kind == "straightness":
        text = listed(" ", list(dict.fromkeys(each[0] for each in axes)))
    else:
        text = listed(" ", ["".join(each) for each in axes])
    return said(_KINDS[kind], axes=text)


def row_names(rows: Sequence[PlannedRow]) -> str:
    """Return the name of rows of one kind; of a volume that is a line, that."""
    if rows[0].kind == "volume" and any(line.at for line in rows[0].lines):
        line = rows[0].lines[0]
        at = [put("{axis} {value:.6g}", axis=axis, value=value) for axis, value in line.at.items()]
        return said("{axis} on the line {at}", axis=line.axis, at=listed(", ", at))
    return row_name(rows[0].kind, [row.axes for row in rows])


def said_row(name: str) -> str:
    """Return a row as a person reads it.  name : as a person writes it"""
    kind, _, axes = name.partition(" ")
    words = next(words for each, words in _KINDS.items() if each == kind)
    return said(words, axes=axes.removeprefix("of "))


def signed_text(rows: Sequence[AnswerRow]) -> str:
    """Return the numbers of rows of one kind, each of a vector that stands alone with its own U; "" without a sign."""
    named = any(each.direction != "".join(row.axes) for row in rows for each in row.signed)
    bands = len(rows) == 1 < len(rows[0].signed)
    texts = [listed(", ", [_number(each, named=named, band=bands) for each in row.signed]) for row in rows]
    numbers = listed("; " if named else ", ", texts)
    return put("{numbers} {unit}", numbers=numbers, unit=rows[0].unit) if any(texts) else ""


def signs_sentence(groups: Sequence[Sequence[AnswerRow]]) -> str:
    """Return what is above zero in groups of rows, "" where that goes without saying."""
    kinds = [kind for kind in _ABOVE if any(row.kind == kind and row.signed for rows in groups for row in rows)]
    return said("Signs: {kinds}.", kinds=listed("; ", [said(_ABOVE[kind]) for kind in kinds])) if kinds else ""


def lacking(row: AnswerRow) -> tuple[bool, bool, bool]:
    """Return what a row has not: places of one side alone, any place of its own, what readings could tell."""
    return not one_sided(row), not _read(row), _exhausted(row)


def one_sided(row: AnswerRow) -> bool:
    """Return whether a row is a backlash that was read from one side alone, or from both at no one place."""
    return row.kind == "backlash" and not row.measured and _read(row) > 0 and not row.lines[0].places["both"]


def _exhausted(row: AnswerRow) -> bool:
    return row.floor >= _TOLD * row.known_to


def _read(row: AnswerRow) -> int:
    return min((line.read for line in row.lines), default=0)


def reason(rows: Sequence[AnswerRow]) -> str:
    """Return why rows of one kind are not measured."""
    if any(map(one_sided, rows)):
        apart = any(line.places["+"] and line.places["-"] for row in rows for line in row.lines)
        return said("no place read from both sides") if apart else said("one side read")
    worst = max(rows, key=lambda row: row.known_to)
    places = _read(worst)
    aimed = places and any(line.setup for line in worst.lines)  # the angles of an axis show nothing of its centre
    if not aimed and worst.known_to >= _TOLD * worst.known_before:
        return said("not read")
    size = _within(worst.known_to, worst.unit)
    if not places:
        return said("not read; the other readings leave {size}", size=size)
    if _exhausted(worst):
        return said("more readings would leave as much: {size}", size=size)
    one, many = "{count} place read tells too little: {size}", "{count} places read tell too little: {size}"
    return counted(one, many, places, size=size)


def _within(size: float, unit: str) -> str:
    """Return a size that no line is broken in."""
    return put("±\xa0{size}\xa0{unit}", size=digits(size), unit=unit)


def _number(number: SignedNumber, *, named: bool, band: bool) -> str:
    places = _places(number.U or number.value)
    value = round(number.value, places)
    sign = "−" if value < 0 else "+" if value > 0 else ""
    shown = f".{max(places, 0)}f"
    text = put(f"{{sign}}{{value:{shown}}}", sign=sign, value=abs(value))
    known = put(f"± {{known:{shown}}}", known=round(number.U, places)) if band else ""
    parts = [number.direction if named else "", text, known]
    return listed(" ", [part for part in parts if part])


def _places(size: float) -> int:
    """Return after how many decimals a number ends that is known to a size; negative: before the point."""
    if size == 0:
        return 0
    power = math.floor(math.log10(abs(size)))
    return int(abs(size) < 10 ** (power + 1) * _TWO) - power


def screws_sentence(screws: Sequence[ScrewTurn]) -> str:
    """Return how far to turn the screws under a bed, as Klipper says it: CW hours:minutes of a clock; "" for none."""
    if not screws:
        return ""
    each = [
        put(
            "{screw} {way} {turns} ± {most}",
            screw=screw.screw,
            way="CW" if screw.turns >= 0 else "CCW",
            turns=_clock(abs(screw.turns)),
            most=_clock(screw.U),
        )
        for screw in screws
    ]
    return said("Bed screws, in turns as hours:minutes: {each}; the first one stays.", each=listed(", ", each))


def _clock(turns: float) -> str:
    hours, minutes = divmod(round(60 * turns), 60)
    return f"{hours:02d}:{minutes:02d}"


def half_read_sentence(parts: Mapping[str, tuple[float, float]]) -> str:
    """Return which axes were read over half of the volume or less; "" for none.  parts : mm or deg"""
    each = [
        said("{axis} {low:.4g} to {high:.4g}", axis=axis, low=low, high=high) for axis, (low, high) in parts.items()
    ]
    text = "Half of the volume or more was not read: no reading tests U beyond {read}."
    return said(text, read=joined(each)) if each else ""


def overruled_sentence(setups: Sequence[str]) -> str:
    """Return which set-ups were read although their test failed, "" for none."""
    what = "Taken all the same: the test at mounting {setups} failed. Mount it, pass the test and read again."
    return said(what, setups=listed(", ", [quoted(each) for each in setups])) if setups else ""
