"""Writers that are killed, and writers that write at the same time."""

from __future__ import annotations

import os
import random
import signal
import time
from functools import partial
from pathlib import Path
from unittest.mock import patch

from axiscal.campaign.repairing import repaired
from axiscal.document import durable
from axiscal.exceptions import RecordError
from axiscal.record import store
from axiscal.record.store import PATIENCE, Record
from benchmarks.reliability.damages import first_record
from benchmarks.reliability.record_faults import CREATED, NAME, recorded, values
from benchmarks.reliability.trial import Say, Trial, forked, scratch


def killed(kills: int, seed: int = 5) -> Trial:
    """Kill a writer without warning, again and again, and look at its file alone."""
    chance, acknowledged = random.Random(seed), list[int]()
    with scratch() as top:
        Record.create(top / NAME, CREATED).close()
        copy = top / "copy" / NAME
        copy.parent.mkdir()
        missed = 0
        for turn in range(kills):
            acknowledged += _killed_after(top / NAME, 10_000 * turn, chance.uniform(0.0, 0.02))
            copy.write_bytes((top / NAME).read_bytes())
            kept = [int(value) for value in values(copy)]
            missed += not set(acknowledged) <= set(kept) or len(kept) != len(set(kept))
            missed += len(kept) > len(acknowledged) + turn + 1  # at most one unheard reading per kill
        Record.open(top / NAME).close()  # clears away what a kill has left
        others = [path.name for path in top.iterdir() if path.name not in (NAME, "copy")]
    detail = f"{len(acknowledged):,} readings acknowledged"
    return Trial("kills while readings are written", kills, missed + bool(others), detail)


def _killed_after(path: Path, start: int, seconds: float) -> list[int]:
    writer = forked(partial(_all_written, path, range(start, start + 10_000)))
    time.sleep(seconds)
    os.kill(writer.process, signal.SIGKILL)
    return [int(line) for line in writer.lines()]


def _all_written(path: Path, numbers: range, say: Say) -> None:
    with Record.open(path) as record:
        for number in numbers:
            record.append(recorded(float(number)))
            say(f"{number}")


def at_once(processes: int, entries: int, folder: Path | None = None) -> Trial:
    """Let processes write to one record at the same time, each reading once.

    Who is told that the record is held by another one for too long tries again, as a person would.
    """
    with scratch() as top:
        path = (folder or top) / NAME
        Record.create(path, CREATED).close()
        starts = (number * 1_000_000 for number in range(processes))
        writing = [forked(partial(_patiently, path, range(start, start + entries))) for start in starts]
        said = [(each.lines() or ["inf 0"])[0].split() for each in writing]
        longest, told = max(float(wait) for wait, _ in said), sum(int(refused) for _, refused in said)
        kept = sorted(int(value) for value in values(path))
    expected = sorted(number * 1_000_000 + entry for number in range(processes) for entry in range(entries))
    missed = len(set(expected) ^ set(kept)) + len(kept) - len(set(kept))
    detail = f"longest wait {longest:.2f} s of {PATIENCE:.0f} s, {told} times told that it is held"
    return Trial(f"readings that {processes} processes write at once", processes * entries, missed, detail)


def _patiently(path: Path, numbers: range, say: Say) -> None:
    """Write readings, and say the longest wait, and how often the record was held by another one for too long."""
    longest, told = 0.0, 0
    with Record.open(path) as record:
        for number in numbers:
            kept = False
            while not kept:
                begin = time.monotonic()
                try:
                    record.append(recorded(float(number)))
                    kept = True
                except RecordError as error:
                    if "holds this record" not in str(error):
                        break
                    told += 1
                longest = max(longest, time.monotonic() - begin)
    say(f"{longest} {told}")


def on_a_share(entries: int) -> Trial:
    """Let two computers write to one record on a share whose locks do nothing, one asleep inside an entry at times.

    Where both went on from one event the record is named as such, and what both wrote is taken in.
    """
    rounds, said, missed, named = max(1, entries // _ROUND), list[str](), 0, 0
    with scratch() as top, patch.object(durable, "_hold"):
        path = top / NAME
        path.write_bytes(first_record())
        for turn in range(rounds):
            starts = (1_000 * (2 * turn + n) for n in range(2))
            computers = [forked(partial(_on, path, start, _ROUND)) for start in starts]
            said += [line for each in computers for line in each.lines()]
            try:
                values(path)
            except RecordError as branch:
                named += "Two went on from event" in str(branch)
                repaired([path], top / "both.axiscal", lambda question: True)
                (top / "both.axiscal").replace(path)
            kept = [round(1e9 * value) for value in values(path)]
            acknowledged = {int(line) for line in said if line != "-"}
            missed += len(acknowledged - set(kept)) + len(kept) - len(set(kept))
    detail = (
        f"{len(acknowledged):,} acknowledged, {said.count('-'):,} refused in one sentence, {named:,} branches named"
    )
    return Trial("entries of 2 computers on a share without locks", 2 * rounds * _ROUND, missed, detail)


_ROUND = 25
"""Entries that each computer writes before somebody looks whether both went on from one event."""


def _on(path: Path, start: int, entries: int, say: Say) -> None:
    """Write entries as another computer, which sleeps at times between looking and writing."""
    chance, write_at = random.Random(start), durable.write_at

    def late(handle: int, offset: int, content: bytes) -> None:
        time.sleep(chance.choice((0.0, 0.0, 0.0, 0.002, 0.02)))
        write_at(handle, offset, content)

    with patch.object(store, "write_at", late):
        for number in range(start, start + entries):
            try:
                with Record.open(path) as record:
                    record.append(recorded(1e-9 * number, "along x"))
                say(f"{number}")
            except RecordError:
                say("-")
                return
            time.sleep(chance.choice((0.0, 0.001, 0.03)))
