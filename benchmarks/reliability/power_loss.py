"""Lost power: of what was written and not waited for, any part may be on the disk, in any order, or be garbage.

The calls of real appends are logged. Each state of the disk is what was waited for, and of the later writes any pieces
of a sector, as they were written, as they were before, or torn.
"""

from __future__ import annotations

import os
import random
from dataclasses import dataclass, field
from pathlib import Path
from unittest.mock import patch

from axiscal.document import durable
from axiscal.record import store
from axiscal.record.events import Event
from benchmarks.reliability.record_faults import CREATED, NAME, recorded, values
from benchmarks.reliability.trial import Trial, scratch

SECTOR = 512
APPENDS = 12


@dataclass
class Log:
    """What a disk was told: writes and cuts between waits; how many readings were acknowledged at each wait."""

    epochs: list[list[tuple[int, bytes | None]]] = field(default_factory=lambda: [[]])
    acknowledged: list[int] = field(default_factory=lambda: [0])


def lost(states: int, seed: int = 7) -> Trial:
    """Try so many states of the disk."""
    chance = random.Random(seed)
    with scratch() as top:
        before, log = _logged(top / NAME)
        path = top / "after" / NAME
        path.parent.mkdir()
        missed = sum(_misses(before, log, chance, path) for _ in range(states))
    return Trial("states of a disk after lost power", states, missed)


def _logged(path: Path) -> tuple[bytes, Log]:
    """Write to a record, and return what it was before and what the disk was told."""
    store.Record.create(path, CREATED).close()
    before, log = path.read_bytes(), Log()
    write_at, sync, cut = durable.write_at, durable.sync, os.ftruncate

    def wrote(handle: int, offset: int, content: bytes) -> None:
        log.epochs[-1].append((offset, content))
        write_at(handle, offset, content)

    def waited(handle: int) -> None:
        log.epochs.append([])
        log.acknowledged.append(log.acknowledged[-1])
        sync(handle)

    def shortened(handle: int, size: int) -> None:
        log.epochs[-1].append((size, None))
        cut(handle, size)

    logged = patch.multiple(store, write_at=wrote, sync=waited)
    with logged, patch.object(os, "ftruncate", shortened), store.Record.open(path) as record:
        for number in range(APPENDS):
            batch: list[Event] = [recorded(float(number))] * (1 + number % 3)
            record.append(*batch)
            log.acknowledged[-1] += len(batch)
    disk = bytearray(before)
    for epoch in log.epochs:
        for offset, content in epoch:
            _apply(disk, offset, content)
    assert disk == path.read_bytes(), "the disk was told more than was logged"
    return before, log


def _misses(before: bytes, log: Log, chance: random.Random, path: Path) -> bool:
    last = chance.randrange(len(log.epochs))
    disk = bytearray(before)
    for epoch in log.epochs[:last]:
        for offset, content in epoch:
            _apply(disk, offset, content)
    pieces = [piece for write in log.epochs[last] for piece in _pieces(*write)]
    chance.shuffle(pieces)
    for offset, content in pieces:
        fate = chance.choice(("written", "dropped", "torn"))
        if fate == "torn" and content is not None:
            content = content[: chance.randrange(len(content))] + chance.randbytes(chance.randrange(9))
        if fate != "dropped":
            _apply(disk, offset, content)
    path.write_bytes(disk)
    expected = [float(number) for number in range(APPENDS) for _ in range(1 + number % 3)]
    sums = [0, *(sum(1 + number % 3 for number in range(count + 1)) for count in range(APPENDS))]
    kept = values(path)
    whole = kept == expected[: len(kept)] and len(kept) in sums
    with store.Record.open(path) as record:
        record.append(recorded(99.0))
    return len(kept) < log.acknowledged[last] or not whole or values(path) != [*kept, 99.0]


def _apply(disk: bytearray, offset: int, content: bytes | None) -> None:
    if content is None:
        del disk[offset:]
        return
    disk.extend(bytes(max(offset + len(content) - len(disk), 0)))
    disk[offset : offset + len(content)] = content


def _pieces(offset: int, content: bytes | None) -> list[tuple[int, bytes | None]]:
    if content is None:
        return [(offset, None)]
    ends = [*range(SECTOR - offset % SECTOR, len(content), SECTOR), len(content)]
    return [(offset + begin, content[begin:end]) for begin, end in zip([0, *ends[:-1]], ends, strict=True)]
