"""A laptop and the store: seven cases, nothing lost, nothing merged, whatever goes away in the middle."""

from __future__ import annotations

import itertools
import json
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from axiscal.cli.app import run
from axiscal.exceptions import RecordError
from axiscal.ports.postgres.database import Database, store_address
from axiscal.ports.postgres.server_log import ServerLog, entries
from axiscal.ports.postgres.syncing import Synced, synced
from axiscal.record.copies import write_copy
from axiscal.record.events import Created, Noted
from axiscal.record.log import ChainedText
from axiscal.record.store import Record
from tests.commands import Command
from tests.record.postgres_server import RunningServer, cut_off

_numbers = itertools.count()


class Shop:
    """Laptops with copies of one campaign, and the store."""

    def __init__(self, database: Database, folder: Path) -> None:
        self.database, self.folder, self.name = database, folder, f"shop {next(_numbers)} {folder.parent.name}"
        folder.mkdir(exist_ok=True)
        with Record.create(self.file("one"), Created("", "", "", self.name, {})) as record:
            record.append(Noted("first"), Noted("second"))

    def file(self, laptop: str) -> Path:
        """Return the record of a laptop."""
        return self.folder / f"{laptop}.axiscal"

    def copied(self, laptop: str) -> None:
        """Give another laptop a copy of the first one's record."""
        with Record.open(self.file("one"), write=False) as record:
            write_copy(record, self.file(laptop))

    def went_on(self, laptop: str, *texts: str) -> None:
        """Add events on a laptop."""
        with Record.open(self.file(laptop)) as record:
            record.append(*map(Noted, texts))

    def synced(self, laptop: str) -> Synced:
        """Bring a laptop and the store together."""
        with Record.open(self.file(laptop)) as record:
            return synced(self.database, record, self.name)

    def texts(self, laptop: str) -> tuple[ChainedText, ...]:
        """Return what a laptop has."""
        with Record.open(self.file(laptop), write=False) as record:
            return record.texts()

    def chains(self, of: Synced | None = None) -> list[str]:
        """Return the chains of what the store has of a campaign, with what it branches off; of all its campaigns."""
        found = [of.campaign] if of is not None else entries(self.database, self.name)
        return [text.chain for entry in found for text in ServerLog(self.database, entry).texts()]


@pytest.fixture
def shop(database: Database, tmp_path: Path) -> Shop:
    return Shop(database, tmp_path)


def test_the_seven_cases(shop: Shop) -> None:
    new = shop.synced("one")
    assert (new.case, new.sent, shop.synced("one").case) == ("new", 3, "same")
    shop.copied("two")
    shop.went_on("one", "third")
    assert (shop.synced("one").case, shop.synced("two").case) == ("ahead", "behind")
    assert [text.chain for text in shop.texts("one")] == [text.chain for text in shop.texts("two")]
    shop.went_on("one", "of one")
    shop.went_on("two", "of two", "and more")
    assert shop.synced("one").case == "ahead"
    fork = shop.synced("two")
    assert (fork.case, fork.sent, fork.campaign.branch_of, fork.campaign.branch_at) == ("fork", 2, new.campaign.id, 4)
    assert shop.synced("two").case == "fork again"
    shop.went_on("two", "still more")
    goes_on = shop.synced("two")
    assert (goes_on.case, goes_on.sent, goes_on.campaign) == ("fork goes on", 1, fork.campaign)
    for laptop, found in (("one", new), ("two", goes_on)):
        assert shop.chains(found) == [text.chain for text in shop.texts(laptop)]
    assert len(entries(shop.database, shop.name)) == 2


def test_a_branch_leaves_its_campaign_the_name_and_is_asked_for_by_its_id(shop: Shop) -> None:
    shop.synced("one")
    shop.copied("two")
    for laptop in ("one", "two"):
        shop.went_on(laptop, f"of {laptop}")
    main, branch = (shop.synced(laptop).campaign for laptop in ("one", "two"))
    for entry in (main, branch):
        with ServerLog.open(shop.database, entry.called) as log:
            assert log.entry == entry
            assert str(log.path) == f"store:{entry.called}"
    assert (main.called, branch.called) == (shop.name, branch.id[:13])


def test_a_campaign_that_is_called_by_the_id_of_another_is_not_taken_for_it(shop: Shop) -> None:
    new = shop.synced("one")
    called = Shop(shop.database, shop.folder / "other")
    called.name = new.campaign.id
    called.synced("one")
    assert (shop.synced("one").case, shop.synced("one").campaign) == ("same", new.campaign)


@settings(max_examples=settings().max_examples // 3, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    steps=st.lists(st.tuples(st.sampled_from(["one", "two", "three"]), st.booleans(), st.integers(0, 3)), max_size=14)
)
def test_in_any_order_nothing_is_ever_lost(
    database: Database, tmp_path: Path, steps: list[tuple[str, bool, int]]
) -> None:
    folder = tmp_path / str(next(_numbers))
    folder.mkdir()
    shop, made = Shop(database, folder), set[str]()
    for laptop in ("two", "three"):
        shop.copied(laptop)
    for laptop, syncs, count in steps:
        shop.went_on(laptop, *(f"note {n}" for n in range(count)))  # often the same on two laptops
        made |= {text.chain for text in shop.texts(laptop)}
        if syncs:
            shop.synced(laptop)
        assert made <= {
            chain for each in ("one", "two", "three") for chain in [t.chain for t in shop.texts(each)]
        } | set(shop.chains())
    for laptop in ("one", "two", "three"):
        found = shop.synced(laptop)
        assert shop.chains(found) == [text.chain for text in shop.texts(laptop)]
    assert made <= set(shop.chains())


@pytest.mark.parametrize("case", ["new", "ahead", "behind", "fork", "fork goes on"])
def test_a_server_that_goes_away_at_any_moment_leaves_a_beginning(shop: Shop, server: RunningServer, case: str) -> None:
    _made(shop, case)
    keeper, told = Database(store_address(server.address())), 0
    for nth in range(14):
        before, mine_before = shop.chains(), [text.chain for text in shop.texts("two")]
        try:
            with cut_off(shop.database, keeper, nth):
                shop.synced("two")
        except RecordError:
            told += 1
        assert shop.chains()[: len(before)] == before or case.startswith("fork")
        assert set(before) <= set(shop.chains())
        assert [text.chain for text in shop.texts("two")][: len(mine_before)] == mine_before
    found = shop.synced("two")
    assert shop.chains(found) == [text.chain for text in shop.texts("two")]
    assert told >= 3  # before the two first statements nothing has begun: they are asked again
    keeper.close()


def _made(shop: Shop, case: str) -> None:
    shop.copied("two")
    if case == "new":
        return
    shop.synced("one")
    if case == "ahead":
        shop.went_on("two", "more")
        return
    shop.went_on("one", "of one")
    shop.synced("one")
    if case.startswith("fork"):
        shop.went_on("two", "of two")
    if case == "fork goes on":
        shop.synced("two")
        shop.went_on("two", "more of two")


def test_the_command_says_what_was_done(
    server: RunningServer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    keeper = Database(store_address(server.address()))
    keeper.select("CREATE DATABASE shop")
    keeper.close()
    monkeypatch.setenv("AXISCAL_STORE", server.address("shop"))
    monkeypatch.chdir(tmp_path)
    with Record.create("mill.axiscal", Created("", "", "", "", {})) as record:
        record.append(Noted("x"))
    assert run(["sync", "mill.axiscal"]) == 1
    assert "axiscal shop sync --prepare" in " ".join(capsys.readouterr().err.split())
    assert [run(["sync", "--prepare"]), run(["sync", "--prepare", "--json"])] == [0, 0]
    assert "is a store now" in capsys.readouterr().out
    said = list[str]()
    with Record.open("mill.axiscal") as record:
        write_copy(record, Path("other.axiscal"))
    for path, event in (("mill", ""), ("mill", "a"), ("other", "b")):
        if event:
            with Record.open(f"{path}.axiscal") as record:
                record.append(Noted(event))
        assert run(["sync", f"{path}.axiscal", "--json"]) == 0
        said.append(json.loads(capsys.readouterr().out)["case"])
    assert said == ["new", "ahead", "fork"]
    assert run(["sync", "other.axiscal"]) == 0
    assert "the store has the same, as branch" in capsys.readouterr().out
    assert run(["sync", "mill.axiscal", "--store", server.address("shop", user="measurer")]) == 0
    assert run(["sync", "mill.axiscal", "--store", server.address("shop", user="stranger")]) == 1
    assert "may not do that" in " ".join(capsys.readouterr().err.split())


def test_a_record_that_was_set_back_is_named_once(shop: Shop, address: str, capsys: pytest.CaptureFixture[str]) -> None:
    before = shop.file("one").read_bytes()
    assert [shop.synced("one").set_back, shop.synced("one").set_back] == [0, 0]
    shop.went_on("one", "third", "fourth")
    assert shop.synced("one").set_back == 0
    shop.copied("two")
    assert shop.synced("two").set_back == 0
    shop.file("one").write_bytes(before)
    back = shop.synced("one")
    assert (back.case, back.taken, back.set_back) == ("behind", 2, 5)
    assert shop.synced("one").set_back == 0  # it has all again
    shop.file("one").write_bytes(before)
    shop.went_on("one", "another third", "another fourth", "fifth")
    assert run(["sync", str(shop.file("one")), "--store", address]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "the store had seen event 5 in" in said
    assert shop.synced("one").set_back == 0


def test_a_laptop_goes_on_without_what_the_store_has_set_aside(shop: Shop, address: str, command: Command) -> None:
    shop.went_on("one", "third", "fourth")
    campaign = shop.synced("one").campaign
    assert command("sync", "--store", address, "--quarantine", f"store:{campaign.id}:4").printed
    with pytest.raises(RecordError, match=r"set event 4 of this record aside.*axiscal shop sync .*one.axiscal --drop"):
        shop.synced("one")
    shop.went_on("one", "fifth")
    assert "ends at event 3 now" in command("sync", shop.file("one"), "--store", address, "--drop").err
    assert [len(shop.texts(laptop)) for laptop in ("one", "one-whole")] == [3, 6]
    shop.went_on("one", "anew")
    assert shop.synced("one").case == "ahead"


def test_a_name_that_is_taken_or_fits_no_file_is_a_sentence_and_another_one_mends_it(
    shop: Shop, tmp_path: Path, address: str, command: Command
) -> None:
    shop.synced("one")
    other = tmp_path / "other.axiscal"
    Record.create(other, Created("", "", "", "another", {})).close()
    for name, why in ((shop.name.upper(), "of this name already"), ("../../evil", "cannot have this name")):
        told = command("sync", other, "--store", address, "--name", name).refusal
        assert why in told, told
    assert "new in the store" in command("sync", other, "--store", address, "--name", f"{shop.name} b").printed


def test_who_may_only_read_takes_and_leaves_no_trace(shop: Shop, server: RunningServer) -> None:
    shop.synced("one")
    shop.copied("two")
    shop.went_on("one", "third")
    shop.synced("one")
    before = shop.database.select("SELECT count(*) FROM axiscal.seen")
    reader = Database(store_address(server.address(user="reader")))
    with Record.open(shop.file("two")) as record:
        assert synced(reader, record, shop.name).case == "behind"
    with pytest.raises(RecordError, match="may not do that"):
        reader.select("SELECT axiscal.saw(gen_random_uuid(), 'a', gen_random_uuid(), 1)")
    reader.close()
    assert shop.database.select("SELECT count(*) FROM axiscal.seen") == before
