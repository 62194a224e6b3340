"""Renishaw `.rtl`, `.rta`, `.rts`: tests of positioning, angle and straightness of laser software, `NAME::` a section.

Targets wrap over lines, indices count from 1, odd runs go to the last target and even runs back unless the flags say
that all go there. Targets are in mm, positions in um, and angles in mm/m (one is 206.26 arcsec). A line `Units: um` of
the header or `--unit` says the unit of straightness, which programs export in um and in mm. It also says that of
deviations where the header says inch. Of a turning axis targets are in deg and deviations in arcsec.
"""

from __future__ import annotations

import re
from collections import Counter
from typing import Literal

from axiscal.language.spoken import said
from axiscal.measurement.readers.axis_tests import distinct
from axiscal.measurement.readers.columns import LENGTHS, unit_of
from axiscal.measurement.readers.csv_readings import Around, Found, RawReading, Test
from axiscal.measurement.readers.text_file import TextFile
from axiscal.units import from_unit

_Lines = list[tuple[int, str]]
_KINDS: dict[str, tuple[Test, str]] = {
    "rtl": ("positioning", "um"),
    "rta": ("angular", "mm/m"),
    "rts": ("straightness", ""),
}
"""By `File type`: which test, and the unit of its deviations, "" where the file says it."""
_UNITS = re.compile(r"(deviation )?units?\s*:\s*(.*)", re.IGNORECASE)
_TYPE = re.compile(r"file type\s*:\s*(.*)", re.IGNORECASE)
_NEEDED = ("TARGET DATA", "DEVIATIONS")
_OF_TARGETS = ("filetype", "target-count", "targets", "flags")
_DEVIATION = re.compile(r"([0-9]{1,6})\s+([0-9]{1,6})\s+(\S+)")
_SHORTENED = "export it again from the laser software; the file seems to be cut or edited"


def file_type(file: TextFile) -> str | None:
    """Return the type that a file of laser software states, rtl where it states none; None of another file."""
    if next((line.strip() for line in file.lines if line.strip()), "").upper() != "HEADER::":
        return None
    found = (_TYPE.fullmatch(line.strip()) for line in file.lines)
    return next((each[1].lower() for each in found if each), "rtl")


def laser_test(file: TextFile, around: Around) -> Found:
    """Return the readings of such a file; raises ReadingError."""
    kind = file_type(file)
    if kind not in _KINDS:
        what, known = "files of type {kind} are not known", ", ".join(_KINDS)
        raise file.fail(what, "known are {known}", 2, kind=str(kind)[:40], known=known)
    sections, (test, usual) = _sections(file), _KINDS[kind]
    targets, rotary, one_way = _targets(file, sections["TARGET DATA"])
    angles = rotary or test == "angular"
    along, unit, silent = _units(file, "arcsec" if rotary else usual, angles)
    at = [from_unit(target, "deg" if rotary else along) for target in targets]
    rises = 1 if at[-1] >= at[0] else -1
    dimension: Literal["length", "angle"] = "angle" if angles else "length"
    read = [(line, text) for line, text in sections["DEVIATIONS"] if not text.lower().startswith("run target data")]
    found, first = list[RawReading](), dict[int, int]()
    for line, text in read:
        if (whole := _DEVIATION.fullmatch(text)) is None:
            raise file.fail("{text!r} is not run, target and deviation", _SHORTENED, line, text=text[:40])
        run, index, value = int(whole[1]), int(whole[2]), file.number(whole[3], "deviation", line)
        if run < 1 or not 1 <= index <= len(at):
            what = "target {index} of run {run} is not there: targets go from 1 to {count}"
            raise file.fail(what, _SHORTENED, line, index=index, run=run, count=len(at))
        way, number = (1, run) if one_way else (1 if run % 2 else -1, (run + 1) // 2)
        if way * (index - first.setdefault(run, index)) < 0:
            what = "run {run} goes the other way than the flags say"
            remedy = "correct the flags, or export the file again: 0 there and back, 1 always there"
            raise file.fail(what, remedy, line, run=run)
        come, read_as = {"": way * rises}, from_unit(value, unit)
        found.append(RawReading("", {"": at[index - 1]}, come, read_as, None, dimension, line, test=test, run=number))
    every = distinct(file, found)
    _refuse_cut(file, sections, every)
    return Found(every, note=said("deviations in arcsec (it names no unit)") if rotary and silent else "")


def _units(file: TextFile, usual: str, angles: bool) -> tuple[str, str, bool]:
    """Return the units of targets and deviations, and whether the header names none; raises ReadingError for none.

    usual : of deviations, "" where the header or who reads the file says it; angles : that is what they are
    """
    found = [(number, each) for number, line in enumerate(file.lines, 1) if (each := _UNITS.fullmatch(line.strip()))]
    number, text, own = next(((at, each[2], each[1]) for at, each in found), (2, "", None))
    stated = unit_of(text) or ""
    if text and not stated:
        raise file.fail("{text} is no unit of deviations", "known are um, mm, in and arcsec", number, text=text[:20])
    inches = stated in ("in", "inch") and not own
    unit = "" if inches else stated if own or not usual or stated not in ("", "mm") else usual
    if unit and file.unit:
        raise file.fail("the file names its unit, and --unit names another", "leave --unit out", number)
    if not (unit or file.unit):
        raise file.fail("the file does not name the unit of its deviations", "say it: --unit um, mm or thou", number)
    unit = unit or file.unit
    if angles != (unit not in LENGTHS):
        remedy = "say another by --unit" if file.unit else "correct this line, or take it out"
        raise file.fail("{text} is no unit of this test", remedy, number, text=unit)
    return "in" if inches else "mm", unit, not text


def _sections(file: TextFile) -> dict[str, _Lines]:
    """Return the lines of each section with their numbers, empty ones left out, and decimal commas as points.

    Raises ReadingError for a section that stands there twice or is missing.
    """
    sections = {"": (lines := _Lines())}
    for number, line in enumerate(file.lines, 1):
        text = line.strip()
        if text.endswith("::"):
            name, lines = text[:-2].strip().upper(), []
            if name in sections:
                raise file.fail("section {name}:: stands here twice", "give each test by itself", number, name=name)
            sections[name] = lines
        elif text:
            lines.append((number, text))
    if lacking := [name for name in _NEEDED if name not in sections]:
        raise file.fail("there is no section {name}::", _SHORTENED, name=lacking[0])
    for lines in sections.values():
        if not any("." in text for _, text in lines):
            lines[:] = [(number, text.replace(",", ".")) for number, text in lines]
    return sections


def _targets(file: TextFile, lines: _Lines) -> tuple[list[float], bool, bool]:
    """Return the targets, whether they are angles, and whether all runs go to the last one."""
    words, rotary, key = {known: _Lines() for known in _OF_TARGETS}, False, ""
    for number, text in lines:
        begins, colon, rest = text.rpartition(":")
        key = begins.strip().lower() if colon else key
        turns = key == "filetype" and rest.strip().lower() == "rotary"
        if colon and (key not in words or (turns and file_type(file) != "rtl")):
            raise file.fail("{text!r} is not known here", "give the test of a linear axis", number, text=text[:40])
        rotary |= turns
        words.get(key, []).extend((number, word) for word in rest.split())
    targets = [file.number(word, "target", number) for number, word in words["targets"]]
    one_way = [word for _, word in words["flags"][1:2]] == ["1"]
    if not targets:
        raise file.fail("there are no targets", _SHORTENED, lines[0][0] if lines else None)
    for number, stated in words["target-count"]:
        if stated != str(len(targets)):
            what = "{stated} targets are announced, and there are {count}"
            raise file.fail(what, _SHORTENED, number, stated=stated[:40], count=len(targets))
    if len(set(targets)) < len(targets):
        raise file.fail("a target is named twice", "name each once", lines[0][0])
    return targets, rotary, one_way


def _refuse_cut(file: TextFile, sections: dict[str, _Lines], readings: tuple[RawReading, ...]) -> None:
    """Raise ReadingError where announced runs are missing, or the file has no end and its last run is short."""
    sizes = Counter((each.approach[""], each.run) for each in readings)
    for number, text in sections.get("RUNS", []):
        key, _, stated = (part.strip() for part in text.partition(":"))
        if key.lower() == "run-count" and stated != str(len(sizes)):
            what = "{stated} runs are announced, and there are {count}"
            raise file.fail(what, _SHORTENED, number, stated=stated[:40], count=len(sizes))
    if "EOF" not in sections and list(sizes.values())[-1] < max(sizes.values()):
        raise file.fail("the last run has fewer targets than others", _SHORTENED, readings[-1].line)
