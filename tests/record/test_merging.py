"""What stands whole in a damaged file, by number and by line."""

from __future__ import annotations

from dataclasses import replace

import pytest

from axiscal.measurement.reading import Reading
from axiscal.record.events import Noted, Recorded
from axiscal.record.line_form import BLOCK, MARK, MARKS, START, EventText, Mark, mark_bytes, transaction
from axiscal.record.merging import merged
from axiscal.record.payload import encode
from axiscal.record.store import Record
from tests.reliability.record_faults import CREATED
from tests.reliability.salvaged import _made, lines_of

EVENTS = 9


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The file of a record with nine events, each in a transaction of its own."""
    path = tmp_path_factory.mktemp("whole") / "warm.axiscal"
    with Record.create(path, CREATED) as record:
        for number in range(2, EVENTS + 1):
            record.append(Noted(f"warm {number}"))
    return path.read_bytes()


def _stands(content: bytes) -> tuple[list[int], int | None]:
    """Return the numbers that stand, and the last one by the marks; no line may be of another record."""
    found = merged(content)
    assert found.apart == []
    numbers = [number for strand in found.strands for number in strand.numbers if strand.certain]
    return numbers, found.newest and found.newest.last


def _changed(content: bytes, at: int, new: bytes) -> bytes:
    return content[:at] + new + content[at + len(new) :]


@pytest.mark.parametrize("at", [10, 100], ids=["chain", "text"])
@pytest.mark.parametrize("marks", [True, False])
def test_one_damaged_line_links_those_around_it(whole: bytes, at: int, marks: bool) -> None:
    """By the chain that it names, or by the one that its text gives."""
    damaged = whole
    for number in (4, 6):
        damaged = _changed(damaged, lines_of(whole)[number - 1].begin + at, b"#")
    for mark in () if marks else MARKS:
        damaged = _changed(damaged, mark, bytes(MARK))
    assert _stands(damaged) == ([1, 2, 3, 5, 7, 8, 9], EVENTS if marks else None)


def _record(name: str, second: int, minute: int = 0, clock: bool = False) -> bytes:
    """Return the file of a record with nine events, one a minute.

    second, minute : when it was begun; clock : its events are readings that say how long after that
    """
    taken = (Recorded(Reading(name, (0.1,), (1,), 1e-6, time=60.0 * number)) for number in range(1, EVENTS))
    events = [
        replace(CREATED, campaign_source=name),
        *(taken if clock else (Noted(f"{name} {number}") for number in range(2, EVENTS + 1))),
    ]
    times = (f"2026-03-02T08:{minute + each:02}:{second:02}.000+00:00" for each in range(EVENTS))
    return _made(EventText(at, *encode(event)) for at, event in zip(times, events, strict=True))


OWN, OTHER, LATER = _record("own", 0), _record("other", 30), _record("later", 30, 2)
OWN_CLOCK, OTHER_CLOCK = _record("own", 0, clock=True), _record("other", 30, clock=True)
TORN = b"0123abcd of a line\n"


def _lines(content: bytes, *numbers: int) -> bytes:
    lines = content[START:].splitlines(keepends=True)
    return b"".join(lines[number - 1] for number in numbers)


def _of_each(content: bytes) -> tuple[list[int], int]:
    """Return the numbers that stand, and how many lines are of another record."""
    found = merged(content)
    return [number for strand in found.strands for number in strand.numbers], sum(
        len(each.lines) for each in found.apart
    )


@pytest.mark.parametrize(
    ("lines", "stands"),
    [
        (_lines(OTHER, 1, 2, 3, 4) + _lines(OWN, 5, 6, 7, 8, 9), [5, 6, 7, 8, 9]),
        (_lines(OWN, 1, 2, 3, 4) + _lines(OTHER, 4, 5) + _lines(OWN, 8, 9), [1, 2, 3, 4, 8, 9]),
        (_lines(OWN, *range(1, 10)) + _lines(OTHER, 9), list(range(1, 10))),
        (_lines(OWN, 1, 2) + _lines(OTHER, 8) + _lines(OWN, 8, 9), [1, 2, 8, 9]),
        (_lines(OWN, 1, 2) + _lines(LATER, 1, 2) + _lines(OWN, 8, 9), [1, 2, 8, 9]),
        (_lines(OTHER, 2) + TORN + _lines(OWN, 6, 7, 8, 9), [6, 7, 8, 9]),
    ],
    ids=["at once before", "more than missing", "behind the last", "too late", "a beginning amid", "torn off"],
)
def test_lines_for_which_there_is_no_room_are_of_another_record(lines: bytes, stands: list[int]) -> None:
    assert _of_each(OWN[:START] + lines) == (stands, len(lines.splitlines()) - len(stands) - lines.count(TORN))


def test_lines_for_which_there_is_room_stand() -> None:
    lines = _lines(OWN, 1, 2, 3, 4) + _lines(OWN, 6, 7, 8, 9)
    assert _of_each(OWN[:START] + lines) == ([1, 2, 3, 4, 6, 7, 8, 9], 0)


def test_clocks_tell_whose_lines_these_are() -> None:
    first, amid, last = _lines(OWN_CLOCK, 1, 2, 3), _lines(OTHER_CLOCK, 5), _lines(OWN_CLOCK, 8, 9)
    assert _of_each(OWN_CLOCK[:START] + first + amid + last) == ([1, 2, 3, 8, 9], 1)
    assert _of_each(OWN_CLOCK[:START] + first + _lines(OWN_CLOCK, 6) + last) == ([1, 2, 3, 1, 8, 9], 0)


def test_what_parted_from_a_record_is_its_own_by_its_clock() -> None:
    """Two went on from the fourth event, each unaware of the other."""
    chain, row = OWN_CLOCK.splitlines()[-6].split(b" ")[0], EventText("2026-03-02T08:04:05.000+00:00", *encode(
        Recorded(Reading("rival", (0.1,), (1,), 1e-6, time=245.0))
    ))  # fmt: skip
    text, _ = transaction(Mark(4, 4, START, chain.decode()), [row])
    found = merged(OWN_CLOCK + text)
    assert ([len(each.lines) for each in found.asides], found.apart) == ([1], [])


def _marked(*marks: Mark | None) -> bytes:
    """Return the record with other marks in the place of its own, None for one that stays."""
    content = OWN
    for at, mark in zip(MARKS, marks, strict=True):
        content = content if mark is None else _changed(content, at, mark_bytes(mark).ljust(BLOCK - 1))
    return content


def test_of_marks_that_no_line_bears_out_the_one_counts_that_may_be_newer() -> None:
    """Turns of the two marks of a record follow each other; a number that stands has the mark of its own line."""
    early, late = Mark(20, 20, 9000, "a" * 64), Mark(30, 30, 9900, "b" * 64)
    known = Mark(EVENTS + 1, 5, 5000, "c" * 64)
    for marks, newest, unborne in (
        ((None, late), EVENTS, [late]),
        ((late, None), EVENTS - 1, [late]),
        ((early, late), 30, [late]),
        ((None, known), EVENTS, [known]),
        ((known, None), EVENTS - 1, [known]),
    ):
        found = merged(_marked(*marks))
        assert found.newest is not None
        assert (found.newest.last, found.unborne) == (newest, unborne), marks
