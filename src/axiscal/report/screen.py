"""The last screen of a command: at most 14 lines of 80 columns, from an answer and nothing else."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from axiscal.description.wants import Kind
from axiscal.language.spoken import counted, later, listed, put, said
from axiscal.report.answer import Aim, Answer, AnswerRow, Verdict
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
class Shown:
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


def screen(answer: Answer, shown: Shown) -> str:
    """Return the screen in the language that is spoken."""
    silent = [row for row in answer.rows if not row.measured]
    first, last = list(_first(answer, shown)), [*_agreeing(shown), *_silent(silent), *_ending(shown)]
    rows = [] if shown.withheld else [row for row in answer.rows if row.measured]
    fewer = [[row] for row in rows]
    if len(first) + len(fewer) + len(last) + 1 > LINES:
        fewer = _by_kind(rows)
    return "\n".join([*first, *_table(fewer), *last])


def _first(answer: Answer, shown: Shown) -> Iterator[str]:
    """Yield what became of what was asked for, with the readings and minutes it took."""
    if answer.verdict == "more":
        minutes = math.ceil(answer.more_minutes)
        verdict = counted(
            "{count} MORE READING, {minutes} MIN", "{count} MORE READINGS, {minutes} MIN", answer.more, minutes=minutes
        )
    else:
        verdict = said(_VERDICTS[answer.verdict])
    taken = counted("{count} reading", "{count} readings", shown.readings)
    minutes = _digits(answer.minutes)
    time = said("{minutes} min", minutes=minutes) if answer.clocked else said("{minutes} min planned", minutes=minutes)
    aims = "" if answer.verdict == "contradict" else _aims(answer)
    spent = put("{taken}, {time}", taken=taken, time=time)
    whole = "   ".join(part for part in (verdict, aims, spent) if part)
    yield from [whole] if len(whole) <= WIDTH else [verdict, "   ".join(part for part in ("", aims, spent) if part)[1:]]


def _aims(answer: Answer) -> str:
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


def _table(rows: Sequence[Sequence[AnswerRow]]) -> Iterator[str]:
    """Yield a header and a line for each group of rows of one kind."""
    if not rows:
        return
    controls = list(dict.fromkeys(name for group in rows for row in group for name in row.left))[:_LEFT]
    lefts = [said("left: {control}", control=name) if number == 0 else name for number, name in enumerate(controls)]
    cells = [["", said("found"), said("known to"), *lefts]]
    cells += [[_names(group), _found(group), _known(group), *_left(group, controls)] for group in rows]
    widths = [max(len(line[column]) for line in cells) for column in range(len(cells[0]))]
    for name, *others in cells:
        padded = [cell.rjust(width) for cell, width in zip(others, widths[1:], strict=True)]
        yield "   ".join([f"  {name.ljust(widths[0])}", *padded]).rstrip()


def _names(rows: Sequence[AnswerRow]) -> str:
    """Return a kind with the axes of all rows."""
    return said(_KINDS[rows[0].kind], axes=_axes(rows))


def _axes(rows: Sequence[AnswerRow]) -> str:
    if rows[0].kind == "straightness":
        if len(rows) > 1:
            return listed(" ", ["".join(row.axes) for row in rows])
        return said("{axis} in {other}", axis=rows[0].axes[0], other=rows[0].axes[1])
    return listed(" ", ["".join(row.axes) for row in rows])


def _found(rows: Sequence[AnswerRow]) -> str:
    low, high = (pick(row.found for row in rows) for pick in (min, max))
    if len(rows) == 1:
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


def _agreeing(shown: Shown) -> list[str]:
    found = shown.agreement
    if not found.count:
        return []
    if found.contradict:
        return textwrap.wrap(f"{found.words}.", WIDTH, max_lines=3, placeholder=" …")
    text = said("Readings agree: {agreeing} of {count}.", agreeing=found.agreeing, count=found.count)
    refused = counted("{count} left out.", "{count} left out.", shown.refused) if shown.refused else ""
    return [f"{text} {refused}".rstrip()]


def _silent(rows: Sequence[AnswerRow]) -> list[str]:
    """Return what is not measured, why, and what one reading would bring."""
    if not rows:
        return []
    parts = [put("{names} ({why})", names=_names(group), why=_why(group)) for group in _by_kind(rows)]
    text = said("Not measured: {rows}.", rows=listed(", ", parts))
    return textwrap.wrap(text, WIDTH, max_lines=3, placeholder=" …", break_on_hyphens=False)


def _why(rows: Sequence[AnswerRow]) -> str:
    then = [row.then for row in rows if row.then is not None]
    if then:
        size = put("± {size} {unit}", size=_digits(max(then)), unit=rows[0].unit)
        return said("one reading from the other side brings {size}", size=size)
    places = min(line.plus + line.minus - line.both for row in rows for line in row.lines)
    return counted("{count} place read", "{count} places read", places) if places else said("not read")


def _ending(shown: Shown) -> Iterator[str]:
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
