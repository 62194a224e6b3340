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
_OF_TARGETS = ("filetype", "target-count", "targets", "flags")
_DEVIATION = re.compile(r"([0-9]{1,6})\s+([0-9]{1,6})\s+(\S+)")
_ANNOUNCED, _SHORTENED = (
    "{stated} {things} are announced, and there are {count}",
    "export it again from the laser software; the file seems to be cut or edited",
)


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
    of: Literal["length", "angle"] = "angle" if angles else "length"
    found, first = list[RawReading](), dict[int, int]()
    for line, text in sections["DEVIATIONS"]:
        if text.lower().startswith("run target data"):
            continue
        whole = _DEVIATION.fullmatch(text)
        if whole is None or int(whole[1]) < 1 or not 1 <= int(whole[2]) <= len(at):
            what = "{text!r} is not run, target and deviation: targets go from 1 to {count}"
            raise file.fail(what, _SHORTENED, line, text=text[:40], count=len(at))
        run, index, value = int(whole[1]), int(whole[2]), file.number(whole[3], "deviation", line)
        way, number = (1, run) if one_way else (1 if run % 2 else -1, (run + 1) // 2)
        if way * (index - first.setdefault(run, index)) < 0:
            what = "run {run} goes the other way than the flags say"
            remedy = "correct the flags, or export the file again: 0 there and back, 1 always there"
            raise file.fail(what, remedy, line, run=run)
        come, read_as = {"": way * rises}, from_unit(value, unit)
        found.append(RawReading("", {"": at[index - 1]}, come, read_as, None, of, line, test=test, run=number))
    every = distinct(file, found)
    sizes = Counter((each.approach[""], each.run) for each in every)
    for number, text in sections.get("RUNS", []):
        key, _, stated = (part.strip() for part in text.partition(":"))
        if key.lower() == "run-count" and stated != str(len(sizes)):
            raise file.fail(_ANNOUNCED, _SHORTENED, number, stated=stated[:40], things=said("runs"), count=len(sizes))
    if "EOF" not in sections and list(sizes.values())[-1] < max(sizes.values()):
        raise file.fail("the last run has fewer targets than others", _SHORTENED, every[-1].line)
    return Found(every, note=said("deviations in arcsec (it names no unit)") if rotary and silent else "")


def _units(file: TextFile, usual: str, angles: bool) -> tuple[str, str, bool]:
    """Return the units of targets and deviations, and whether the header names none; raises ReadingError for none.

    usual : of deviations, "" where the header or who reads the file says it; angles : that is what they are
    """
    found = [(number, each) for number, line in enumerate(file.lines, 1) if (each := _UNITS.fullmatch(line.strip()))]
    number, text, own = next(((at, each[2], each[1]) for at, each in found), (2, "", None))
    stated = unit_of(text) or ""
    inches = stated in ("in", "inch") and not own
    unit = "" if inches else stated if own or not usual or stated not in ("", "mm") else usual
    taken = unit or file.unit
    if bool(text) > bool(stated) or (taken and angles != (taken not in LENGTHS)):
        remedy = "known are um, mm, in, and arcsec of angles"
        raise file.fail("{text} is no unit of this test", remedy, number, text=file.unit or text[:20])
    if bool(unit) == bool(file.unit):
        remedy = "say --unit um, mm or thou where the file names none, else leave --unit out"
        raise file.fail("the unit of the deviations is to be said once", remedy, number)
    return "in" if inches else "mm", taken, not text


def _sections(file: TextFile) -> dict[str, _Lines]:
    """Return the lines of each section with their numbers, empty ones left out, and decimal commas as points.

    Raises ReadingError for a section that stands there twice or is missing.
    """
    sections, name = {"": _Lines()}, ""
    for number, text in enumerate(map(str.strip, file.lines), 1):
        if text.endswith("::"):
            name = text[:-2].strip().upper()
            if name in sections:
                raise file.fail("section {name}:: stands here twice", "give each test by itself", number, name=name)
            sections[name] = []
        elif text:
            sections[name].append((number, text))
    if lacking := [name for name in ("TARGET DATA", "DEVIATIONS") if name not in sections]:
        raise file.fail("there is no section {name}::", _SHORTENED, name=lacking[0])
    marks = {name: "." if any("." in text for _, text in lines) else "," for name, lines in sections.items()}
    return {name: [(n, text.replace(marks[name], ".")) for n, text in lines] for name, lines in sections.items()}


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
    for number, stated in words["target-count"]:
        if stated != str(len(targets)):
            at = {"stated": stated[:40], "things": said("targets"), "count": len(targets)}
            raise file.fail(_ANNOUNCED, _SHORTENED, number, **at)
    if not targets or len(set(targets)) < len(targets):
        raise file.fail("there are no targets, or one stands twice", _SHORTENED, lines[0][0] if lines else None)
    return targets, rotary, [word for _, word in words["flags"][1:2]] == ["1"]
