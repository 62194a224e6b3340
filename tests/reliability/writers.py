"""Writers that are killed, and writers that write at the same time."""

from __future__ import annotations

import os
import random
import signal
import time
from pathlib import Path

from axiscal.document import durable
from axiscal.exceptions import RecordError
from axiscal.record import lease
from axiscal.record.lease import lease_of
from axiscal.record.store import PATIENCE, Record
from tests.reliability.record_faults import CREATED, NAME, recorded, values
from tests.reliability.trial import Trial, scratch


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
        others = [path.name for path in top.iterdir() if path.name not in (NAME, "copy", lease_of(Path(NAME)).name)]
    detail = f"{len(acknowledged):,} readings acknowledged"
    return Trial("kills while readings are written", kills, missed + bool(others), detail)


def _killed_after(path: Path, start: int, seconds: float) -> list[int]:
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)
        with Record.open(path) as record:
            for number in range(start, start + 10_000):
                record.append(recorded(float(number)))
                os.write(writing, b"%d\n" % number)
        os._exit(0)
    os.close(writing)
    time.sleep(seconds)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    with os.fdopen(reading, "rb") as pipe:
        return [int(line) for line in pipe.read().splitlines(keepends=True) if line.endswith(b"\n")]


def at_once(processes: int, entries: int, folder: Path | None = None) -> Trial:
    """Let processes write to one record at the same time, each reading once.

    Who is told that the record is held by another one for too long tries again, as a person would.
    """
    with scratch() as top:
        path = (folder or top) / NAME
        Record.create(path, CREATED).close()
        waits = [_writing(path, number * 1_000_000, entries) for number in range(processes)]
        longest, told = 0.0, 0
        for child, pipe in waits:
            with os.fdopen(pipe, "rb") as heard:
                wait, refused = (heard.read() or b"inf 0").split()
            longest, told = max(longest, float(wait)), told + int(refused)
            os.waitpid(child, 0)
        kept = sorted(int(value) for value in values(path))
    expected = sorted(number * 1_000_000 + entry for number in range(processes) for entry in range(entries))
    missed = len(set(expected) ^ set(kept)) + len(kept) - len(set(kept))
    detail = f"longest wait {longest:.2f} s of {PATIENCE:.0f} s, {told} times told that it is held"
    return Trial(f"readings that {processes} processes write at once", processes * entries, missed, detail)


def _writing(path: Path, start: int, entries: int) -> tuple[int, int]:
    reading, writing = os.pipe()
    child = os.fork()
    if child:
        os.close(writing)
        return child, reading
    longest, told = 0.0, 0
    with Record.open(path) as record:
        for number in range(start, start + entries):
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
    os.write(writing, f"{longest} {told}".encode())
    os._exit(0)


def on_a_share(entries: int) -> Trial:
    """Let two computers write to one record on a share whose locks do nothing; who is refused waits and tries again."""
    taken, computer, old = durable._taken, lease._computer, lease.OLD
    try:
        durable._taken = lambda handle: True
        lease.OLD = 1.0
        with scratch() as top:
            Record.create(top / NAME, CREATED).close()
            pipes = [_on(f"computer {n}", top / NAME, 1_000_000 * n, entries) for n in range(2)]
            acknowledged, refused = set[int](), 0
            for child, pipe in pipes:
                with os.fdopen(pipe, "rb") as heard:
                    words = heard.read().split()
                acknowledged |= {int(word) for word in words if word != b"-"}
                refused += words.count(b"-")
                os.waitpid(child, 0)
            kept = [int(value) for value in values(top / NAME)]
            branches = list(top.glob(f"{Path(NAME).stem}-*.axiscal"))
    finally:
        durable._taken, lease._computer, lease.OLD = taken, computer, old
    missed = len(acknowledged - set(kept)) + len(kept) - len(set(kept))
    detail = f"{len(acknowledged):,} acknowledged; refused in one sentence {refused:,} times; {len(branches)} branches"
    return Trial("entries of 2 computers on a share without locks", 2 * entries, missed, detail)


def _on(computer: str, path: Path, start: int, entries: int) -> tuple[int, int]:
    """Write entries as another computer, opening the record for some at a time, as commands do."""
    reading, writing = os.pipe()
    child = os.fork()
    if child:
        os.close(writing)
        return child, reading
    lease._computer = lambda: f"{computer} 0"
    chance, number = random.Random(start), start
    while number < start + entries:
        try:
            with Record.open(path) as record:
                for _ in range(min(chance.randrange(1, 100), start + entries - number)):
                    record.append(recorded(float(number)))
                    os.write(writing, b"%d\n" % number)
                    number += 1
        except RecordError:
            os.write(writing, b"-\n")
            time.sleep(chance.uniform(0, 0.01))
    os._exit(0)
