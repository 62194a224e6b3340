"""An answer in words, in the language that is spoken: the first line, the rows as cells, sentences, commands."""

from __future__ import annotations

import shlex
import textwrap
from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import TypeVar

from axiscal.language.spoken import WORDS, counted, ending, joined, later, listed, put, said
from axiscal.present.answer import (
    Aim,
    AnswerRow,
    AnswerWords,
    NextStep,
    Outcome,
    PlannedAnswer,
    PlannedRow,
    TablesChecked,
)
from axiscal.present.row_words import (
    half_read_sentence,
    lacking,
    overruled_sentence,
    reason,
    row_names,
    said_row,
    screws_sentence,
    signed_text,
    signs_sentence,
)
from axiscal.tables.registry import exporter
from axiscal.units import digits
from axiscal_core.theta import MANY

_Row = TypeVar("_Row", bound=PlannedRow)
LINES, WIDTH, _CUT = 14, 80, " …"
"""Of a terminal that nobody scrolls."""
_LEFT = 2
"""Controls whose tables are shown beside each other."""
ROOM = 12
"""Rows beside each other; where there are more, those of one kind stand together."""
_ENDS: dict[str, str] = WORDS["verdicts"]
VERDICTS: dict[str, str] = WORDS["check"]["verdicts"]
_UNTOLD = later(
    "No check was read: finer detail, or backlash that differs from place to place, would not show. "
    "{many} readings, or checks = 3, test that."
)
_AIMS = WORDS["aims"]


def answer_text(answer: Outcome, agreement: str, evidence: str = "", *, cut: bool = False) -> AnswerWords:
    """Return an answer in words.

    agreement : said of readings that contradict or are not used; evidence : who answers for the record, "" for nobody
    cut : for a terminal
    """
    groups = measured_rows(answer, ROOM)
    found = [
        "" if cut else signs_sentence(groups),  # a terminal may have no room
        _agreement(answer, agreement),
        overruled_sentence(answer.overruled),
        said(_UNTOLD, many=MANY) if _unchecked(answer) else "",
        _unmeasured(answer, cut),
        _beside(answer),
        half_read_sentence(answer.half_read),
        screws_sentence(answer.screws),
        _best(answer),
        _checked(answer.checked),
        evidence,
    ]
    rows = table_lines(groups, controls_of(groups)) if groups else []
    return AnswerWords(first=_first_line(answer), rows=rows, sentences=[sentence for sentence in found if sentence])


def _first_line(answer: Outcome) -> list[str]:
    """Return what became of what was asked for, with the readings and minutes it took."""
    if answer.verdict == "more":
        coming = minutes_text(answer.more_minutes)
        verdict = counted(
            "{count} MORE READING, {coming} MIN", "{count} MORE READINGS, {coming} MIN", answer.more, coming=coming
        )
    else:
        unused = answer.readings and not answer.compared
        verdict = said(_ENDS["unused" if unused else "unchecked" if _unchecked(answer) else answer.verdict])
    taken = counted("{count} reading", "{count} readings", answer.readings)
    minutes = minutes_text(answer.minutes)
    time = said("{minutes} min" if answer.clocked else "{minutes} min by the plan", minutes=minutes)
    aims = "" if answer.verdict == "contradict" else aims_text(answer)
    return [part for part in (verdict, aims, put("{taken}, {time}", taken=taken, time=time)) if part]


def _unchecked(answer: Outcome) -> bool:
    """Return whether a target is reached by so few readings that none is a check."""
    return answer.verdict == "reached" and not answer.checks and answer.compared < MANY


def minutes_text(minutes: float) -> str:
    """Return minutes as each screen shows them, done or to come: whole and not less than one."""
    return put("{minutes:.0f}", minutes=max(minutes, 1.0) if minutes else 0.0)


def aims_text(answer: Outcome | PlannedAnswer) -> str:
    """Return the figure that decides: what no reading reaches, else what is missing, else the nearest."""
    aims = answer.aims
    volume = [aim for aim in aims if aim.name in _AIMS]
    best = [min(volume, key=lambda aim: aim.now / aim.limit)] if volume else []
    each = [*best, *(aim for aim in aims if aim.name not in _AIMS)]
    if not each:
        return ""
    missing = [aim for aim in each if not aim.reached]
    hopeless = [aim for aim in missing if not aim.reachable]
    farthest = max(hopeless or missing or each, key=lambda aim: aim.now / aim.limit)
    text = aim_text(farthest, answer.rows)
    if len(each) == 1:
        return text
    met = said("{met} of {count} limits", met=len(each) - len(missing), count=len(each))
    return put("{met}: {text}", met=met, text=text) if missing else met


def aim_text(aim: Aim, rows: Sequence[PlannedRow]) -> str:
    """Return how well a wanted accuracy is known, with its limit.  rows : of the answer"""
    sizes = {"now": digits(aim.now, aim.limit), "limit": limit_text(aim.limit), "unit": aim.unit}
    if aim.name in _AIMS:
        volume = next((row_names([row]) for row in rows if row.kind == "volume"), said_row("volume"))
        return said(_AIMS[aim.name], volume=volume, **sizes)
    if not aim.measured and aim.now <= aim.limit:  # known that well without: its figure would pass for reached
        return put("{name} {state}", name=said_row(aim.name), state=said("not measured"))
    return said("{name} {now} of {limit} {unit}", name=said_row(aim.name), **sizes)


def measured_rows(answer: Outcome, room: int) -> list[list[AnswerRow]]:
    """Return the rows that are measured, each by itself; those of one kind together where there are more than room."""
    rows = [row for row in answer.rows if row.measured]
    return [[row] for row in rows] if len(rows) <= room else by_kind(rows)


def controls_of(groups: Sequence[Sequence[AnswerRow]]) -> list[str]:
    """Return the controls whose tables the rows have, in their order."""
    return list(dict.fromkeys(name for group in groups for row in group for name in row.left))


def table_lines(
    groups: Sequence[Sequence[AnswerRow]], controls: Sequence[str], *, signs: bool = True, named: bool = True
) -> list[list[str]]:
    """Return the heading and a line for each group of rows: its name, found, U, what each control leaves.

    signs : rows that have signs are shown with them, else their sizes
    named : controls are; else what stands below names the one
    """
    lefts = [said("left with {control}", control=name) if number == 0 else name for number, name in enumerate(controls)]
    lefts = lefts if named else [said("left") for _ in controls]
    lines = [["", said("found"), "U (95 %)", *lefts]]
    for rows in groups:
        unit, found = rows[0].unit, (signed_text(rows) if signs else "") or _range(rows)
        left = [max((row.left[name] for row in rows if name in row.left), default=None) for name in controls]
        sizes = ("–" if size is None else put("{size} {unit}", size=digits(size), unit=unit) for size in left)
        lines.append([row_names(rows), found, known_text(rows), *sizes])
    return lines


def _range(rows: Sequence[AnswerRow]) -> str:
    """Return the sizes found of rows, from the smallest to the largest."""
    low, high = (digits(pick(row.found for row in rows)) for pick in (min, max))
    sizes = high if low == high else put("{low}-{high}", low=low, high=high)
    return put("{found} {unit}", found=sizes, unit=rows[0].unit)


def known_text(rows: Sequence[PlannedRow]) -> str:
    """Return U of the row that is known least, beside its limit where it is alone."""
    worst = max(rows, key=lambda row: row.known_to)
    if worst.limit is None or len(rows) > 1:
        return put("± {known} {unit}", known=digits(worst.known_to), unit=worst.unit)
    known, limit = digits(worst.known_to, worst.limit), limit_text(worst.limit)
    return said("± {known} of {limit} {unit}", known=known, limit=limit, unit=worst.unit)


def by_kind(rows: Sequence[_Row]) -> list[list[_Row]]:
    """Return rows of one kind and unit together, in the order of the first of each."""
    groups = dict[tuple[str, str], list[_Row]]()
    for row in rows:
        groups.setdefault((row.kind, row.unit), []).append(row)
    return list(groups.values())


def _agreement(answer: Outcome, words: str) -> str:
    """Return how many readings agree, "" before the first.  words : sentence where there is more to say"""
    if not answer.readings:
        return ""
    if answer.verdict == "contradict" or answer.left_out or answer.asks:
        return put("{words}.", words=words)
    agree = said("Readings agree: {agreeing} of {count}.", agreeing=answer.agreeing, count=answer.compared)
    if not answer.checks:
        return agree
    kept = said("Random places: {kept} of {count} as predicted.", kept=answer.as_promised, count=answer.checks)
    return put("{agree} {checks}", agree=agree, checks=kept)


def _unmeasured(answer: Outcome, cut: bool) -> str:
    """Return what is not measured, why, and what one reading would bring; "" for nothing.  cut : as far as lines go"""
    rows = [] if answer.verdict == "contradict" else [row for row in answer.rows if not row.measured]
    if not rows:
        return ""
    alike = groupby(sorted(rows, key=lacking), lacking)
    groups = [group for _, mine in alike for group in by_kind([*mine])]
    parts = [put("{names} ({why})", names=row_names(group), why=reason(group)) for group in groups]
    text = said("Not measured: {rows}.", rows=listed(", ", parts))
    for told in range(len(parts) - 1, 0, -1):
        if cut and wrapped(text)[-1].endswith(_CUT):
            more = said("{count} more", count=sum(map(len, groups[told:])))
            text = said("Not measured: {rows}.", rows=joined([*parts[:told], more]))
    return text


def _beside(answer: Outcome) -> str:
    """Return what pitch and yaw that nobody described add beside the line that was read; "" for nothing."""
    if answer.offset is None or not any(row.measured for row in answer.rows):
        return ""
    return said(
        "U is that of this line: each 100 mm beside it adds ± {size} um (pitch and yaw).", size=digits(answer.offset)
    )


def _best(answer: Outcome) -> str:
    """Return what endless readings leave of the limit that is missed most, where no number reaches it; else ""."""
    missed = [aim for aim in answer.aims if not aim.reached] if answer.verdict == "unreachable" else []
    if not missed:
        return ""
    worst = max(missed, key=lambda aim: aim.floor / aim.limit)
    return said("Best possible: {size} {unit}.", size=digits(worst.floor, worst.limit), unit=worst.unit)


def _checked(checked: TablesChecked | None) -> str:
    """Return what a check of the tables found; "" where there was none."""
    if checked is None:
        return ""
    verdict, farthest = said(VERDICTS[checked.verdict]), farthest_words(checked)
    return put("{sizes}: {verdict}. {farthest}", sizes=sizes_words(checked), verdict=verdict, farthest=farthest)


def sizes_words(checked: TablesChecked) -> str:
    """Return what a check found, and left beside what is to be expected."""
    sizes = {"found": digits(checked.found), "left": digits(checked.left), "expected": digits(checked.expected)}
    words = "{places} places checked: {found} um found, {left} left ({expected} expected)"
    return said(words, places=checked.places, **sizes)


def farthest_words(checked: TablesChecked) -> str:
    """Return where a check leaves most."""
    at = listed(", ", [put("{axis} {value:.9g}", axis=axis, value=value) for axis, value in checked.at.items()])
    return said("Farthest: {size} um, {place}.", size=digits(checked.farthest), place=at)


def commands_of(steps: Sequence[NextStep], file: str, results: str = "", readings: int = 0) -> Iterator[str]:
    """Yield what to do next, as it is typed.  file : a record or a campaign; readings : of a plan"""
    beside, record = f"{results}/" if results else "", shlex.quote(file)
    for step in steps:
        to, template = (f" --to {step.control}", template_of(step.control)) if step.control else ("", "")
        line = f"readings = {max(readings, 1)}"
        yield {
            "target": said('write "{line}" below [target] in {campaign}, then', line=line, campaign=file),
            "start": f"axiscal step start {record}",
            "load": said("load {folder} (README.txt there), then", folder=f"{beside}tables/{step.control}"),
            "next": f"axiscal step next {record} --beyond",
            "export": f"axiscal export {record}{to}{template or ' --on-top-of OLD'}",
            "undo": f"axiscal step undo {record}    # {said('takes the end back')}",
            "accept": f"axiscal step accept {record} {step.mistake}",
            "finish": f"axiscal finish {record} --out {shlex.quote(results or 'results')}",
        }.get(step.code, f"axiscal {step.code} {record}{to}{template}")


def template_of(control: str) -> str:
    """Return the option by which a control's own file is given, "" where its files are made from none."""
    return " --template FILE" if "--template" in exporter(control).takes else ""


def limit_text(value: float) -> str:
    """Return a limit as a person wrote it."""
    return put("{value:.3g}", value=value)


def screen(
    answer: Outcome,
    agreement: str,
    record: str,
    results: str,
    report: str = "",
    evidence: str = "",
    untabled: str = "",
) -> str:
    """Return the screen in the language that is spoken.

    agreement : said of readings that contradict or are not used; record, results : their paths
    report : path of the report, "" for none; evidence : who answers for the record
    untabled : why there is no table, "" where there is one
    """
    text = answer_text(answer, agreement, evidence, cut=True)
    first = first_lines(text.first)
    below = [line for sentence in [*text.sentences, untabled] for line in wrapped(sentence)]
    commands = list(commands_of(answer.steps, record, results))
    last = [*below, *ending({said("Next"): commands, said("Report"): [report] if report else []})]
    room = LINES - len(first) - len(last) - 1
    groups = measured_rows(answer, room)
    signs = wrapped(signs_sentence(groups))
    beside = signs if len(signs) <= room - len(groups) else []
    advised = next((step.control for step in answer.steps if step.control), "")
    return "\n".join([*first, *_table(groups, room, advised), *beside, *last])


def first_lines(parts: Sequence[str]) -> list[str]:
    """Return the first line, in two where one is too narrow."""
    whole = "   ".join(parts)
    return [whole] if len(whole) <= WIDTH else [parts[0], f"  {'   '.join(parts[1:])}"]


def _table(groups: Sequence[Sequence[AnswerRow]], room: int, advised: str) -> Iterator[str]:
    """Yield a header and a line for each group of rows, with as many controls as there is width for.

    room : lines below the header; the last group, the volume, stays where some have to go
    advised : the control whose tables are to be loaded; it stays where others have to go
    """
    if not groups:
        return
    hidden = 0
    if len(groups) > room:
        hidden = sum(map(len, groups[room - 2 : -1]))
        groups = [*groups[: room - 2], groups[-1]]
    controls = sorted(controls_of(groups), key=lambda name: name == advised)[-_LEFT:]
    last = controls[-1:]
    tried = [*((controls[count:], True, True) for count in range(_LEFT)), (last, True, False), (last, False, True)]
    shown = (
        columns(table_lines(groups, names, signs=signs, named=named))
        for names, signs, named in [*tried, ([], False, True)]
    )
    yield from next((lines for lines in shown if max(map(len, lines)) <= WIDTH), [])
    if hidden:
        yield counted("  … and {count} row in result.json", "  … and {count} rows in result.json", hidden)


def columns(shown: Sequence[Sequence[str]]) -> list[str]:
    """Return cells in columns, names to the left and figures to the right."""
    widths = [max(len(line[column]) for line in shown) for column in range(len(shown[0]))]
    lines = list[str]()
    for name, *others in shown:
        padded = [cell.rjust(width) for cell, width in zip(others, widths[1:], strict=True)]
        lines.append("   ".join([f"  {name.ljust(widths[0])}", *padded]).rstrip())
    return lines


def wrapped(sentence: str, most: int = 2) -> list[str]:
    """Return a sentence in so many lines at most."""
    lines = textwrap.wrap(sentence, WIDTH, max_lines=most, placeholder=_CUT, break_on_hyphens=False)
    return [line.replace("\xa0", " ") for line in lines]
