"""Renishaw `.rtl`: a positioning test as laser software exports it, in sections `NAME::`.

Targets wrap over lines, indices count from 1, odd runs go up and even runs down unless the flags say that all go up.
Deviations are read as micrometres and targets as millimetres, for the file does not say. Angles differ from program to
program, so a rotary axis is refused where the axis is known.
"""

from __future__ import annotations

from collections.abc import Iterator

from axiscal.language.spoken import later, said
from axiscal.measurement.readers.csv_readings import RawReading, of_test
from axiscal.measurement.readers.csv_table import TextFile
from axiscal.units import from_unit

_ONE_WAY = "1"
_OTHERS = {
    "rta": (later("angles"), later("give its values as value_urad of READINGS.csv: they are in mm/m, 1000 urad each")),
    "rts": (
        later("straightness"),
        later("give its values as value_um of READINGS.csv, with a set-up that reads across"),
    ),
}
"""Files of the same form for other tests: why they are refused, and what to do."""
_SHORTENED = "export it again from the laser software; the file seems to be cut or edited"


def is_rtl(file: TextFile) -> bool:
    """Return whether the file begins like a `.rtl` file."""
    return next((line.strip() for line in file.lines if line.strip()), "") == "HEADER::"


def rtl_readings(file: TextFile) -> tuple[RawReading, ...]:
    """Return the readings of a `.rtl` file; raises ReadingError."""
    sections = dict(_sections(file))
    for line, text in sections.get("HEADER", []):
        kind = text.partition(":")[2].strip().lower()
        if text.lower().startswith("file type") and kind in _OTHERS:
            what = "this is a test of {kind} (File type : {type}), not of positioning"
            raise file.fail(what, _OTHERS[kind][1], line, kind=said(_OTHERS[kind][0]), type=kind)
    targets, one_way = _targets(file, sections)
    rows: dict[tuple[int, int], RawReading] = {}
    for line, text in _deviations(file, sections):
        run, index, row = _row(file, line, text, targets, one_way)
        if (run, index) in rows:
            what = "run {run} has target {index} already, in line {earlier}"
            raise file.fail(what, "keep one of the two", line, run=run, index=index, earlier=rows[run, index].line)
        rows[run, index] = row
    if not rows:
        raise file.fail("there are no deviations", _SHORTENED)
    return tuple(rows.values())


def _sections(file: TextFile) -> Iterator[tuple[str, list[tuple[int, str]]]]:
    """Yield the lines of each section with their numbers; empty lines are left out."""
    name, lines = "", list[tuple[int, str]]()
    for number, line in enumerate(file.lines, 1):
        text = line.strip()
        if text.endswith("::"):
            yield name, lines
            name, lines = text[:-2].strip().upper(), []
        elif text:
            lines.append((number, text))
    yield name, lines


def _targets(file: TextFile, sections: dict[str, list[tuple[int, str]]]) -> tuple[list[float], bool]:
    """Return the targets in m, and whether all runs go up."""
    lines = sections.get("TARGET DATA")
    if lines is None:
        raise file.fail("there is no section TARGET DATA::", _SHORTENED)
    stated, targets, one_way, inside = None, list[float](), False, False
    for number, text in lines:
        key, colon, rest = text.partition(":")
        if colon:
            inside = key.strip().lower() == "targets"
            if key.strip().lower() == "target-count":
                stated = (number, rest.strip())
            if key.strip().lower() == "flags":
                one_way = rest.split()[1:2] == [_ONE_WAY]
            text = rest
        if inside:
            targets += [from_unit(file.number(word, "target", number), "mm") for word in text.split()]
    if not targets:
        raise file.fail("there are no targets", _SHORTENED, lines[0][0] if lines else None)
    if stated is not None and stated[1] != str(len(targets)):
        what = "{stated} targets are announced, and there are {count}"
        raise file.fail(what, _SHORTENED, stated[0], stated=stated[1], count=len(targets))
    if len(set(targets)) < len(targets):
        raise file.fail("a target is named twice", "name each once", lines[0][0])
    return targets, one_way


def _deviations(file: TextFile, sections: dict[str, list[tuple[int, str]]]) -> list[tuple[int, str]]:
    lines = sections.get("DEVIATIONS")
    if lines is None:
        raise file.fail("there is no section DEVIATIONS::", _SHORTENED)
    return [(number, text) for number, text in lines if not text.lower().startswith("run target data")]


def _row(file: TextFile, line: int, text: str, targets: list[float], one_way: bool) -> tuple[int, int, RawReading]:
    words = text.split()
    if len(words) != 3 or not (words[0].isdecimal() and words[1].isdecimal()):
        raise file.fail("{text!r} is not run, target and deviation", _SHORTENED, line, text=text[:40])
    run, index = int(words[0]), int(words[1])
    if run < 1 or not 1 <= index <= len(targets):
        what = "target {index} of run {run} is not there: targets go from 1 to {count}"
        raise file.fail(what, _SHORTENED, line, index=index, run=run, count=len(targets))
    direction = 1 if one_way or run % 2 == 1 else -1
    deviation = from_unit(file.number(words[2], "deviation", line), "um")
    number = run if one_way else (run + 1) // 2
    return run, index, of_test(targets[index - 1], direction, number, deviation, "length", line)
