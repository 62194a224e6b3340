"""A new record of what stands whole in damaged ones and in copies that went on apart: the union of their lines.

Each line says its campaign, its number and the line before, so that nothing is inferred. What is missing has a number
and is named; two lines of one number are a branch, and a person says whether it counts.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

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
    EventOrderError,
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

_NUMBERS = 10**7
"""Events: no record has a tenth of them, and a number beyond is nobody's."""
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
    lines, others, least = _united(paths, campaign)
    trunk, branches = _trunk(lines, least)
    left = list[str]()
    if beginning is not None and 1 not in trunk:
        trunk[1] = entry(rows_of([beginning]), lines[0].campaign, "")[0]
    if unproven := [number for number, line in trunk.items() if line.writer == UNPROVEN]:
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
    taken = list[EventText]()
    for branch in branches:
        words, readings = _of_branch(branch, story.created, possible)
        if readings and asked(words):
            taken += readings
        else:
            left.append(words)
    if taken and story.finished is not None:
        rows += rows_of([Undone(story.undo[-1].number)])
    missing = [*_missing_words([*sorted(trunk), max(least, *trunk) + 1]), *others]
    told = [*missing, *left]
    more = [f"and {len(told) - _MOST} more"] if len(told) > _MOST else []
    listed = "; ".join([*told[:_MOST], *more]) or "nothing"
    names = " and ".join(path.name for path in paths)
    rows += [*taken, *rows_of([Noted(f"repaired from {names}, {len(trunk)} events. Missing: {listed}")])]
    with Record.made(new, content_of_lines(_chained(trunk, rows)), like=paths[0]) as record:
        return Repaired(record.state(), len(trunk), tuple(missing), tuple(left))


def _united(paths: Sequence[Path], campaign: str) -> tuple[list[KeptLine], list[str], int]:
    """Return the lines of a campaign that stand whole, words on those of others, and how many there were at least.

    campaign : the first digits of its id.  Raises RecordError for lines of several that fit, or of none.
    """
    found, least = dict[str, KeptLine](), 0
    for path in paths:
        content = path.read_bytes()
        if not (whole := [*whole_lines(content)]):
            content = told_anew(content)
            whole = [*whole_lines(content)]
        with suppress(DamageError):
            least = max([least, *(each for each in counts(content[:HEAD]) if each and each <= _NUMBERS)])
        found |= {line.hash: line for line, _ in whole if line.number <= _NUMBERS}
    campaigns = Counter(line.campaign for line in found.values())
    fitting = [each for each in campaigns if each.startswith(campaign)]
    if not campaigns:
        remedy = "Name a record that `axiscal step start` or `axiscal step run` has made, or restore it from a copy"
        raise RecordError("No entry of a record stands whole here", remedy, paths[0])
    if len(fitting) != 1:
        listed = ", ".join(f"{name[:8]} ({count})" for name, count in campaigns.items())
        remedy = "Name the one that you mean, such as --campaign {name}"
        what = "Lines of several campaigns stand here: {listed}"
        raise RecordError(what, remedy, paths[0], listed=listed, name="1a2b")
    del campaigns[fitting[0]]
    others = [f"{count} lines of another campaign, {name[:8]}" for name, count in campaigns.items()]
    return [line for line in found.values() if line.campaign == fitting[0]], others, least


def _trunk(lines: Sequence[KeptLine], least: int) -> tuple[dict[int, KeptLine], list[list[KeptLine]]]:
    """Return lines by number, where two have one that of the longer way; and the others, branch by branch.

    least : so many events there were at least: an entry behind that nobody finished is none
    """
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
    while (last := max(trunk)) > 1 and trunk[last].last > max(last, least):
        del trunk[last]
    return trunk, [*branches.values()]


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
                    if isinstance(each.event, Accepted) and not whole:
                        raise DamageError("what it puts right may be missing; accept it anew")
                    if isinstance(each.event, Signed) and not (whole and holds(row, each.event, rows)):
                        raise DamageError("it answers for what is missing, or was changed; sign anew")
                    if possible is not None:
                        possible.take(each.event)
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


def _possible(created: object) -> Possible | None:
    """Return what can be on the machine of a campaign; None where only code of somebody's could tell."""
    with suppress(CodeError), asking(None):
        return Possible(description_of(created)) if isinstance(created, Created) else None
    return None


def _of_branch(every: Sequence[KeptLine], created: Created, possible: Possible | None) -> tuple[str, list[EventText]]:
    """Return a branch in words, and the readings it leaves, without numbers: others may have been given the same."""
    branch = [line for line in every if line.last <= every[-1].number]
    if not branch:
        return f"event {every[0].number}: of an entry that nobody has finished", []
    state, rows, found = fold([Stored(0, "", created)]), {line.number: line.row for line in branch}, list[EventText]()
    for number, row in rows.items():
        with suppress(PayloadError, EventOrderError):
            state = fold([stored(number, row)], state)
    for each in state.story:
        with suppress(InputError):
            if isinstance(each.event, Recorded):
                if possible is not None:
                    possible.take(each.event)
                row, free = rows[each.number], Recorded(replace(each.event.reading, number=None))
                by = {name: said_by for name, said_by in hand_of(row)._asdict().items() if said_by}
                found.append(row._replace(payload=encode(free, **by)[1]))
    words = counted(
        "two went on from event {number}: {count} reading of {by} stands beside",
        "two went on from event {number}: {count} readings of {by} stand beside",
        len(found),
        number=branch[0].number - 1,
        by=said_hand(branch[0].row),
    )
    return words, found


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


def _missing_words(numbers: Sequence[int]) -> Iterator[str]:
    """Yield which numbers are not among these, in order."""
    for before, number in pairwise([0, *numbers]):
        if number - before == 2:
            yield f"event {before + 1}"
        elif number - before > 2:
            yield f"events {before + 1} to {number - 1}"
