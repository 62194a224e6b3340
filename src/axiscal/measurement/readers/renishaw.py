"""Renishaw `.rtl`, `.rta`, `.rts`: tests of positioning, angle and straightness of laser software, `NAME::` a section.

Targets wrap over lines, indices count from 1, odd runs go up and even runs down unless the flags say that all go up.
Targets are in mm, positions in um, and angles in mm/m (one is 206.26 arcsec). Straightness is in the unit that a line
`Units: um` of the header names, else `--unit`: programs export it in um and in mm.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Literal

from axiscal.measurement.readers.axis_tests import distinct
from axiscal.measurement.readers.csv_readings import Around, Found, RawReading, Test
from axiscal.measurement.readers.text_file import TextFile
from axiscal.units import from_unit

_Lines = list[tuple[int, str]]
_ONE_WAY = "1"
_KINDS: dict[str, tuple[Test, str]] = {
    "rtl": ("positioning", "um"),
    "rta": ("angular", "mm/m"),
    "rts": ("straightness", ""),
}
"""By `File type`: which test, and the unit of its deviations, "" where the file says it."""
_UNITS = re.compile(r"(?:deviation )?units?\s*:\s*(.*?)\s*", re.IGNORECASE)
_LENGTHS = {
    "um": "um",
    "\N{MICRO SIGN}m": "um",
    "\N{GREEK SMALL LETTER MU}m": "um",
    "microns": "um",
    "mm": "mm",
    "in": "in",
}
_TYPE = re.compile(r"file type\s*:\s*(.*?)\s*", re.IGNORECASE)
_OF_TARGETS = ("filetype", "target-count", "targets", "flags")
_NUMBER = re.compile(r"[0-9]{1,6}")
_SHORTENED = "export it again from the laser software; the file seems to be cut or edited"


def file_type(file: TextFile) -> str | None:
    """Return the type that a file of laser software states, rtl where it states none; None of another file."""
    if next((line.strip() for line in file.lines if line.strip()), "") != "HEADER::":
        return None
    found = (_TYPE.fullmatch(line.strip()) for line in file.lines)
    return next((each[1].lower() for each in found if each), "rtl")


def laser_test(file: TextFile, around: Around) -> Found:
    """Return the readings of such a file; raises ReadingError."""
    sections = dict(_sections(file))
    kind = file_type(file)
    if kind not in _KINDS:
        what, known = "files of type {kind} are not known", ", ".join(_KINDS)
        raise file.fail(what, "known are {known}", 2, kind=str(kind)[:40], known=known)
    test, unit = _KINDS[kind]
    unit = unit or _stated_unit(file)
    dimension: Literal["length", "angle"] = "angle" if test == "angular" else "length"
    targets, one_way = _targets(file, _section(file, sections, "TARGET DATA"))
    lines = _section(file, sections, "DEVIATIONS")
    read = [(line, text) for line, text in lines if not text.lower().startswith("run target data")]
    rows = list[RawReading]()
    for line, text in read:
        run, index, value = _row(file, line, text, len(targets))
        way, number = (1, run) if one_way else (1 if run % 2 else -1, (run + 1) // 2)
        at, read_as = {"": targets[index - 1]}, from_unit(value, unit)
        rows.append(RawReading("", at, {"": way}, read_as, None, dimension, line, test=test, run=number))
    found = distinct(file, rows)
    _refuse_cut(file, sections, found)
    return Found(found)


def _stated_unit(file: TextFile) -> str:
    """Return the unit of lengths that the header names, or who reads it; raises ReadingError where nobody does."""
    found = [(number, each[1]) for number, line in enumerate(file.lines, 1) if (each := _UNITS.fullmatch(line.strip()))]
    for number, text in found:
        if text.lower() not in _LENGTHS:
            raise file.fail("{text} is no unit of a straightness", "known are um, mm and in", number, text=text[:20])
        if file.unit:
            raise file.fail("the header names its unit, and --unit names another", "leave --unit out", number)
        return _LENGTHS[text.lower()]
    if not file.unit:
        remedy = "say it: --unit um, or --unit mm"
        raise file.fail("a straightness test (.rts) does not name the unit of its deviations", remedy, 2)
    return file.unit


def _sections(file: TextFile) -> Iterator[tuple[str, _Lines]]:
    """Yield the lines of each section with their numbers; empty lines are left out."""
    name, lines = "", _Lines()
    for number, line in enumerate(file.lines, 1):
        text = line.strip()
        if text.endswith("::"):
            yield name, lines
            name, lines = text[:-2].strip().upper(), []
        elif text:
            lines.append((number, text))
    yield name, lines


def _section(file: TextFile, sections: dict[str, _Lines], name: str) -> _Lines:
    if name not in sections:
        raise file.fail("there is no section {name}::", _SHORTENED, name=name)
    return sections[name]


def _targets(file: TextFile, lines: _Lines) -> tuple[list[float], bool]:
    """Return the targets in m, and whether all runs go up."""
    stated, targets, one_way, key = None, list[float](), False, ""
    for number, text in lines:
        begins, colon, rest = text.partition(":")
        if colon:
            key, text = begins.strip().lower(), rest
            if key not in _OF_TARGETS or rest.strip().lower() == "rotary":
                raise file.fail(
                    "{text!r} is not known here", "give the test of a linear axis", number, text=f"{begins}:{rest}"[:40]
                )
        if key == "target-count":
            stated = (number, text.strip())
        if key == "flags":
            one_way = text.split()[1:2] == [_ONE_WAY]
        if key == "targets":
            targets += [from_unit(file.number(word, "target", number), "mm") for word in text.split()]
    if not targets:
        raise file.fail("there are no targets", _SHORTENED, lines[0][0] if lines else None)
    if stated is not None and stated[1] != str(len(targets)):
        what = "{stated} targets are announced, and there are {count}"
        raise file.fail(what, _SHORTENED, stated[0], stated=stated[1][:40], count=len(targets))
    if len(set(targets)) < len(targets):
        raise file.fail("a target is named twice", "name each once", lines[0][0])
    return targets, one_way


def _row(file: TextFile, line: int, text: str, targets: int) -> tuple[int, int, float]:
    """Return run, index of the target, and what was read."""
    words = text.split()
    if len(words) != 3 or not all(_NUMBER.fullmatch(word) for word in words[:2]):
        raise file.fail("{text!r} is not run, target and deviation", _SHORTENED, line, text=text[:40])
    run, index = int(words[0]), int(words[1])
    if run < 1 or not 1 <= index <= targets:
        what = "target {index} of run {run} is not there: targets go from 1 to {count}"
        raise file.fail(what, _SHORTENED, line, index=index, run=run, count=targets)
    return run, index, file.number(words[2], "deviation", line)


def _refuse_cut(file: TextFile, sections: dict[str, _Lines], readings: tuple[RawReading, ...]) -> None:
    """Raise ReadingError where announced runs are missing, or the file has no end and its last run is short."""
    sizes = dict[tuple[int, int], int]()
    for each in readings:
        sizes[each.approach[""], each.run] = sizes.get((each.approach[""], each.run), 0) + 1
    for number, text in sections.get("RUNS", []):
        key, _, stated = (part.strip() for part in text.partition(":"))
        if key.lower() == "run-count" and stated != str(len(sizes)):
            what = "{stated} runs are announced, and there are {count}"
            raise file.fail(what, _SHORTENED, number, stated=stated[:40], count=len(sizes))
    if "EOF" not in sections and list(sizes.values())[-1] < max(sizes.values()):
        raise file.fail("the last run has fewer targets than others", _SHORTENED, readings[-1].line)
