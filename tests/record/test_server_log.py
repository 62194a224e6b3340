"""The store on a server: what it refuses whoever asks, what is said where it is not there, and commands over it."""

from __future__ import annotations

import json
import time
import zlib
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from threading import Event, Thread

import pytest

from axiscal.cli.app import run
from axiscal.exceptions import OvertakenError, RecordError, UnreachableError
from axiscal.measurement.reading import Reading
from axiscal.ports.postgres import database as database_module
from axiscal.ports.postgres.database import Database, opened_database, store_address
from axiscal.ports.postgres.server_log import Entry, ServerLog, enter, entries, insert
from axiscal.ports.postgres.tables import prepare
from axiscal.record.copies import opened_log
from axiscal.record.events import Created, Noted, Recorded
from axiscal.record.line_form import EventText, chained
from axiscal.record.log import ChainedText, chained_texts, rows_of
from axiscal.record.store import Record
from tests.commands import Command
from tests.generators.sisters import CAMPAIGN, MACHINE
from tests.record.postgres_server import END_SESSIONS, RunningServer, cut_off, running_server

ROOT = Path(__file__).resolve().parents[2]
CREATED = Created("name = 'mill'", "machine = 'mill'", "machine.toml", "campaign.toml", {})
AT = "2026-03-01T08:00:00.000+00:00"
READING = Recorded(Reading("laser", (0.1, 0.2), (1, 0), 1e-6))
_NEXT = "1 + (SELECT max(number) FROM axiscal.events AS e WHERE e.campaign = events.campaign)"
_INSERT = (
    "INSERT INTO axiscal.events (campaign, number, kind, payload, at, digest) "
    "SELECT campaign, {number}, kind, {payload}, at, {digest} FROM axiscal.events "
    "WHERE number = 1 ORDER BY at DESC LIMIT 1"
)


FIRST = chained_texts(rows_of([CREATED]))
ID = "00000000-0000-0000-0000-000000000002"


def as_user(server: RunningServer, user: str) -> Database:
    return Database(store_address(server.address(user=user)))


def name_of(request: pytest.FixtureRequest) -> str:
    """Return a name that no other test gives a campaign."""
    name = str(request.node.name)
    return f"{''.join(filter(str.isalnum, name))[:60]} {zlib.crc32(name.encode()):08x}"


@pytest.fixture
def log(database: Database, request: pytest.FixtureRequest) -> ServerLog:
    """Return a campaign with two readings."""
    made = ServerLog.create(database, name_of(request), CREATED)
    made.append(READING, READING)
    return made


CHANGES = (
    "UPDATE axiscal.events SET payload = ''",
    "DELETE FROM axiscal.events",
    "TRUNCATE axiscal.events CASCADE",
    "UPDATE axiscal.campaigns SET name = ''",
    "DELETE FROM axiscal.campaigns",
    "UPDATE axiscal.events SET writer = 'somebody else'",
)


@pytest.mark.parametrize("user", ["keeper", "measurer", "reader", "stranger"])
def test_nobody_changes_or_deletes_and_its_owner_neither(server: RunningServer, log: ServerLog, user: str) -> None:
    before = log.texts()
    other = as_user(server, user)
    for change in CHANGES:
        with pytest.raises(RecordError, match="may not do that"):
            other.select(change)
        assert log.texts() == before, change
    other.close()


def test_who_may_read_and_who_may_add(server: RunningServer, log: ServerLog) -> None:
    name = log.entry.name
    for user, may in (("measurer", True), ("reader", False)):
        with ServerLog.open(as_user(server, user), name) as opened:
            assert opened.state().readings == log.state().readings
            if may:
                assert opened.append(READING) == 4
            else:
                with pytest.raises(RecordError, match="axiscal_measurer"):
                    opened.append(READING)
    with pytest.raises(RecordError, match="axiscal_reader"):
        ServerLog.open(as_user(server, "stranger"), name)
    writers = log._database.select(
        "SELECT DISTINCT writer FROM axiscal.events WHERE number = 4 AND writer = 'measurer'"
    )
    assert writers == [["measurer"]]


@pytest.mark.parametrize(
    ("number", "payload", "digest", "said"),
    [
        ("9", "payload", "digest", "no event before it"),
        ("0", "payload", "digest", "does not follow"),
        (_NEXT, "'{}'", "digest", "another"),
    ],
)
def test_the_server_itself_refuses_what_does_not_follow(
    log: ServerLog, number: str, payload: str, digest: str, said: str
) -> None:
    with pytest.raises(RecordError, match=said):
        log._database.select(_INSERT.format(number=number, payload=payload, digest=digest))
    assert log.last() == 3


def unguarded(log: ServerLog, change: str) -> None:
    """Change events of a campaign behind the back of the store."""
    log._database.select("ALTER TABLE axiscal.events DISABLE TRIGGER keep")
    try:
        log._database.select(f"{change} AND campaign = CAST(:id AS uuid)", id=log.entry.id)
    finally:
        log._database.select("ALTER TABLE axiscal.events ENABLE TRIGGER keep")


def test_what_was_changed_behind_its_back_is_said(log: ServerLog, database: Database) -> None:
    unguarded(log, "UPDATE axiscal.events SET payload = replace(payload, '1e-06', '2e-06') WHERE number = 2")
    with pytest.raises(RecordError, match="damaged: event 2 does not follow"):
        ServerLog.open(database, log.entry.name)


def test_two_campaigns_of_one_name_are_refused_and_an_id_names_one(log: ServerLog, database: Database) -> None:
    with pytest.raises(RecordError, match="of this name already"):
        ServerLog.create(database, log.entry.name, CREATED)
    assert ServerLog.open(database, log.entry.id[:10]).last() == 3
    with pytest.raises(RecordError, match="no such campaign"):
        ServerLog.open(database, log.entry.id[:5])


@pytest.mark.parametrize("name", ["it's", "'); DROP SCHEMA axiscal CASCADE; --", "µ ☃", "%s"])
def test_a_name_is_never_a_part_of_a_query(database: Database, name: str, request: pytest.FixtureRequest) -> None:
    name = f"{name} {name_of(request)}"
    database.select("SET standard_conforming_strings = off")  # a backslash would hide a quotation mark
    ServerLog.create(database, name, CREATED).append(READING, after=1)
    assert ServerLog.open(database, name).last() == 2


def test_a_name_that_is_no_text_is_a_sentence(database: Database) -> None:
    with pytest.raises(RecordError, match="cannot have this name"):
        ServerLog.create(database, "M\udcfcller", CREATED)


def test_a_branch_needs_another_campaign_to_branch_off(log: ServerLog, database: Database) -> None:
    id_of_none = "00000000-0000-0000-0000-000000000001"
    for branch_of, branch_at in ((id_of_none, 1), (log.entry.id, 0)):
        with pytest.raises(RecordError, match="a branch needs the event"):
            enter(database, Entry(id_of_none, "endless", branch_of, branch_at), FIRST)
    with pytest.raises(RecordError, match="name of its campaign"):
        enter(database, Entry(ID, "another", log.entry.id, 2), FIRST)


def test_an_answer_that_was_not_waited_for_is_not_taken_for_the_next_one(
    log: ServerLog, database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    from pg8000.native import Connection

    def interrupted(connection: Connection, context: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(Connection, "handle_messages", interrupted)
        with pytest.raises(KeyboardInterrupt):
            database.select("SELECT 1")
    assert database.select("SELECT 2") == [[2]]


ADDRESSES: dict[str, Callable[[RunningServer], str]] = {
    "no store is named": lambda server: "",
    "no address of a store": lambda server: "mysql://host/db",
    "no address": lambda server: "postgresql://host:port/db",
    "is not known": lambda server: f"{server.address()}&sslmode=perhaps",
    "has no such database": lambda server: server.address("nowhere"),
    "does not let this user in": lambda server: server.address(user="nobody-here"),
    "does not answer": lambda server: f"postgresql://a:secret@/db?host={server.folder}/gone",
    "no store yet": lambda server: server.address("template1"),
}


@pytest.mark.parametrize("said", ADDRESSES)
def test_what_is_wrong_with_the_store_is_a_sentence(
    server: RunningServer, said: str, monkeypatch: pytest.MonkeyPatch, command: Command
) -> None:
    monkeypatch.setenv("AXISCAL_STORE", ADDRESSES[said](server))
    told = command("status", "store:mill").refusal
    assert said in told.replace("No store", "no store")
    assert "secret" not in told
    assert "Traceback" not in told


def test_without_its_driver_it_is_said_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "pg8000", None)
    with pytest.raises(RecordError, match=r"pip install 'axiscal\[postgres\]'"):
        opened_database("postgresql://host/db")


def test_addresses_are_read_as_postgresqls_own_programs_read_them() -> None:
    surroundings = {"PGPASSWORD": "p", "PGUSER": "anna", "PGPORT": "6000", "PGHOST": "elsewhere"}
    assert store_address("postgresql:///shop", surroundings).shown == "postgresql://anna@elsewhere:6000/shop"
    given = store_address("postgresql://b%40d:x@host:5433/shop?sslmode=verify-full", surroundings)
    assert (given.user, given.password, given.sslmode) == ("b@d", "x", "verify-full")
    assert store_address(None, {"AXISCAL_STORE": "postgres://u@h/d", "PGSSLMODE": "require"}).sslmode == "require"


def test_a_server_that_goes_away_and_comes_back_has_lost_nothing() -> None:
    with running_server() as server:
        database = Database(store_address(server.address()))
        prepare(database)
        assert not prepare(database)
        log = ServerLog.create(database, "mill", CREATED)
        assert log.append(READING, after=1) == 2
        server.stop()
        with pytest.raises(RecordError, match="does not answer"):
            log.append(READING, after=2)
        with pytest.raises(RecordError, match="does not answer"):
            log.state()
        server.start()
        assert log.append(READING, after=2) == 3
        assert [stored.event for stored in ServerLog.open(database, "mill").events()] == [CREATED, READING, READING]
        _ended_in_the_middle(server, database, log)
        _ended_while_it_was_asked_once(server, database, log)
        log.close()


def _ended_in_the_middle(server: RunningServer, database: Database, log: ServerLog) -> None:
    """End our session before each statement of an append: it is there whole or not at all, and can be given again."""
    keeper, told = Database(store_address(server.address())), list[str]()
    for nth in range(4):
        last = log.last()
        database.at_once = lambda query, **values: False  # type: ignore[method-assign]
        try:
            with cut_off(database, keeper, nth):
                log.append(READING, READING, after=last)
        except RecordError as failure:
            told.append(failure.what)
        finally:
            del database.at_once
        assert log.last() in (last, last + 2)
        assert log.append(READING, after=log.last()) == log.last()
    assert len(told) == 3  # before the first statement nothing has begun: it is asked again over a new connection
    assert "is not known" in told[-1]
    keeper.close()


def _ended_while_it_was_asked_once(server: RunningServer, database: Database, log: ServerLog) -> None:
    """End our session around the one question of an append: nothing is said where it can be seen what is kept."""
    keeper = Database(store_address(server.address()))
    speaks, asked = database_module._speaks, database.at_once

    def dropped(line: int) -> bool:
        keeper.select(END_SESSIONS)
        return speaks(line)

    def dropped_after_a_look(line: int) -> bool:
        keeper.select(END_SESSIONS)
        return False

    for each in (dropped, dropped_after_a_look):
        last = log.last()
        database_module._speaks = each
        try:
            assert log.append(READING, READING, after=last) == last + 2
        finally:
            database_module._speaks = speaks
        assert log.last() == last + 2

    def unheard(query: str, **values: object) -> bool:
        assert asked(query, **values)
        if gone:
            server.stop()
        raise UnreachableError("The store does not answer", "Give the command again", "store")

    last = log.last()
    database.at_once = unheard  # type: ignore[method-assign]
    gone = False
    assert log.append(READING, READING, after=last) == last + 2 == log.last()
    gone = True
    with pytest.raises(RecordError, match="whether the last entry is kept is not known"):
        log.append(READING, after=last + 2)
    del database.at_once
    server.start()
    assert log.last() == last + 3
    keeper.close()


@pytest.mark.parametrize("known", [True, False])
def test_what_the_server_still_does_while_its_answer_is_lost_is_kept_once(
    known: bool, log: ServerLog, database: Database, address: str
) -> None:
    other, begun, at_work = Database(store_address(address)), Event(), list[Thread]()

    def done_later(query: str, values: dict[str, object]) -> None:
        with suppress(OvertakenError):
            other._tried(lambda: slowly(query, values))

    def slowly(query: str, values: dict[str, object]) -> None:
        other.select(query, **values)
        begun.set()
        time.sleep(0.5)  # a look in the meantime finds nothing

    def unheard(query: str, **values: object) -> bool:
        at_work.append(Thread(target=done_later, args=(query, values)))
        at_work[0].start()
        assert begun.wait(20.0)
        raise UnreachableError("The store does not answer", "Give the command again", "store")

    database.at_once = unheard  # type: ignore[method-assign]
    try:
        assert log.append(READING, READING, after=3 if known else None) == 5
    finally:
        del database.at_once
    at_work[0].join(20.0)  # its own answer may still be on the way
    assert log.last() == 5
    other.close()


def test_an_append_is_one_question_to_the_server(log: ServerLog, database: Database) -> None:
    def never(query: str, **values: object) -> list[list[object]]:
        raise AssertionError(query)

    database.select = never  # type: ignore[method-assign]
    try:
        assert [log.append(READING) for _ in range(3)] == [4, 5, 6]
    finally:
        del database.select


def test_what_is_put_back_is_said_by_the_one_question_too(log: ServerLog) -> None:
    unguarded(log, "DELETE FROM axiscal.events WHERE number = 3")
    with pytest.raises(RecordError, match="an older state of the store"):
        log.append(READING)


@pytest.mark.parametrize(
    ("kind", "payload", "at"),
    [
        ("noted", "[1]", AT),
        ("noted", "no text", AT),
        ("not a kind", "{}", AT),
        ("created", "{}", AT),
        ("noted", "{}", "yesterday"),
    ],
)
def test_the_store_takes_from_no_client_what_is_no_event(
    server: RunningServer, log: ServerLog, kind: str, payload: str, at: str
) -> None:
    measurer = as_user(server, "measurer")
    row = EventText(at, kind, payload)
    with pytest.raises(RecordError, match="The store refuses it"):
        insert(measurer, log.entry.id, 3, [ChainedText(row, chained(log.name, row))])
    with pytest.raises(RecordError, match="axiscal_measurer"):
        measurer.select(_INSERT.format(number=_NEXT, payload="payload", digest="digest"))
    measurer.close()
    assert log.last() == 3


def test_a_campaign_needs_an_event_and_a_name_of_its_own_and_one_of_before_without_is_passed_over(
    log: ServerLog, database: Database
) -> None:
    with pytest.raises(RecordError, match="begins with an event"):
        enter(database, Entry(ID, "empty", None, None), [])
    with pytest.raises(RecordError, match="another campaign has this name"):
        enter(database, Entry(ID, log.entry.name.upper(), None, None), FIRST)
    evil = "../../evil"
    database.select("INSERT INTO axiscal.campaigns VALUES (CAST(:id AS uuid), :name)", id=ID, name=evil)
    assert evil not in [entry.name for entry in entries(database)]
    with ServerLog.create(database, f"{log.entry.name} more", CREATED) as more:
        assert more.last() == 1


@pytest.mark.parametrize("form", [1, 2, 3])
def test_a_store_of_before_is_prepared_once_more(server: RunningServer, database: Database, form: int) -> None:
    database.select(f"CREATE DATABASE earlier{form}")
    earlier = Database(store_address(server.address(f"earlier{form}")))
    for script in range(1, form + 1):
        earlier.select((ROOT / "tests" / "record" / "earlier" / f"store-{script}.sql").read_text())
    with pytest.raises(RecordError, match="sync --prepare"):
        ServerLog.create(earlier, "mill", CREATED)
    assert [prepare(earlier), prepare(earlier)] == [True, False]
    with ServerLog.create(earlier, "mill", CREATED) as log:
        assert log.append(READING) == 2


def test_a_newer_store_is_refused(server: RunningServer, database: Database) -> None:
    database.select("CREATE DATABASE newer")
    newer = Database(store_address(server.address("newer")))
    prepare(newer)
    newer.select("INSERT INTO axiscal.form VALUES (99)")
    with pytest.raises(RecordError, match="newer axiscal"):
        ServerLog.create(newer, "mill", CREATED)
    newer.close()


HELD = {
    "advisory locks": "SELECT pg_advisory_lock(n) FROM generate_series(-100, 100) AS n",
    "a table": "LOCK TABLE axiscal.events, axiscal.campaigns IN ACCESS SHARE MODE",
    "all events, read": "SELECT count(*) FROM axiscal.events JOIN axiscal.campaigns ON id = campaign",
    "an event of its own": "SELECT 1",
}


@pytest.mark.parametrize("statement", HELD.values(), ids=HELD)
def test_what_a_measurer_holds_open_stops_nobody(log: ServerLog, server: RunningServer, statement: str) -> None:
    """Somebody adds an event, keeps the transaction open, and ends it after others have added theirs."""
    measurer, row = as_user(server, "measurer"), EventText(AT, "noted", '{"text":"mine"}')
    other = ServerLog.open(as_user(server, "measurer"), log.entry.id)

    def kept_open() -> None:
        measurer.select(statement)
        insert(measurer, log.entry.id, 3, [ChainedText(row, chained(log.name, row))])
        assert [log.append(Noted("x")), other.append(Noted("y")), log.append(Noted("z"))] == [4, 5, 6]

    with pytest.raises(OvertakenError, match="in the meantime"):
        measurer._tried(kept_open)
    measurer.close()
    other.close()
    assert log.last() == 6


def test_an_entry_that_is_none_is_set_aside_by_the_owner_alone(
    log: ServerLog, server: RunningServer, address: str, command: Command
) -> None:
    measurer = as_user(server, "measurer")
    bad = [EventText(AT, "recorded", "{}"), EventText(AT, "noted", '{"text":"behind it"}')]
    before, texts = log.state(), chained_texts(bad, log.name)
    insert(measurer, log.entry.id, 3, texts)
    with pytest.raises(RecordError, match=r"event 4: .*--quarantine store:.*:4"):
        ServerLog.open(as_user(server, "measurer"), log.entry.id)
    words = ["sync", "--quarantine", f"store:{log.entry.id}:4", "--store"]
    assert "may not do that" in command(*words, server.address(user="measurer")).refusal
    assert "2 events from 4 on set aside" in command(*words, address).printed
    again = ServerLog.open(as_user(server, "measurer"), log.entry.id)
    assert again.state() == before
    assert again.append(READING) == 4
    with pytest.raises(RecordError, match="was set aside"):  # a laptop that still has it cannot bring it back
        insert(measurer, log.entry.id, 4, texts[:1])
    assert log._database.select("SELECT count(*) FROM axiscal.events WHERE payload = '{}'")[0][0] >= 1
    for text in ("store:4", f"store:{log.entry.id}:x"):
        assert run(["sync", "--quarantine", text, "--store", address]) == 2
    assert run(["sync", "--quarantine", f"store:{log.entry.id}:1", "--store", address]) == 1
    again.close()
    measurer.close()


def test_only_serializable_transactions_add_events(log: ServerLog, server: RunningServer) -> None:
    measurer, row = as_user(server, "measurer"), EventText(AT, "noted", '{"text":"mine"}')
    measurer.select("SET default_transaction_isolation = 'read committed'")
    with pytest.raises(RecordError, match="only a serializable transaction"):
        insert(measurer, log.entry.id, 3, [ChainedText(row, chained(log.name, row))])
    measurer.close()
    assert log.last() == 3


def test_commands_go_on_over_the_store(
    address: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("AXISCAL_STORE", address)
    monkeypatch.chdir(tmp_path)
    Path("machine.toml").write_text(MACHINE.format(serial='serial = "7"\n', travel=500))
    Path("campaign.toml").write_text(CAMPAIGN.format(first="").replace('rms = "2 um"', "readings = 4"))
    assert run(["start", "campaign.toml", "store:mill 7"]) == 0, capsys.readouterr().err
    assert run(["start", "campaign.toml", "store:mill 7"]) == 1
    for value in range(4):
        assert run(["next", "store:mill 7"]) == 0
        assert run(["record", "store:mill 7", f"{value} um"]) == 0
    assert run(["undo", "store:mill 7"]) == 0
    assert run(["record", "store:mill 7", "3.5 um"]) == 0
    assert run(["finish", "store:mill 7", "--out", "results"]) == 0
    assert json.loads(Path("results/result.json").read_text())["readings"] == 4
    assert run(["copy", "store:mill 7"]) == 0
    capsys.readouterr()
    with opened_log("store:mill 7", write=False) as there, Record.open("mill 7.axiscal") as copied:
        assert copied.state() == there.state()
    with pytest.raises(RecordError, match="No campaign of the store"):
        opened_log("store:")
    assert {path.name for path in tmp_path.iterdir()} == {"machine.toml", "campaign.toml", "results", "mill 7.axiscal"}
