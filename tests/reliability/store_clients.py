"""A store on a server: clients whose connections are cut, and a measurer who sends it whatever SQL there is."""

from __future__ import annotations

import os
import random
import re
import signal
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from unittest.mock import patch
from uuid import uuid4

from axiscal.exceptions import RecordError
from axiscal.ports.postgres.database import VARIABLE, Database, store_address
from axiscal.ports.postgres.server_log import Entry, ServerLog, enter, entries
from axiscal.ports.postgres.syncing import synced
from axiscal.ports.postgres.tables import prepare
from axiscal.record.log import chained_texts, rows_of
from axiscal.record.store import Record
from tests.generators.sisters import read_on, slide, write_record
from tests.record.postgres_server import RunningServer, running_server
from tests.reliability.record_faults import CREATED, recorded
from tests.reliability.trial import Trial, scratch
from tests.zoo.running import given

UNFIT = ("", " ", "a\nb", 101 * "x", "../../evil", "/x", "-rf", "a\u202eb", "back\\slash", "a:b", "mill.", "a\u200bb")
"""Names that no file may have."""
SHARED, MEASURER = "shared", "measurer"
FIRST_LOOK = 10
"""Seconds at most."""
_CUT = "SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE usename = 'measurer'"


@contextmanager
def _store() -> Iterator[RunningServer]:
    """Yield a server with a store and the campaign that all write to."""
    with running_server() as server:
        keeper = Database(store_address(server.address()))
        prepare(keeper)
        keeper.select(f"CREATE ROLE {MEASURER} LOGIN IN ROLE axiscal_measurer")
        ServerLog.create(keeper, SHARED, CREATED)
        keeper.close()
        yield server


def _opened(server: RunningServer, user: str = MEASURER) -> Database:
    return Database(store_address(server.address(user=user)))


def _held(log: ServerLog) -> list[int]:
    return [int(reading.value) for reading in log.state().readings]


def clients(count: int, seconds: float, seed: int = 7) -> Trial:
    """Let processes append to one campaign, and sync records of their own, while connections are cut."""
    drawn, cuts = random.Random(seed), 0
    with scratch() as top, _store() as server:
        children = [_client(server, top / f"{number}", number) for number in range(1, count + 1)]
        keeper, end = _opened(server, "keeper"), time.monotonic() + seconds
        while time.monotonic() < end:
            time.sleep(drawn.uniform(0.1, 2.0))
            cuts += len(keeper.select(_CUT))
        for child in children:
            os.kill(child, signal.SIGTERM)
            os.waitpid(child, 0)
        said = [int(line) for path in top.glob("*.said") for line in path.read_text().split()]
        logs = [ServerLog(keeper, entry) for entry in entries(keeper)]
        for log in logs:
            log.last()
        kept = Counter(value for log in logs for value in _held(log))
        keeper.close()
    lost, twice = len(set(said) - set(kept)), sum(number - 1 for number in kept.values())
    detail = f"{cuts:,} connections cut, {lost} lost, {twice} twice"
    return Trial(f"readings of {count} clients of a store, cut off in {seconds:.0f} s", len(said), lost + twice, detail)


def _client(server: RunningServer, path: Path, number: int) -> int:
    """Begin a client, which writes down what was acknowledged; return its process."""
    child = os.fork()
    if child:
        return child
    ended = list[int]()
    signal.signal(signal.SIGTERM, lambda got, _frame: ended.append(got))
    with path.with_suffix(".said").open("a") as said:
        record, value, waiting = Record.create(path.with_suffix(".axiscal"), CREATED), 1_000_000 * number, list[int]()
        while not ended:
            value += 1
            if value % 2:
                _until_done(server, partial(_append_once, value))
                print(value, file=said, flush=True)
                continue
            record.append(recorded(float(value)))
            waiting.append(value)
            if len(waiting) == 5:
                _until_done(server, partial(synced, record=record, name=f"own {number}"))
                print(*waiting, file=said, flush=True)
                waiting.clear()
    os._exit(0)


def _until_done(server: RunningServer, work: Callable[[Database], object]) -> None:
    """Do some work over a connection until it is done: after each error anew, as the message asks."""
    done = False
    while not done:
        database = _opened(server)
        with suppress(RecordError):
            work(database)
            done = True
        database.close()


def _append_once(value: int, database: Database) -> None:
    """Append a reading if it is not there."""
    log = ServerLog.open(database, SHARED)
    if value not in _held(log):
        log.append(recorded(float(value)))


def names() -> Trial:
    """Enter campaigns under names that no file may have, and give a command such names: each is refused."""
    wrong, first = 0, chained_texts(rows_of([CREATED]))
    with _store() as server, patch.dict(os.environ, {VARIABLE: server.address(user=MEASURER)}):
        database = _opened(server)
        database.select("SET standard_conforming_strings = off")  # a backslash would hide a quotation mark
        for name in UNFIT:
            told = given("finish", f"store:{name}")
            said = " ".join(told.err.split())
            known = "cannot have this name" in said or "No campaign of the store is named" in said
            wrong += (told.status, told.out, said.partition(": ")[0]) != (1, "", "axiscal") or not known
            try:
                enter(database, Entry(str(uuid4()), name, None, None), first)
                wrong += 1
            except RecordError as refused:
                wrong += "cannot have this name" not in str(refused)
        database.close()
    return Trial("names of a store, `../../evil` to U+202E, each refused in a sentence", 2 * len(UNFIT), wrong)


def mended() -> Trial:
    """Take a name that is taken, set an entry aside that a laptop has, list a campaign without events.

    Each is refused in a sentence, or listed, and one command mends it.
    """
    found = list[bool]()
    with scratch() as top, _store() as server, patch.dict(os.environ, {VARIABLE: server.address()}):
        mine, other = top / "mine.axiscal", top / "other.axiscal"
        for number, path in enumerate((mine, other)):
            with Record.create(path, replace(CREATED, campaign_source=path.stem)) as record:
                record.append(*(recorded(float(3 * number + n)) for n in range(3)))

        def refused(words: Sequence[object], says: str, mends: Sequence[object]) -> None:
            told, after = given(*words), given(*mends)
            said = " ".join(told.err.split())
            found.append(told.status == 1 and said.startswith("axiscal: ") and says in said and "defect" not in said)
            found.append(after.status == 0)

        sync = ("sync", mine, "--name", "mill")
        found.append(given(*sync).status == 0)
        refused(("sync", other, "--name", "MILL"), "of this name already", ("sync", other, "--name", "mill b"))
        keeper = _opened(server, "keeper")
        found.append(given("sync", "--quarantine", f"store:{entries(keeper, 'mill')[0].id}:3").status == 0)
        refused(sync, "--drop", (*sync, "--drop"))
        keeper.select("INSERT INTO axiscal.campaigns VALUES (gen_random_uuid(), 'empty', NULL, NULL)")
        keeper.close()
        listed = given("fleet", "store:")
        found.append(listed.status == 0 and "mill b" in listed.out)
        third = top / "third.axiscal"
        Record.create(third, replace(CREATED, campaign_source="third")).close()
        refused(("finish", "store:empty"), "empty", ("sync", third, "--name", "empty"))
    what = "a name that is taken, an entry set aside, a campaign without events: refused in a sentence, then mended"
    return Trial(what, len(found), found.count(False))


def fleet(machines: int) -> Trial:
    """List a store of machines of sixteen readings each, for the first time."""
    readings = read_on(0)
    with scratch() as top, _store() as server, patch.dict(os.environ, {VARIABLE: server.address()}):
        keeper = _opened(server, "keeper")
        for number in range(machines):
            path = write_record(top / f"{number}.axiscal", slide(serial=str(number)), readings)
            with Record.open(path) as record:
                synced(keeper, record, f"machine {number}")
            path.unlink()
        keeper.close()
        begin = time.process_time()
        listed = given("fleet", "store:")
        spent = time.process_time() - begin
    missed = machines - len(set(re.findall(r"machine \d+", listed.out)))
    detail = f"first look {spent:.1f} s of processor time, at most {FIRST_LOOK}"
    return Trial("machines of a store that `fleet store:` lists", machines, missed + (spent > FIRST_LOOK), detail)


def _appended_by_sql(campaign: str) -> str:
    """Return a statement that adds an event behind the last one of a campaign, as a program of one's own may."""
    payload = """'{"text":""}'"""
    digest = f"encode(sha256(convert_to(concat_ws(' ', digest, 'noted', {payload}), 'UTF8')), 'hex')"
    return (
        f"SELECT axiscal.append(campaign, number, ARRAY['noted'], ARRAY[{payload}], ARRAY[at], ARRAY[{digest}]) "
        f"FROM axiscal.events WHERE campaign = '{campaign}' ORDER BY number DESC LIMIT 1"
    )


def _wild(drawn: random.Random, campaign: str) -> str:
    """Return a statement of somebody who means no good."""
    text = drawn.choice(
        ("''", "NULL", "'{}'", "repeat('x', 10000)", "E'\\n'", "'../../etc'", "'created'", "'recorded'")
    )
    which = drawn.choice((f"'{campaign}'", "gen_random_uuid()", "NULL"))
    number = drawn.choice(("0", "1", "-1", "NULL", "9223372036854775807"))
    seconds = drawn.choice((*9 * (0.1,), 6))
    arrays = ", ".join(drawn.choice((f"ARRAY[{text}]::text[]", "'{}'", "NULL", "ARRAY['a','b']")) for _ in range(4))
    return drawn.choice(
        (
            f"SELECT axiscal.append({which}, {number}, {arrays})",
            f"SELECT axiscal.enter({which}, {text}, {which}, {number}, {arrays})",
            f"SELECT axiscal.enter(gen_random_uuid(), 'made up {drawn.random()}', NULL, NULL, {arrays})",
            f"SELECT axiscal.saw({which}, {text}, {which}, {number})",
            f"INSERT INTO axiscal.events SELECT * FROM axiscal.events WHERE campaign = {which}",
            f"UPDATE axiscal.events SET payload = {text}",
            "DELETE FROM axiscal.campaigns",
            "START TRANSACTION; LOCK TABLE axiscal.events; SELECT pg_sleep(2); COMMIT",
            "START TRANSACTION; LOCK TABLE axiscal.events IN ACCESS SHARE MODE; SELECT pg_sleep(0.1); COMMIT",
            "SELECT pg_sleep(0.05)",
            "SELECT pg_advisory_lock(n) FROM generate_series(1, 100) AS n",
            f"START TRANSACTION; {_appended_by_sql(campaign)}; SELECT pg_sleep({seconds}); COMMIT",
            "ALTER TABLE axiscal.events DISABLE TRIGGER ALL",
            "DROP SCHEMA axiscal CASCADE",
        )
    )


def _readable(keeper: Database, entry: Entry) -> bool:
    with suppress(RecordError):
        ServerLog(keeper, entry).last()
        return True
    return False


def statements(count: int, seed: int = 11) -> Trial:
    """Send a store so many statements of a measurer while another one works, and read all campaigns afterwards."""
    drawn = random.Random(seed)
    with _store() as server:
        keeper = _opened(server, "keeper")
        campaign = entries(keeper, SHARED)[0].id
        child = os.fork()
        if child == 0:
            bad = _opened(server)
            for _ in range(count):
                with suppress(RecordError):
                    bad.select(_wild(drawn, campaign))
                with suppress(RecordError):
                    bad.select("ROLLBACK")  # else everything behind a refusal is refused unread
            os._exit(0)
        longest, value, ended = 0.0, 0, (0, 0)
        with ServerLog.open(_opened(server), SHARED) as log:
            while ended == (0, 0):
                begin, value = time.monotonic(), value + 1
                log.append(recorded(float(value)))
                longest = max(longest, time.monotonic() - begin)
                time.sleep(0.02)
                ended = os.waitpid(child, os.WNOHANG)
        assert not ended[1], "the measurer who means no good ended before all statements were sent"
        missed = sum(not _readable(keeper, entry) for entry in entries(keeper))
        with ServerLog.open(keeper, SHARED) as log:
            missed += _held(log) != list(range(1, value + 1))
    detail = f"another one waited {longest:.2f} s, at most 5"
    return Trial("statements of a measurer who means no good", count, missed + (longest > 5), detail)
