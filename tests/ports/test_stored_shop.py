"""What is asked of a folder of records is asked of the store by the same door, with the same answers."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any
from unittest.mock import patch

import pytest

from axiscal.campaign.beginning import campaign_with_sisters
from axiscal.cli.app import run
from axiscal.exceptions import RecordError, UnreachableError
from axiscal.ports.fleet.shop_list import shop_list
from axiscal.ports.postgres import database
from axiscal.ports.postgres.database import Database, store_address
from axiscal.ports.postgres.server_log import ServerLog, insert
from axiscal.ports.postgres.syncing import Synced, synced
from axiscal.ports.postgres.tables import prepare
from axiscal.record.copies import opened_log, records_of
from axiscal.record.log import campaign_of
from axiscal.record.store import Record
from tests.generators.sisters import CAMPAIGN, MACHINE, read_on, shop, slide, write_record
from tests.record.postgres_server import RunningServer, running_server

STORE = Path("store:")


@pytest.fixture(scope="module")
def server() -> Iterator[RunningServer]:
    """Yield a server of this file's own: one test takes it away."""
    with running_server() as found:
        yield found


@pytest.fixture(scope="module")
def folder(server: RunningServer, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder of records, all of which are in the store too."""
    folder = tmp_path_factory.mktemp("records")
    stock(server, folder)
    return folder


def stock(server: RunningServer, folder: Path) -> None:
    """Write records of a shop into a folder, and bring them into a store."""
    shop(folder, 3)
    write_record(folder / "again.axiscal", slide(serial="7"), read_on(5))
    database = Database(store_address(server.address()))
    prepare(database)
    for file in folder.glob("*.axiscal"):
        sent(database, file)
    database.close()


@pytest.fixture
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[RunningServer]:
    """Name a store with the same records that a test may add to."""
    (tmp_path / "records").mkdir()
    with running_server() as found:
        stock(found, tmp_path / "records")
        monkeypatch.setenv("AXISCAL_STORE", found.address())
        yield found


@pytest.fixture(autouse=True)
def store(folder: Path, server: RunningServer, monkeypatch: pytest.MonkeyPatch) -> None:
    """Name the store."""
    monkeypatch.setenv("AXISCAL_STORE", server.address())


def sent(database: Database, file: Path) -> Synced:
    """Bring a record and the store together."""
    with Record.open(file) as record:
        return synced(database, record, file.stem)


def test_a_campaign_names_a_type_in_the_store(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "machine.toml").write_text(MACHINE.format(serial="", travel=500))
    text = CAMPAIGN.format(first="") + '\n[sisters]\ntype = "Slide"\n'
    (tmp_path / "campaign.toml").write_text(text)
    assert "store:slide-1" in campaign_with_sisters(tmp_path / "campaign.toml").prior_text
    (tmp_path / "campaign.toml").write_text(text.replace('"Slide"', '"Lathe"'))
    with pytest.raises(RecordError, match=r'None of the records is of a machine "Lathe".*"Slide"'):
        campaign_with_sisters(tmp_path / "campaign.toml")


def test_a_store_is_listed_over_one_connection(folder: Path) -> None:
    with patch.object(database, "_connected", wraps=database._connected) as connected:
        found = shop_list(STORE)
    assert connected.call_count == 1
    assert next(each.copy.file.name for each in found.listed) == "store:again"
    assert {each.copy.chain for each in found.listed} == {each.copy.chain for each in shop_list(folder).listed}


def test_campaigns_of_before_with_one_name_or_one_of_no_file_are_named_by_their_ids(
    own: RunningServer, tmp_path: Path
) -> None:
    database = Database(store_address(own.address()))
    for seed, name in ((7, "slide-1"), (8, "../../evil")):
        file = tmp_path / f"{seed}.axiscal"
        write_record(file, slide(), read_on(seed))
        with Record.open(file, write=False) as record:
            texts = record.texts()
        database.select(
            "INSERT INTO axiscal.campaigns VALUES (CAST(:id AS uuid), :name)", id=campaign_of(texts[0]), name=name
        )
        insert(database, campaign_of(texts[0]), 0, texts)
    database.close()
    names = [path.name for path in records_of(STORE)]
    assert "store:slide-1" not in names
    assert "store:../../evil" not in names
    for name in names:
        with opened_log(name, write=False) as log:
            assert log.last() > 0


def test_a_store_that_goes_away_leaves_nothing_out(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    made, count = ServerLog.__init__, [0]

    def gone_after_two(log: ServerLog, database: Database, *entry: Any, **how: Any) -> None:
        count[0] += 1
        if count[0] > 2:
            database.address = store_address("postgresql://nobody@/none?host=/nowhere")
            database.close()
        made(log, database, *entry, **how)

    monkeypatch.setattr(ServerLog, "__init__", gone_after_two)
    for command in (["due", "store:"], ["type", "learn", "store:"], ["fleet", "store:"]):
        count[0] = 0
        assert run(command) == 1
        captured = capsys.readouterr()
        assert captured.out == ""
        assert "The store does not answer" in " ".join(captured.err.split())
    with pytest.raises(UnreachableError):
        shop_list(STORE)
