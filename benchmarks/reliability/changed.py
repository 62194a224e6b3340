"""Changed bits, missing ends, a clock that goes back, and records with very many events."""

from __future__ import annotations

import os
import random
import resource
import time
from collections.abc import Iterator
from contextlib import suppress
from functools import partial
from pathlib import Path
from unittest.mock import patch

from axiscal.campaign.repairing import repaired
from axiscal.exceptions import RecordError
from axiscal.record import signing
from axiscal.record.events import Event, Stored
from axiscal.record.lines import HEAD, SLOT, SLOTS
from axiscal.record.store import Record
from benchmarks.reliability.damages import first_record
from benchmarks.reliability.record_faults import CREATED, NAME, events, recorded, values
from benchmarks.reliability.trial import Say, Trial, forked, scratch

SECONDS, MEGABYTES = 2.0, 200.0
"""Processor time in which a record opens, and memory of the process."""


def bits(every: int = 1) -> Trial:
    """Flip each bit of a record that matters by itself: what it holds is the same, or it is damaged."""
    with scratch() as top:
        content, whole = _record(top / NAME)
        changed, silent, damaged = top / "changed.axiscal", 0, 0
        chosen = list(_bits(len(content)))[::every]
        for bit in chosen:
            flipped = bytearray(content)
            flipped[bit // 8] ^= 1 << bit % 8
            changed.write_bytes(flipped)
            said = _said(changed)
            damaged += "The record is damaged: " in said
            silent += "damaged" not in said and (bool(said) or events(changed) != whole)
    detail = f"{damaged} called damaged, the others change nothing"
    return Trial("bits of a record flipped, one at a time", len(chosen), silent, detail)


def ends() -> Trial:
    """Cut a record at every length that lacks something acknowledged."""
    with scratch() as top:
        content, _ = _record(top / NAME)
        cut, silent = top / "cut.axiscal", 0
        for size in range(HEAD, len(content) - 1):
            cut.write_bytes(content[:size])
            silent += "damaged" not in _said(cut)
    return Trial("records cut off before their end", len(content) - 1 - HEAD, silent)


def clock() -> Trial:
    """Set the clock back by a day between readings: order and numbers stay."""
    days = [f"2026-01-{day:02}T10:00:00.000+00:00" for day in (20, 19, 21, 18, 17, 30)]
    with scratch() as top:
        with patch.object(signing, "now", side_effect=days), Record.create(top / NAME, CREATED) as record:
            for number in range(5):
                record.append(recorded(float(number)))
        missed = values(top / NAME) != [0.0, 1.0, 2.0, 3.0, 4.0]
    return Trial("readings while the clock is set back by days", 5, 5 * missed)


def many(events: int) -> Trial:
    """Open a record of many events; each is checked."""
    with scratch() as top:
        with Record.create(top / NAME, CREATED) as record:
            batch: list[Event] = [recorded(1e-6)] * (events - 1)
            record.append(*batch)
        begin = time.process_time()
        with Record.open(top / NAME, write=False) as record:
            missed = events - record.last()
            record.state()
        seconds = time.process_time() - begin
    detail = f"{seconds:.2f} s of processor time, at most {SECONDS:.0f}"
    return Trial(f"events of one record that is opened ({events:,})", events, missed + (seconds > SECONDS), detail)


def large() -> Trial:
    """Open and repair what has 10 MB and is no record, or is one with that behind it; each in a process of its own."""
    with scratch() as top:
        path, found = top / NAME, list[tuple[float, float]]()
        for content in _large():
            path.write_bytes(content)
            (line,) = forked(partial(_opened_and_repaired, path)).lines()
            seconds, megabytes = map(float, line.split())
            found.append((seconds, megabytes))
    over = sum(seconds > SECONDS or megabytes > MEGABYTES for seconds, megabytes in found)
    longest, most = max(each[0] for each in found), max(each[1] for each in found)
    detail = f"{longest:.1f} s of processor time at most, {most:.0f} MB; {SECONDS:.0f} s and {MEGABYTES:.0f} MB at most"
    return Trial("files of 10 MB that are opened and repaired", len(found), over, detail)


def _large() -> Iterator[bytes]:
    size, whole = 10 << 20, first_record()
    line = whole[HEAD : HEAD + 70]
    for piece in (b"\0", b"{}", line, line + b"}", b"0123456789abcdef", b"x\n", random.Random(1).randbytes(1 << 16)):
        filled = piece * (size // len(piece))
        yield filled
        yield whole + filled


def _opened_and_repaired(path: Path, say: Say) -> None:
    before = time.process_time()
    for work in (Record.open, lambda path: repaired([path], path.with_suffix(".new"), lambda question: True)):
        with suppress(RecordError):
            work(path)
    path.with_suffix(".new").unlink(missing_ok=True)
    say(f"{time.process_time() - before} {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024}")


def _record(path: Path) -> tuple[bytes, tuple[Stored, ...]]:
    with Record.create(path, CREATED) as record:
        for number in range(3):
            record.append(recorded(1e-6 * number))
    return path.read_bytes(), events(path)


def _bits(size: int) -> Iterator[int]:
    """Yield every bit of both counts and of the lines, and of the rest, which is the same in every record, some."""
    for begin, end in (*((at, at + SLOT) for at in SLOTS), (HEAD, size)):
        yield from range(8 * begin, 8 * end)
    yield from range(0, 8 * HEAD, 1009)


def _said(path: Path) -> str:
    try:
        os.stat(path)
        Record.open(path, write=False).close()
    except RecordError as failure:
        return str(failure)
    return ""
