"""Signed records that somebody without the key changes, and makes their chain, sums and marks anew."""

from __future__ import annotations

import json
import os
import random
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from itertools import accumulate
from pathlib import Path
from typing import NamedTuple
from unittest.mock import patch

from axiscal.record import signing
from axiscal.record.events import Noted
from axiscal.record.lines import EMPTY, EventText, chained
from axiscal.record.signing import KEY, PERSON, make_key
from axiscal.record.store import Record, content_of
from benchmarks.reliability.record_faults import CREATED, NAME, recorded
from benchmarks.reliability.trial import Trial, scratch
from tools.check_record import checked

DAYS, READINGS = 3, 8
"""Of the record, each day of another person; every day has a note, and is signed at its end."""


class Original(NamedTuple):
    """A record that is signed to its end: its events, public keys, and the chain at the end of each signature."""

    rows: tuple[EventText, ...]
    keys: tuple[str, ...]
    heads: tuple[str, ...]


@contextmanager
def person(name: str, key: Path) -> Iterator[None]:
    """Be somebody with a key in a file."""
    with patch.dict(os.environ, {PERSON: name, KEY: str(key)}):
        make_key()
        yield


def signed_record(path: Path) -> Record:
    """Return a new record of three days and two people, signed each day, open to be written."""
    for day in range(DAYS):
        times = iter([f"2026-03-0{day + 1}T12:00:{second:02}.000+00:00" for second in range(60)])
        someone = person(("Anna", "Otto")[day % 2], path.with_name(f"{day % 2}.pem"))
        with someone, patch.object(signing, "now", times.__next__):
            record = Record.create(path, CREATED) if day == 0 else Record.open(path)
            for number in range(READINGS):
                record.append(recorded(1e-6 * (number + READINGS * day)))
            record.append(Noted(f"day {day}"), recorded(1e-3))
            assert record.sign()
            if day < DAYS - 1:
                record.close()
    return record


@cache
def original() -> Original:
    """Return the record that is changed, which has no fault itself."""
    with scratch() as top, signed_record(top / NAME) as record:
        rows, chains = record.rows, _chains(record.rows)
        keys = tuple({json.loads(row.payload)["key"] for row in rows if row.kind == "signed"})
        assert not checked((top / NAME).read_bytes(), keys, [chains[-1]]).faults
    heads = (chain for row, chain in zip(rows, chains, strict=True) if row.kind == "signed")
    return Original(tuple(rows), keys, tuple(heads))


def _chains(rows: Sequence[EventText]) -> list[str]:
    """Return the chain of contents behind each event."""
    return list(accumulate(rows, chained, initial=EMPTY))[1:]


def _other(value: object, drawn: random.Random) -> object:
    """Return another value of the same kind."""
    match value:
        case float():
            return value + 1e-6 * drawn.choice((-1, 1)) * drawn.randint(1, 9)
        case str():
            place = drawn.randrange(len(value) + 1)
            return value[:place] + drawn.choice("0123456789abcdef") + value[place:]
        case list() if value:
            return [*value[:-1], _other(value[-1], drawn)]
        case dict() if value:
            name = drawn.choice(sorted(value))
            return {**value, name: _other(value[name], drawn)}
    return 17 if value != 17 else 18


def _field(rows: list[EventText], place: int, drawn: random.Random) -> None:
    said = _other(json.loads(rows[place].payload), drawn)
    rows[place] = rows[place]._replace(payload=json.dumps(said, ensure_ascii=False, separators=(",", ":")))


def _time(rows: list[EventText], place: int, drawn: random.Random) -> None:
    rows[place] = rows[place]._replace(at=f"2026-03-04T{drawn.randint(0, 23):02}:00:00.000+00:00")


def _kind(rows: list[EventText], place: int, _drawn: random.Random) -> None:
    rows[place] = rows[place]._replace(kind="skipped")


def _left_out(rows: list[EventText], place: int, _drawn: random.Random) -> None:
    del rows[place]


def _put_in(rows: list[EventText], place: int, drawn: random.Random) -> None:
    rows.insert(place, drawn.choice(rows))


def _swapped(rows: list[EventText], place: int, drawn: random.Random) -> None:
    other = drawn.choice([n for n in range(len(rows)) if n != place])
    rows[place], rows[other] = rows[other], rows[place]


EDITS: Sequence[Callable[[list[EventText], int, random.Random], None]] = (
    _field,
    _field,
    _time,
    _kind,
    _left_out,
    _put_in,
)


def edited(count: int, ways: Sequence[Callable[[list[EventText], int, random.Random], None]] = EDITS) -> Iterator[bool]:
    """Yield for each of so many changed records whether a fault names where it was changed."""
    drawn, first = random.Random(2026), original()
    for number in range(count):
        rows = list(first.rows)
        place = drawn.randrange(len(rows))
        ways[number % len(ways)](rows, place, drawn)
        here = (
            next(
                (n for n, (one, other) in enumerate(zip(rows, first.rows, strict=False)) if one != other), len(rows) - 1
            )
            + 1
        )
        faults = checked(content_of(rows), first.keys, [first.heads[-1]]).faults
        yield any(_names(fault, here) for fault in faults if "set back" not in fault)


def _names(fault: str, number: int) -> bool:
    spans = re.findall(r"events? (\d+)(?: to (\d+))?", fault)
    return any(int(begin) <= number <= int(end or begin) for begin, end in spans)


def set_back() -> Iterator[bool]:
    """Yield for each earlier state whether the last known end names it; alone only what ends signed has no fault."""
    first = original()
    for number, chain in enumerate(_chains(first.rows)[:-1], 1):
        cut = content_of(first.rows[:number])
        named = any("set back" in fault for fault in checked(cut, first.keys, [first.heads[-1]]).faults)
        yield named and bool(checked(cut, first.keys).faults) == (chain not in first.heads)


def tried(edits: int) -> Trial:
    """Change a signed record so many times, swap two of its events a tenth as often, set it back to every event."""
    swaps, earlier = [*edited(edits // 10, (_swapped,))], [*set_back()]
    found = [*edited(edits), *swaps, *earlier]
    detail = f"{edits:,} edits, {len(swaps):,} swaps, {len(earlier)} set back; each named with its event"
    return Trial("signed records changed without the key, sums made anew", len(found), found.count(False), detail)
