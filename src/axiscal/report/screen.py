"""The last screen of a command: at most 14 lines of 80 columns, from an answer and nothing else."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from axiscal.description.wants import Kind
from axiscal.language.spoken import counted, later, listed, put, said
from axiscal.report.answer import Aim, AnswerRow, ResultAnswer, Verdict
from axiscal.report.promises import ReadingAgreement

LINES, WIDTH = 14, 80
"""Of a terminal that nobody scrolls."""
_LEFT = 2
"""Controls whose tables are shown beside each other."""
_NEAR = 0.1
"""Share of a limit within which a number has three digits."""
_KINDS: dict[Kind, str] = {
    "positioning": later("positioning {axes}"),
    "backlash": later("backlash {axes}"),
    "straightness": later("straightness {axes}"),
    "pitch": later("pitch {axes}"),
    "yaw": later("yaw {axes}"),
    "roll": later("roll {axes}"),
    "squareness": later("squareness {axes}"),
    "centre": later("centre of {axes}"),
    "tilt": later("tilt of {axes}"),
    "volume": later("volume"),
}
_VERDICTS: dict[Verdict, str] = {
    "measured": later("MEASURED"),
    "reached": later("TARGET REACHED"),
    "unreachable": later("CANNOT BE REACHED WITH THESE SET-UPS"),
    "contradict": later("READINGS CONTRADICT"),
    "nothing": later("NO READINGS YET"),
}
_AIMS = {
    "rms": later("volume {now} of {limit} {unit} RMS"),
    "worst": later("worst place {now} of {limit} {unit}"),
    "U": later("volume {now} of {limit} {unit}"),
}


@dataclass(frozen=True, slots=True)
class ScreenContext:
    """What a screen shows beside the answer.

    readings : number taken; refused : of them left out; withheld : no uncertainty is printed
    commands : what to do next, each line as it is typed; report : path of the report, "" for none
    """

    readings: int
    refused: int
    agreement: ReadingAgreement
    withheld: bool
    commands: Sequence[str]
    report: str = ""


def screen(answer: ResultAnswer, shown: ScreenContext) -> str:
    """Return the screen in the language that is spoken."""
    silent = [] if shown.agreement.contradict else [row for row in answer.rows if not row.measured]
    first, last = list(_first(answer, shown)), [*_agreeing(shown), *_silent(silent), *_ending(shown)]
    room = LINES - len(first) - len(last) - 1
    rows = [] if shown.withheld else [row for row in answer.rows if row.measured]
    groups = [[row] for row in rows] if len(rows) <= room else _by_kind(rows)
    return "\n".join([*first, *_table(groups, room), *last])


def _first(answer: ResultAnswer, shown: ScreenContext) -> Iterator[str]:
    """Yield what became of what was asked for, with the readings and minutes it took."""
    if answer.verdict == "more":
        coming = math.ceil(answer.more_minutes)
        verdict = counted(
            "{count} MORE READING, {coming} MIN", "{count} MORE READINGS, {coming} MIN", answer.more, coming=coming
        )
    else:
        verdict = said(_VERDICTS[answer.verdict])
    taken = counted("{count} reading", "{count} readings", shown.readings)
    minutes = _digits(max(answer.minutes, 1.0)) if answer.minutes else "0"
    time = said("{minutes} min", minutes=minutes) if answer.clocked else said("{minutes} min planned", minutes=minutes)
    aims = "" if answer.verdict == "contradict" else _aims(answer)
    spent = put("{taken}, {time}", taken=taken, time=time)
    whole = "   ".join(part for part in (verdict, aims, spent) if part)
    below = "   ".join(part for part in (aims, spent) if part)
    yield from [whole] if len(whole) <= WIDTH else [verdict, f"  {below}"]


def _aims(answer: ResultAnswer) -> str:
    """Return the figure that decides: of what is missing the farthest, else of what is reached the nearest."""
    volume = [aim for aim in answer.aims if aim.name in _AIMS]
    best = [min(volume, key=lambda aim: aim.now / aim.limit)] if volume else []
    each = [*best, *(aim for aim in answer.aims if aim.name not in _AIMS)]
    if not each:
        return ""
    missing = [aim for aim in each if not aim.reached]
    farthest = max(missing or each, key=lambda aim: aim.now / aim.limit)
    text = _aim(farthest)
    if len(each) == 1:
        return text
    met = said("{met} of {count} limits", met=len(each) - len(missing), count=len(each))
    return put("{met}: {text}", met=met, text=text) if missing else met


def _aim(aim: Aim) -> str:
    sizes = {"now": _digits(aim.now, aim.limit), "limit": _limit(aim.limit), "unit": aim.unit}
    if aim.name in _AIMS:
        return said(_AIMS[aim.name], **sizes)
    return put("{name} {now} / {limit} {unit}", name=aim.name, **sizes)


def _table(groups: Sequence[Sequence[AnswerRow]], room: int) -> Iterator[str]:
    """Yield a header and a line for each group of rows, with as many controls as there is width for.

    room : lines below the header; the last group, the volume, stays where some have to go
    """
    if not groups:
        return
    hidden = 0
    if len(groups) > room:
        hidden = sum(map(len, groups[room - 2 : -1]))
        groups = [*groups[: room - 2], groups[-1]]
    controls = list(dict.fromkeys(name for group in groups for row in group for name in row.left))[:_LEFT]
    lines = _lines(groups, controls)
    while controls and max(map(len, lines)) > WIDTH:
        controls = controls[1:]
        lines = _lines(groups, controls)
    yield from lines
    if hidden:
        yield counted("  … and {count} row in result.json", "  … and {count} rows in result.json", hidden)


def _lines(groups: Sequence[Sequence[AnswerRow]], controls: Sequence[str]) -> list[str]:
    lefts = [said("left: {control}", control=name) if number == 0 else name for number, name in enumerate(controls)]
    cells = [["", said("found"), said("known to"), *lefts]]
    cells += [[_names(group), _found(group), _known(group), *_left(group, controls)] for group in groups]
    widths = [max(len(line[column]) for line in cells) for column in range(len(cells[0]))]
    lines = list[str]()
    for name, *others in cells:
        padded = [cell.rjust(width) for cell, width in zip(others, widths[1:], strict=True)]
        lines.append("   ".join([f"  {name.ljust(widths[0])}", *padded]).rstrip())
    return lines


def _names(rows: Sequence[AnswerRow]) -> str:
    """Return a kind with the axes of all rows; of several straightnesses the axes that move."""
    if rows[0].kind == "straightness" and len(rows) == 1:
        axes = said("{axis} in {other}", axis=rows[0].axes[0], other=rows[0].axes[1])
    elif rows[0].kind == "straightness":
        axes = listed(" ", list(dict.fromkeys(row.axes[0] for row in rows)))
    else:
        axes = listed(" ", ["".join(row.axes) for row in rows])
    return said(_KINDS[rows[0].kind], axes=axes)


def _found(rows: Sequence[AnswerRow]) -> str:
    low, high = (pick(row.found for row in rows) for pick in (min, max))
    if _digits(low) == _digits(high):
        return put("{high} {unit}", high=_digits(high), unit=rows[0].unit)
    return put("{low}-{high} {unit}", low=_digits(low), high=_digits(high), unit=rows[0].unit)


def _known(rows: Sequence[AnswerRow]) -> str:
    worst = max(rows, key=lambda row: row.known)
    if worst.limit is None or len(rows) > 1:
        return put("± {known} {unit}", known=_digits(worst.known), unit=worst.unit)
    known, limit = _digits(worst.known, worst.limit), _limit(worst.limit)
    return said("± {known} of {limit} {unit}", known=known, limit=limit, unit=worst.unit)


def _left(rows: Sequence[AnswerRow], controls: Sequence[str]) -> list[str]:
    sizes = [max((row.left[name] for row in rows if name in row.left), default=None) for name in controls]
    return ["-" if size is None else put("{size} {unit}", size=_digits(size), unit=rows[0].unit) for size in sizes]


def _by_kind(rows: Sequence[AnswerRow]) -> list[list[AnswerRow]]:
    """Return rows of one kind and unit together, in the order of the first of each."""
    groups = dict[tuple[str, str], list[AnswerRow]]()
    for row in rows:
        groups.setdefault((row.kind, row.unit), []).append(row)
    return list(groups.values())


def _agreeing(shown: ScreenContext) -> list[str]:
    found = shown.agreement
    if not found.count:
        return []
    if found.contradict:
        return _wrapped(f"{found.words}.")
    text = said("Readings agree: {agreeing} of {count}.", agreeing=found.agreeing, count=found.count)
    refused = counted("{count} left out.", "{count} left out.", shown.refused) if shown.refused else ""
    return [f"{text} {refused}".rstrip()]


def _silent(rows: Sequence[AnswerRow]) -> list[str]:
    """Return what is not measured, why, and what one reading would bring."""
    if not rows:
        return []
    parts = [put("{names} ({why})", names=_names(group), why=_why(group)) for group in _by_kind(rows)]
    text = said("Not measured: {rows}.", rows=listed(", ", parts))
    return [line.replace("\xa0", " ") for line in _wrapped(text)]


def _wrapped(text: str) -> list[str]:
    """Return a sentence in two lines at most."""
    return textwrap.wrap(text, WIDTH, max_lines=2, placeholder=" …", break_on_hyphens=False)


def _why(rows: Sequence[AnswerRow]) -> str:
    then = [row.then for row in rows if row.then is not None]
    if then:
        return said("one reading from the other side: {size}", size=_within(max(then), rows[0].unit))
    places = min((line.plus + line.minus - line.both for row in rows for line in row.lines), default=0)
    if not places:
        return said("not read")
    size = _within(max(row.known for row in rows), rows[0].unit)
    return counted("{count} place read: {size}", "{count} places read: {size}", places, size=size)


def _within(size: float, unit: str) -> str:
    """Return a size that no line is broken in."""
    return put("±\xa0{size}\xa0{unit}", size=_digits(size), unit=unit)


def _ending(shown: ScreenContext) -> Iterator[str]:
    """Yield the commands under each other, and the report."""
    words = {said("Next"): shown.commands, said("Report"): [shown.report] if shown.report else []}
    width = max(len(word) for word in words)
    for word, lines in words.items():
        for number, line in enumerate(lines):
            yield f"{'' if number else word:{width}}  {line}"


def _limit(value: float) -> str:
    """Return a limit as a person wrote it."""
    return put("{value:.3g}", value=value)


def _digits(value: float, limit: float = math.inf) -> str:
    """Return a number with two digits, three where a limit is near, without an exponent."""
    digits = 3 if abs(value - limit) < _NEAR * limit < math.inf else 2
    if value == 0:
        return "0"
    places = digits - 1 - math.floor(math.log10(abs(float(f"{value:.{digits - 1}e}"))))
    return put(f"{{value:.{max(places, 0)}f}}", value=round(value, places))
