"""A new record of what stands whole in damaged ones and in copies that went on apart: the union of their lines.

Each line says its campaign, its number and the line before, so that nothing is inferred. What is missing has a number
and is named; two lines of one number are a branch, and a person says whether it counts.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

from axiscal.campaign.possible import Possible
from axiscal.description.campaign import description_of
from axiscal.document.consent import asking
from axiscal.exceptions import CodeError, InputError, NewerError, RecordError
from axiscal.language.spoken import counted, said
from axiscal.record.accepted import Accepted
from axiscal.record.door import refuse_existing
from axiscal.record.earlier import UNPROVEN, told_anew
from axiscal.record.events import (
    Created,
    Event,
    EventOrderError,
    Finished,
    Lost,
    Noted,
    Recorded,
    Signed,
    State,
    Stored,
    Undone,
    fold,
)
from axiscal.record.lines import EMPTY, HEAD, DamageError, EventText, KeptLine, counts, entry, whole_lines
from axiscal.record.payload import PayloadError, encode, stored
from axiscal.record.signing import hand_of, holds, rows_of
from axiscal.record.store import Record, content_of_lines, said_hand

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
    found = _united((path.read_bytes() for path in paths), campaign, paths[0])
    trunk, left = dict(found.trunk), list[str]()
    if beginning is not None and 1 not in trunk:
        trunk |= {1: entry(rows_of([beginning]), next(iter(trunk.values())).campaign, "")[0]}
    unproven = [number for number, line in trunk.items() if line.writer == UNPROVEN]
    if unproven:
        form = said("a record of an earlier form does not say whose the lines behind a gap are")
        one, many = "{count} line from event {first} on", "{count} lines from event {first} on"
        question = f"{form}: {counted(one, many, len(unproven), first=min(unproven))}"
        if not asked(question):
            left.append(question)
            trunk = {number: line for number, line in trunk.items() if number not in unproven}
    rows, story, possible = _told(trunk, paths[0], left)
    if story.created is None:
        what = "Event 1, with the descriptions, does not stand whole; {kept} readings stand"
        remedy = "Name a copy of the record by `axiscal data merge`, or its campaign.toml: --beginning FILE"
        raise RecordError(what, remedy, paths[0], kept=sum(line.row.kind == "recorded" for line in trunk.values()))
    rows += _taken_in(found, story, possible, asked, left)
    missing = tuple(_missing_words(trunk, found))
    told = [*missing, *left]
    more = [f"and {len(told) - _MOST} more"] if len(told) > _MOST else []
    listed = "; ".join([*told[:_MOST], *more]) or "nothing"
    names = " and ".join(path.name for path in paths)
    rows += rows_of([Noted(f"repaired from {names}, {len(trunk)} events. Missing: {listed}")])
    with Record.made(new, content_of_lines(_chained(trunk, rows)), like=paths[0]) as record:
        return Repaired(record.state(), len(trunk), missing, tuple(left))


def _told(trunk: Mapping[int, KeptLine], path: Path, left: list[str]) -> tuple[list[EventText], State, Possible | None]:
    """Return the events of all numbers, those that are lost or cannot be as `Lost`; adds why to `left`."""
    undone, first = dict[int, str](), next(iter(trunk.values())).row.at if trunk else ""
    while True:
        rows, story, possible, why, whole = list[EventText](), State(), None, dict(undone), True
        for number in range(1, max(trunk, default=0) + 1):
            if number in trunk and number not in why:
                row = trunk[number].row
                try:
                    each = stored(number, row)
                    _refuse_unfit(each.event, row, rows, whole, possible)
                    story = fold([each], story)
                    rows.append(row)
                    possible = _possible(each.event) if number == 1 else possible
                    continue
                except NewerError as fault:
                    raise fault.placed(path) from None
                except EventOrderError as fault:
                    last, behind = story.undo[-1].number if story.undo else 0, story.finished is not None
                    if not whole and last and (behind or (isinstance(each.event, Undone) and each.event.event < last)):
                        undone[last] = "what follows shows that it was taken back"
                        break
                    why[number] = str(fault)
                except (ValueError, InputError) as fault:
                    why[number] = fault.what if isinstance(fault, InputError) else str(fault)
            lost, whole = Lost(why.get(number, "not whole")), False
            rows.append(EventText(rows[-1].at if rows else first, *encode(lost)))
            if story.created is not None:
                story = fold([Stored(number, rows[-1].at, lost)], story)
        else:
            left += [f"event {number} ({trunk[number].row.kind}): {each}" for number, each in sorted(why.items())]
            return rows, story, possible


def _refuse_unfit(
    event: Event, row: EventText, before: Sequence[EventText], whole: bool, possible: Possible | None
) -> None:
    """Raise DamageError for a whole entry that cannot stand.  whole : whether none before it is missing"""
    if isinstance(event, Accepted) and not whole:
        raise DamageError("what it puts right may be missing; accept it anew")
    if isinstance(event, Signed) and not (whole and holds(row, event, before)):
        raise DamageError("it answers for what is missing, or was changed; sign anew")
    if possible is not None:
        possible.take(event)


def _possible(created: Event) -> Possible | None:
    """Return what can be on the machine of a campaign; None where only code of somebody's could tell."""
    with suppress(CodeError), asking(None):
        return Possible(description_of(created)) if isinstance(created, Created) else None
    return None


def _taken_in(
    found: _Union, story: State, possible: Possible | None, asked: Callable[[str], bool], left: list[str]
) -> list[EventText]:
    """Return the readings of branches that a person wants, to come last; adds the others to `left`."""
    taken, created = list[EventText](), story.created
    assert created is not None
    for every in found.branches:
        branch = [line for line in every if line.last <= every[-1].number]
        if not branch:
            left.append(f"event {every[0].number}: of an entry that nobody has finished")
            continue
        readings = [*_standing(branch, created, possible)]
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
    if taken and story.finished is not None:
        end = next(each.number for each in reversed(story.undo) if isinstance(each.event, Finished))
        return [*rows_of([Undone(end)]), *taken]
    return taken


def _standing(branch: Sequence[KeptLine], created: Created, possible: Possible | None) -> Iterator[EventText]:
    """Yield the readings that a branch leaves standing, without numbers: others may have been given the same."""
    state, rows = fold([Stored(0, "", created)]), {line.number: line.row for line in branch}
    for line in branch:
        with suppress(PayloadError, EventOrderError):
            state = fold([stored(line.number, line.row)], state)
    for each in state.story:
        if isinstance(each.event, Recorded):
            with suppress(InputError):
                if possible is not None:
                    possible.take(each.event)
                row, free = rows[each.number], Recorded(replace(each.event.reading, number=None))
                by = {name: said_by for name, said_by in hand_of(row)._asdict().items() if said_by}
                yield row._replace(payload=encode(free, **by)[1])


def _chained(trunk: Mapping[int, KeptLine], rows: Sequence[EventText]) -> list[KeptLine]:
    """Return lines of all events: as they were written up to the first that is lost or changed, then in one entry."""
    whole = 0
    while whole + 1 in trunk and trunk[whole + 1].row == rows[whole] and trunk[whole + 1].follows(trunk.get(whole)):
        whole += 1
    while whole and trunk[whole].last > whole:
        whole -= 1
    kept = [trunk[number] for number in range(1, whole + 1)]
    campaign = next(iter(trunk.values())).campaign
    return [*kept, *entry(rows[whole:], campaign, "", whole, kept[-1].hash if kept else EMPTY)]


def _missing_words(trunk: Mapping[int, KeptLine], found: _Union) -> Iterator[str]:
    for before, number in pairwise([0, *sorted(trunk), max(found.least, max(trunk)) + 1]):
        if number - before == 2:
            yield f"event {before + 1}"
        elif number - before > 2:
            yield f"events {before + 1} to {number - 1}"
    for name, count in found.others.items():
        yield f"{count} lines of another campaign, {name[:8]}"


class _Union(NamedTuple):
    """What stands whole.

    trunk : lines by number, where two have one those of the longer way; branches : the others, run by run
    others : how many lines are of other campaigns, by id; least : so many events there were at least
    """

    trunk: Mapping[int, KeptLine]
    branches: Sequence[Sequence[KeptLine]]
    others: Mapping[str, int]
    least: int


_NUMBERS = 10**7
"""Events: no record has a tenth of them, and a number beyond is nobody's."""


def _united(contents: Iterable[bytes], campaign: str, path: Path) -> _Union:
    """Return the union of the lines of files; raises RecordError for lines of several campaigns, or of none.

    campaign : the first digits of its id, where there are several; path : of the first file
    """
    found, least = dict[str, KeptLine](), 0
    for content in contents:
        whole = [line for line, _ in whole_lines(content)]
        if not whole:
            content = told_anew(content)
            whole = [line for line, _ in whole_lines(content)]
        with suppress(DamageError):
            least = max([least, *(each for each in counts(content[:HEAD]) if each and each <= _NUMBERS)])
        found |= {line.hash: line for line in whole if line.hash not in found and line.number <= _NUMBERS}
    lines = Counter(line.campaign for line in found.values())
    fitting = [each for each in lines if each.startswith(campaign)]
    if not lines:
        remedy = "Name a record that `axiscal step start` or `axiscal step run` has made, or restore it from a copy"
        raise RecordError("No entry of a record stands whole here", remedy, path)
    if len(fitting) != 1:
        listed = ", ".join(f"{name[:8]} ({count})" for name, count in lines.items())
        remedy = "Name the one that you mean, such as --campaign {name}"
        raise RecordError("Lines of several campaigns stand here: {listed}", remedy, path, listed=listed, name="1a2b")
    trunk, branches = _trunk([line for line in found.values() if line.campaign == fitting[0]])
    last = max(trunk)
    while trunk[last].last > max(last, least) and last > 1:  # an entry that nobody finished
        del trunk[last]
        last = max(trunk)
    others = {each: count for each, count in lines.items() if each != fitting[0]}
    return _Union(trunk, branches, others, least)


def _trunk(lines: Sequence[KeptLine]) -> tuple[dict[int, KeptLine], list[list[KeptLine]]]:
    """Return lines by number, where two have one that of the longer way; and the others, branch by branch."""
    entries = Counter((line.writer, line.first, line.last) for line in lines)
    ways, behind = dict[str, int](), dict[str, int]()  # in lines of entries that somebody finished, by hash
    for line in sorted(lines, key=lambda each: each.number, reverse=True):
        whole = entries[line.writer, line.first, line.last] > line.last - line.first
        ways[line.hash] = whole + behind.get(line.hash, 0)
        behind[line.before] = max(behind.get(line.before, 0), ways[line.hash])
    trunk, branches = dict[int, KeptLine](), dict[str, list[KeptLine]]()  # branches by the hash of their last line
    for line in sorted(lines, key=lambda each: (each.number, -ways[each.hash])):
        before = trunk.get(line.number - 1)  # which is lost, where it is not there
        if line.number not in trunk and (before is None or line.follows(before)):
            trunk[line.number] = line
        else:
            branches[line.hash] = branches.pop(line.before, [])
            branches[line.hash].append(line)
    return trunk, [*branches.values()]
