"""What keeping a reading costs: the record beside SQLite in several journal modes; and opening 100,000 events.

`python benchmarks/bench_record.py`; figures for docs/decisions.
"""

from __future__ import annotations

import sqlite3
import statistics
import tempfile
import time
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

from axiscal.measurement.reading import Reading
from axiscal.record.events import Created, Event, Recorded
from axiscal.record.payload import encode
from axiscal.record.store import Record

COUNT = 300
EVENTS = 100_000
READING = Recorded(Reading("laser along X", (0.12, 0.25, 0.3), (1, 0, 0), 1.7e-6, time=12.5))
TABLE = "CREATE TABLE events (id INTEGER PRIMARY KEY, kind TEXT, payload TEXT, at TEXT) STRICT"
AT = "2026-01-01T00:00:00.000+00:00"


def main() -> None:
    with tempfile.TemporaryDirectory(dir=".") as name:
        folder = Path(name)
        print(f"milliseconds for one reading, on the disk when it returns (median of {COUNT}; the slowest of 100)")
        _show("record, one wait for the disk", _own(folder / "own.axiscal"))
        for mode, after in (("WAL", ""), ("WAL", "PRAGMA wal_checkpoint(TRUNCATE)"), ("DELETE", ""), ("TRUNCATE", "")):
            what = f"SQLite {mode}{', then a checkpoint' if after else ''}"
            _show(what, _sqlite(folder / f"{mode}{len(after)}.db", mode, after))
        _open(folder / "many.axiscal")


def _show(what: str, times: list[float]) -> None:
    times.sort()
    print(f"  {what:32} {1e3 * statistics.median(times):7.2f} {1e3 * times[int(0.99 * len(times))]:7.2f}")


def _timed(append: Callable[[], object]) -> list[float]:
    times = []
    for _ in range(COUNT):
        begin = time.perf_counter()
        append()
        times.append(time.perf_counter() - begin)
    return times


def _own(path: Path) -> list[float]:
    with Record.create(path, Created("", "", "", "", {})) as record:
        return _timed(lambda: record.append(READING))


def _sqlite(path: Path, mode: str, after: str) -> list[float]:
    with closing(sqlite3.connect(path, isolation_level=None)) as connection:
        connection.execute(f"PRAGMA journal_mode = {mode}")
        connection.execute("PRAGMA synchronous = FULL")
        connection.execute(TABLE)

        def append() -> None:
            row = (*encode(READING), AT)
            connection.execute("INSERT INTO events (kind, payload, at) VALUES (?, ?, ?)", row)
            if after:
                connection.execute(after).fetchall()

        return _timed(append)


def _open(path: Path) -> None:
    with Record.create(path, Created("", "", "", "", {})) as record:
        batch: list[Event] = [READING] * EVENTS
        record.append(*batch)
    begin = time.perf_counter()
    with Record.open(path, write=False) as record:
        count = len(record.state().readings)
    print(f"opening a record of {count} readings, {path.stat().st_size / 1e6:.0f} MB, every event checked")
    print(f"  {time.perf_counter() - begin:.2f} s")


if __name__ == "__main__":
    main()
