"""What the store of a shop costs: lists of records, and a PostgreSQL server with eight writers.

`python -m benchmarks.bench_store`; figures for docs/evidence/fleet.md. The server is its own and waits for its disk.
"""

from __future__ import annotations

import multiprocessing
import os
import statistics
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from axiscal.exceptions import OvertakenError
from axiscal.measurement.reading import Reading
from axiscal.ports.fleet.shop_list import shop_list
from axiscal.ports.postgres.database import Database, store_address
from axiscal.ports.postgres.server_log import ServerLog
from axiscal.ports.postgres.syncing import synced
from axiscal.ports.postgres.tables import prepare
from axiscal.record.copies import opened_log, records_of
from axiscal.record.events import Created, Event, Recorded
from axiscal.record.log import STORED, chained_texts
from axiscal.record.store import Record
from tests.generators.sisters import read_on, slide, write_record
from tests.record.postgres_server import running_server

RECORDS, EVENTS, MACHINES, WRITERS, EACH = 200, 500, 1_000, 8, 200
CREATED = Created("", "", "", "", {})


def reading(value: float) -> Recorded:
    return Recorded(Reading("laser along X", (0.12, 0.25, 0.3), (1, 0, 0), value, time=12.5))


def main() -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        _folder(folder)
        with running_server(durable=True) as server:
            address = server.address()
            database = Database(store_address(address))
            prepare(database)
            _listed(database, address, folder)
            _sent(database, folder)
            _raw(address)
            _own(address)
            _raw(address)
            _one(address)
            database.close()


def _folder(folder: Path) -> None:
    for number in range(RECORDS):
        events: list[Event] = [reading(1e-9 * n) for n in range(EVENTS - 1)]
        with Record.create(folder / f"{number:03}.axiscal", Created("", "", "", str(number), {})) as record:
            record.append(*events)
    spent = _processor(lambda: _read(folder))
    print(f"{RECORDS * EVENTS} events in {RECORDS} records, read as a list does: {spent:.2f} s")


def _read(folder: Path) -> None:
    for file in records_of(folder):
        with opened_log(file, write=False) as record:
            record.texts()


def _listed(database: Database, address: str, folder: Path) -> None:
    """A shop of a thousand machines of 16 readings, listed by its server."""
    readings, copied = read_on(0), folder / "copied.axiscal"
    for number in range(MACHINES):
        write_record(copied, slide(serial=str(number)), readings)
        with Record.open(copied) as record:
            synced(database, record, f"machine {number}")
        copied.unlink()
    os.environ["AXISCAL_STORE"] = address
    spent = _seconds(lambda: shop_list(Path(STORED)))
    print(f"list of a store of {MACHINES} machines, first look: {spent:.1f} s")


def _seconds(work: Callable[[], object]) -> float:
    begin = time.perf_counter()
    work()
    return time.perf_counter() - begin


def _processor(work: Callable[[], object]) -> float:
    begin = time.process_time()
    work()
    return time.process_time() - begin


def _sent(database: Database, folder: Path) -> None:
    begin = time.perf_counter()
    for file in sorted(folder.glob("*.axiscal")):
        with Record.open(file) as record:
            synced(database, record, file.stem)
    print(f"sent to PostgreSQL by sync, a transaction a record: {time.perf_counter() - begin:.1f} s")


def _raw(address: str) -> None:
    """The same writers with one plain INSERT a commit, by the same driver: what server, disk and computer can do."""
    database = Database(store_address(address))
    database.select("CREATE TABLE IF NOT EXISTS raw (writer integer, number integer, payload text)")
    database.close()
    with multiprocessing.Pool(WRITERS) as pool:
        spans = pool.starmap(_write_raw, [(address, number) for number in range(WRITERS)])
    wall = max(end for _, end in spans) - min(begin for begin, _ in spans)
    print(f"{WRITERS} writers, a plain INSERT each time, no store: {WRITERS * EACH / wall:.0f} commits/s")


def _write_raw(address: str, number: int) -> tuple[float, float]:
    database, payload = Database(store_address(address)), "x" * 150
    database.select("SELECT 1")
    begin = time.monotonic()
    for n in range(EACH):
        database.select("INSERT INTO raw VALUES (:writer, :number, :payload)", writer=number, number=n, payload=payload)
    end = time.monotonic()
    database.close()
    return begin, end


def _own(address: str) -> None:
    """Eight writers, each in a campaign of its own: one commit an event."""
    with multiprocessing.Pool(WRITERS) as pool:
        spans = pool.starmap(_write, [(address, number) for number in range(WRITERS)])
    waits = sorted(wait for _, _, each in spans for wait in each)
    wall = max(end for _, end, _ in spans) - min(begin for begin, _, _ in spans)
    rate, late = len(waits) / wall, waits[int(0.99 * len(waits))]
    said = f"median {1e3 * statistics.median(waits):.1f} ms, p99 {1e3 * late:.0f} ms"
    print(f"{WRITERS} writers, a campaign each: {rate:.0f} commits/s, {said}")


def _write(address: str, number: int) -> tuple[float, float, list[float]]:
    waits = list[float]()
    with ServerLog.create(
        Database(store_address(address)), f"own {number}", Created("", "", "", str(number), {})
    ) as log:
        begin = time.monotonic()
        for n in range(EACH):
            waits.append(_seconds(lambda n=n: log.append(reading(1e-9 * n))))  # type: ignore[misc]
        return begin, time.monotonic(), waits


def _one(address: str) -> None:
    """Eight writers fight for one campaign: what each was told is kept is there, without a gap."""
    with ServerLog.create(Database(store_address(address)), "one", CREATED) as log:
        with multiprocessing.Pool(WRITERS) as pool:
            told = pool.starmap(_fight, [(address, number) for number in range(WRITERS)])
        won = sorted(value for values, _ in told for value in values)
        kept = sorted(each.value for each in log.state().readings)
        whole = tuple(chained_texts(text.row for text in log.texts())) == log.texts()
        numbers = [stored.number for stored in log.events()]
    refused, gaps = sum(count for _, count in told), numbers != list(range(1, len(numbers) + 1))
    lost, more = len(set(won) - set(kept)), len(set(kept) - set(won))
    print(f"{WRITERS} writers, one campaign: {len(won)} won, {refused} refused")
    print(f"  lost {lost}, not acknowledged {more}, gaps {int(gaps)}, chain {'whole' if whole else 'broken'}")


def _fight(address: str, number: int) -> tuple[list[float], int]:
    won, refused = list[float](), 0
    with ServerLog.open(Database(store_address(address)), "one") as log:
        for n in range(EACH):
            value = 1e-9 * (number * EACH + n)
            try:
                log.append(reading(value), after=log.last())
                won.append(value)
            except OvertakenError:
                refused += 1
    return won, refused


if __name__ == "__main__":
    main()
