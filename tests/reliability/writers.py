"""Writers that are killed, and writers that write at the same time."""

from __future__ import annotations

import os
import random
import signal
import time
from functools import partial
from pathlib import Path
from unittest.mock import patch

from axiscal.document import durable
from axiscal.exceptions import RecordError
from axiscal.record import lease
from axiscal.record.lease import lease_of
from axiscal.record.store import PATIENCE, Record
from tests.reliability.record_faults import CREATED, NAME, recorded, values
from tests.reliability.trial import Say, Trial, forked, scratch


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
    """Let two computers write to one record on a share whose locks do nothing; who is refused waits and tries again."""
    with scratch() as top, patch.object(durable, "_taken", return_value=True), patch.object(lease, "OLD", 1.0):
        Record.create(top / NAME, CREATED).close()
        computers = [forked(partial(_on, f"computer {n}", top / NAME, 1_000_000 * n, entries)) for n in range(2)]
        lines = [line for each in computers for line in each.lines()]
        kept = [int(value) for value in values(top / NAME)]
        branches = list(top.glob(f"{Path(NAME).stem}-*.axiscal"))
    acknowledged, refused = {int(line) for line in lines if line != "-"}, lines.count("-")
    missed = len(acknowledged - set(kept)) + len(kept) - len(set(kept))
    detail = f"{len(acknowledged):,} acknowledged; refused in one sentence {refused:,} times; {len(branches)} branches"
    return Trial("entries of 2 computers on a share without locks", 2 * entries, missed, detail)


def _on(computer: str, path: Path, start: int, entries: int, say: Say) -> None:
    """Write entries as another computer, opening the record for some at a time, as commands do."""
    lease._computer = lambda: f"{computer} 0"
    chance, number = random.Random(start), start
    while number < start + entries:
        try:
            with Record.open(path) as record:
                for _ in range(min(chance.randrange(1, 100), start + entries - number)):
                    record.append(recorded(float(number)))
                    say(f"{number}")
                    number += 1
        except RecordError:
            say("-")
            time.sleep(chance.uniform(0, 0.01))
