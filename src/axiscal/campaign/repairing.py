"""A new record of what stands whole in damaged ones and in copies that went on apart. What is missing is named."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

from axiscal.campaign.possible import Possible
from axiscal.document.consent import asking
from axiscal.estimation.inheritance import created_description
from axiscal.exceptions import CodeError, NewerError, RecordError
from axiscal.language.spoken import counted, said
from axiscal.record.accepted import Accepted
from axiscal.record.earlier import UNPROVEN
from axiscal.record.events import (
    Created,
    Event,
    EventOrderError,
    Finished,
    Folding,
    Lost,
    Newer,
    Noted,
    Recorded,
    Signed,
    State,
    Stored,
    Undone,
)
from axiscal.record.lines import EMPTY, EventText, Line, entry
from axiscal.record.payload import PayloadError, decode, encode, hand_of
from axiscal.record.repair import SeveralError, Union, united
from axiscal.record.store import Record, content_of_lines, refuse_existing, said_hand
from axiscal.record.story import rows_of, signed_by

_MOST = 20
"""So many stretches and entries are listed in the note; all are printed."""


@dataclass(frozen=True, slots=True)
class Repaired:
    """What came back.

    state : of the new record; entries : of the old ones that it has
    missing, left : sentences on entries that do not stand whole, and on those that do and are not used
    """

    state: State
    entries: int
    missing: tuple[str, ...]
    left: tuple[str, ...]


class _TakenBackError(Exception):
    """The event of this number must have been taken back by one that is missing."""


def repaired(
    paths: Sequence[Path],
    new: Path,
    asked: Callable[[str], bool],
    *,
    beginning: Created | None = None,
    campaign: str = "",
) -> Repaired:
    """Write a new record of the union of others, each event under its own number; they stay as they are.

    asked : whether readings are taken in of which somebody has to say that they count
    beginning : the first event, where it is lost; campaign : the first digits of its id, where there are several
    Raises RecordError, also where there is something at `new`.
    """
    refuse_existing(new)
    try:
        found = united((path.read_bytes() for path in paths), campaign)
    except SeveralError as several:
        raise _not_one(several, paths[0]) from None
    trunk = dict(found.trunk)
    if beginning is not None and 1 not in trunk:
        trunk |= {1: entry(rows_of([beginning]), next(iter(trunk.values())).campaign, "")[0]}
    left = list[str]()
    unproven = {number: line for number, line in trunk.items() if line.writer == UNPROVEN}
    if unproven and not asked(_unproven_words(unproven)):
        left.append(_unproven_words(unproven))
        trunk = {number: line for number, line in trunk.items() if number not in unproven}
    rows, folding, possible = _told(trunk, paths[0], left)
    if folding.created is None:
        what = "Event 1, with the descriptions, does not stand whole; {kept} readings stand"
        remedy = "Name a copy of the record by `axiscal data merge`, or its campaign.toml: --beginning FILE"
        raise RecordError(what, remedy, paths[0], kept=sum(line.row.kind == "recorded" for line in trunk.values()))
    rows += _taken_in(found, folding, possible, asked, left)
    missing = tuple(_missing_words(trunk, found))
    told = [*missing, *left]
    more = [f"and {len(told) - _MOST} more"] if len(told) > _MOST else []
    listed = "; ".join([*told[:_MOST], *more]) or "nothing"
    names = " and ".join(path.name for path in paths)
    rows += rows_of([Noted(f"repaired from {names}, {len(trunk)} events. Missing: {listed}")])
    with Record.made(new, content_of_lines(_chained(trunk, rows))) as record:
        return Repaired(record.state(), len(trunk), missing, tuple(left))


def _not_one(several: SeveralError, path: Path) -> RecordError:
    if not several.lines:
        remedy = "Name a record that `axiscal step start` or `axiscal step run` has made, or restore it from a copy"
        return RecordError("No entry of a record stands whole here", remedy, path)
    listed = ", ".join(f"{name[:8]} ({count})" for name, count in several.lines.items())
    what = "Lines of several campaigns stand here: {listed}"
    return RecordError(what, "Name the one that you mean, such as --campaign {name}", path, listed=listed, name="1a2b")


def _unproven_words(lines: Mapping[int, Line]) -> str:
    form = said("a record of an earlier form does not say whose the lines behind a gap are")
    one, many = "{count} line from event {first} on", "{count} lines from event {first} on"
    return f"{form}: {counted(one, many, len(lines), first=min(lines))}"


def _told(trunk: Mapping[int, Line], path: Path, left: list[str]) -> tuple[list[EventText], Folding, Possible | None]:
    """Return the events of all numbers, those that are lost or cannot be as `Lost`; adds why to `left`."""
    taken_back = dict[int, str]()
    while True:
        why = dict(taken_back)
        try:
            rows, folding, possible = _followed(trunk, why, path)
        except _TakenBackError as must:
            taken_back[must.args[0]] = said("what follows shows that it was taken back")
        else:
            left += [f"event {number} ({trunk[number].row.kind}): {each}" for number, each in sorted(why.items())]
            return rows, folding, possible


def _followed(
    trunk: Mapping[int, Line], left: dict[int, str], path: Path
) -> tuple[list[EventText], Folding, Possible | None]:
    folding, rows, possible, whole = Folding(), list[EventText](), None, True
    for number in range(1, max(trunk) + 1):
        line = trunk.get(number)
        if line is not None and number not in left:
            row, event = line.row, _event(line.row)
            if isinstance(event, Newer) and event.of_readings:
                what = "Event {number} is an entry of a newer version: {kind}"
                raise NewerError(what, "Repair it with that one", path, number=number, kind=event.kind)
            why = _unfit(event, row, rows, whole, possible)
            try:
                if not why and not isinstance(event, str):
                    folding.add(Stored(number, row.at, event))
            except EventOrderError as fault:
                last = folding.undo[-1].number if folding.undo else 0
                behind = folding.finished is not None or (isinstance(event, Undone) and event.event < last)
                if not whole and last and behind:
                    raise _TakenBackError(last) from None
                why = str(fault)
            if not why and not isinstance(event, str):
                possible = _possible(event) if number == 1 else possible and possible.after(event)
                rows.append(row)
                continue
            left[number] = why
        whole = False
        lost = Lost(left.get(number, "not whole"))
        rows.append(EventText(rows[-1].at if rows else _first(trunk).at, *encode(lost)))
        if folding.created is not None:
            folding.add(Stored(number, rows[-1].at, lost))
    return rows, folding, possible


def _first(trunk: Mapping[int, Line]) -> EventText:
    return next(iter(trunk.values())).row


def _event(row: EventText) -> Event | str:
    try:
        return decode(row.kind, row.payload)
    except PayloadError as error:
        return str(error)


def _unfit(
    event: Event | str, row: EventText, before: Sequence[EventText], whole: bool, possible: Possible | None
) -> str:
    """Return why a whole entry cannot stand where others are missing, "" where it can."""
    if isinstance(event, str):
        return event
    if isinstance(event, Accepted) and not whole:
        return said("what it puts right may be missing; accept it anew")
    if isinstance(event, Signed) and not (whole and signed_by(row, event, before)[1]):
        return said("it answers for what is missing, or was changed; sign anew")
    return possible.fault(event) if possible is not None else ""


def _possible(created: Event) -> Possible | None:
    """Return what can be on the machine of a campaign; None where only code of somebody's could tell."""
    with suppress(CodeError), asking(None):
        return Possible.at_start(created_description(created)) if isinstance(created, Created) else None
    return None


def _taken_in(
    found: Union, folding: Folding, possible: Possible | None, asked: Callable[[str], bool], left: list[str]
) -> list[EventText]:
    """Return the readings of branches that a person wants, to come last; adds the others to `left`."""
    taken = list[EventText]()
    for every in found.branches:
        branch = [line for line in every if line.last <= every[-1].number]
        if not branch:
            left.append(said("event {number}: of an entry that nobody has finished", number=every[0].number))
            continue
        readings = [row for row in _readings(branch) if possible is None or not possible.fault(decode(*row[1:]))]
        number, by = branch[0].number - 1, said_hand(branch[0].row)
        words = counted(
            "two went on from event {number}: {count} reading of {by} stands beside",
            "two went on from event {number}: {count} readings of {by} stand beside",
            len(readings),
            number=number,
            by=by,
        )
        if readings and asked(words):
            taken += readings
        else:
            left.append(words)
    if taken and folding.finished is not None:
        end = next(each.number for each in reversed(folding.undo) if isinstance(each.event, Finished))
        return [*rows_of([Undone(end)]), *taken]
    return taken


def _readings(branch: Sequence[Line]) -> Iterator[EventText]:
    """Yield the readings that a branch leaves standing, without numbers: others may have been given the same."""
    standing = list[EventText | None]()
    for line in branch:
        event = _event(line.row)
        if isinstance(event, Recorded):
            free = Recorded(replace(event.reading, number=None))
            standing.append(line.row._replace(payload=encode(free, hand_of(line.row.payload))[1]))
        elif isinstance(event, Undone) and standing:
            standing.pop()  # which is what came last of what can be taken back
        elif line.row.kind in ("skipped", "accepted", "warmed", "finished"):
            standing.append(None)
    return filter(None, standing)


def _chained(trunk: Mapping[int, Line], rows: Sequence[EventText]) -> list[Line]:
    """Return lines of all events: as they were written up to the first that is lost or changed, then in one entry."""
    whole = 0
    while whole + 1 in trunk and trunk[whole + 1].row == rows[whole] and trunk[whole + 1].follows(trunk.get(whole)):
        whole += 1
    while whole and trunk[whole].last > whole:
        whole -= 1
    kept = [trunk[number] for number in range(1, whole + 1)]
    campaign = next(iter(trunk.values())).campaign
    return [*kept, *entry(rows[whole:], campaign, "", whole, kept[-1].hash if kept else EMPTY)]


def _missing_words(trunk: Mapping[int, Line], found: Union) -> Iterator[str]:
    for before, number in pairwise([0, *sorted(trunk), max(found.least, max(trunk)) + 1]):
        if number - before == 2:
            yield f"event {before + 1}"
        elif number - before > 2:
            yield f"events {before + 1} to {number - 1}"
    for name, count in found.others.items():
        yield f"{count} lines of another campaign, {name[:8]}"
