"""A plan in words, in the language that is spoken: a screen of at most 16 lines, and the list of its readings."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from axiscal.description.artefacts import unused_artefacts
from axiscal.description.campaign import CampaignDescription
from axiscal.language.spoken import counted, ending, listed, put, said
from axiscal.planning.helping import helping_words
from axiscal.present.answer import AnswerWords, PlannedAnswer, PlannedRow, ReachAnswer
from axiscal.present.answer_words import (
    ROOM,
    aim_text,
    aims_text,
    by_kind,
    columns,
    commands_of,
    first_lines,
    known_text,
    minutes_text,
    wrapped,
)
from axiscal.present.plan_answer import PlanAnswer
from axiscal.present.row_words import row_names
from axiscal.units import digits, um_text

LINES = 16
"""Of a terminal that nobody scrolls."""
_READ = 0.9
"""Share of the U before below which a plan measures a row."""


def plan_screen(answer: PlannedAnswer, campaign: str, files: Sequence[str] = ()) -> str:
    """Return the screen of a plan.  campaign : its file, or its record; files : that were written"""
    text, commands = plan_text(answer), list(commands_of(answer.steps, campaign, readings=answer.readings))
    above, below = first_lines(text.first), [line for sentence in text.sentences for line in wrapped(sentence, 3)]
    below += ending({said("Written"): files, said("Next"): commands})
    room = LINES - len(above) - len(below) - 1
    return "\n".join([*above, *columns(_cells(answer.rows, room)), *below])


def plan_text(answer: PlannedAnswer) -> AnswerWords:
    """Return a plan in words."""
    reach = "" if answer.reach is None else reach_text(answer.reach, answer.rows)
    sentences = [_mounted(answer), _fewer(answer), reach]
    found = [sentence for sentence in sentences if sentence]
    return AnswerWords(first=_first(answer), rows=_cells(answer.rows, ROOM), sentences=found)


def reach_text(reach: ReachAnswer, rows: Sequence[PlannedRow] = ()) -> str:
    """Return what cannot be reached with these set-ups, and which would help.  rows : of the plan"""
    missed = listed(", ", [aim_text(aim.model_copy(update={"now": aim.floor}), rows) for aim in reach.missed])
    text = said("Out of reach: endless readings leave {missed}.", missed=missed)
    return text if reach.helps is None else put("{text} {helps}", text=text, helps=helping_words(reach.helps))


def open_questions(description: CampaignDescription) -> list[str]:
    """Return what descriptions leave open besides a compensation that may be active."""
    open_yet = [unused_artefacts(description.text)]
    beside = (
        'How far does the probe of "{setup}" stand beside the nozzle? Write it as offset = ["-33 mm", "-46 mm", '
        '"0 mm"], from the nozzle; until then it is taken to stand at the nozzle, where no axis that rolls deceives it.'
    )
    open_yet += [said(beside, setup=name) for name in description.unsaid_offsets]
    return [question for question in open_yet if question]


def _first(answer: PlannedAnswer) -> list[str]:
    """Return what the readings reach, and the figure that decides where one is asked for."""
    minutes, aims = minutes_text(answer.minutes), aims_text(answer)
    if answer.verdict == "unreachable":
        readings = counted("{count} reading", "{count} readings", answer.readings)
        spent = put("{readings}, {time}", readings=readings, time=said("{minutes} min", minutes=minutes))
        return [said("CANNOT BE REACHED WITH THESE SET-UPS"), aims, spent]
    one, many = "{count} READING, {minutes} MIN", "{count} READINGS, {minutes} MIN"
    plan = counted(one, many, answer.readings, minutes=minutes)
    if answer.verdict == "planned":
        return [plan]
    return [said("REACHED BY {plan}" if answer.verdict == "reached" else "NOT REACHED BY {plan}", plan=plan), aims]


def _cells(rows: Sequence[PlannedRow], room: int) -> list[list[str]]:
    """Return a heading and the cells of so many lines at most; rows of one kind stand together where they are more."""
    groups = [[row] for row in rows] if len(rows) <= room else by_kind(rows)
    shown = [*groups[: room - 1], groups[-1]] if len(groups) > room else groups  # the volume stays
    return [["", said("U before"), said("U after")], *([row_names(each), *planned_figures(each)] for each in shown)]


def planned_figures(rows: Sequence[PlannedRow]) -> tuple[str, str]:
    """Return U of rows of one kind before the plan and after it, in words."""
    before = put("± {known} {unit}", known=digits(max(row.known_before for row in rows)), unit=rows[0].unit)
    read = all(row.measured or row.known_to < _READ * row.known_before for row in rows)
    return before, known_text(rows) if read else said("not measured")


def _mounted(answer: PlannedAnswer) -> str:
    """Return the set-ups in the order in which they are mounted."""
    if not answer.setups:
        return ""
    first, *others = answer.setups
    begin = counted('"{setup}" ({count} reading)', '"{setup}" ({count} readings)', first.readings, setup=first.setup)
    parts = [begin, *(said('"{setup}" ({count})', setup=each.setup, count=each.readings) for each in others)]
    mounted = said("Mount in turn: {setups}.", setups=listed(", ", parts))
    if not answer.checks:
        return mounted
    one, many = "{count} is a check, drawn at random.", "{count} are checks, drawn at random."
    return put("{mounted} {checks}", mounted=mounted, checks=counted(one, many, answer.checks))


def _fewer(answer: PlannedAnswer) -> str:
    """Return why a plan has fewer readings than it may have; "" where it has not, or they reach the limits."""
    if answer.allowed is None or answer.readings >= answer.allowed or answer.verdict in {"unreachable", "reached"}:
        return ""
    if answer.budget_minutes is None and answer.verdict == "short":  # its limit wants others yet
        return ""
    if answer.budget_minutes is not None:
        why = said("more do not fit into {minutes} min", minutes=put("{minutes:.4g}", minutes=answer.budget_minutes))
    else:
        why = said("no other reading is worth its time")
    return said("{planned} of {allowed} readings: {why}.", planned=answer.readings, allowed=answer.allowed, why=why)


def plan_list(answer: PlanAnswer) -> Iterator[str]:
    """Yield a line for each mounting and for each reading, and what no plan can beat."""
    moves, mounted = {each.setup: each.moves for each in answer.setups}, ""
    where = [
        ", ".join(f"{axis} = {point.position[axis]:.9g} {answer.units[axis]}" for axis in moves[point.setup])
        for point in answer.points
    ]
    come = [" ".join(axis + side for axis, side in point.approach.items()) for point in answer.points]
    wide, beside = (max((len(text) for text in texts), default=0) for texts in (where, come))
    for number, point in enumerate(answer.points):
        if point.setup != mounted:
            mounted = point.setup
            yield said('Set-up "{setup}"', setup=mounted)
        after = f"RMS {um_text(point.rms_um):>8}, {point.minutes:6.1f} min"
        check = "  " + said("check") if point.check else ""
        yield f"{number + 1:4}  {where[number]:{wide}}  {come[number]:{beside}}  {after}{check}"
    if answer.bound_rms_um is not None:
        readings = counted("{count} reading", "{count} readings", answer.readings)
        best, own = um_text(answer.bound_rms_um), um_text(answer.rms_um)
        what = "No plan of {readings} can reach a smaller RMS than {best}; this one reaches {own}."
        yield said(what, readings=readings, best=best, own=own)
