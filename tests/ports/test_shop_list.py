"""The list of a shop's records, and records brought into its folder."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.cli.app import run
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import expanded_uncertainty
from axiscal.estimation.inheritance import case_of
from axiscal.exceptions import RecordError
from axiscal.ports.fleet import shop_list as listing
from axiscal.ports.fleet.shop_list import brought, shop_list
from axiscal.ports.fleet.sister_records import read_records
from tests.commands import Command
from tests.generators.sisters import read_on, slide, write_record


def note(path: Path, text: str) -> None:
    """Add an event to a record."""
    with Campaign.open(path) as campaign:
        campaign.note(text)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "shop").mkdir()
    for number, serial in enumerate("AB"):
        write_record(tmp_path / "shop" / f"{serial}.axiscal", slide(serial=serial), read_on(number))
    return tmp_path / "shop"


@pytest.mark.parametrize("ended", [True, False])
def test_each_record_is_listed_with_what_it_comes_to(folder: Path, ended: bool) -> None:
    """A campaign that ended says it; one that goes on is estimated where that is asked for."""
    for file in folder.glob("*.axiscal"):
        with Campaign.open(file) as campaign:
            if ended:
                campaign.finish()
    assert all((each.result.agreement == "agree") == ended for each in shop_list(folder).listed)
    for each in shop_list(folder, estimate=True).listed:
        with Campaign.open(each.copy.file, write=False) as campaign:
            known = concluded(case_of(campaign.description), campaign.state.readings)
            assert each.copy.chain == campaign.state.name
            assert each.serial == each.copy.file.stem
        sizes = known.accuracy.rms, expanded_uncertainty(known).space
        assert (each.result.rms, each.result.expanded) == pytest.approx(sizes, rel=5e-4)
        assert (each.target, each.readings) == ("RMS 2 um", 16)
        assert bool(each.ended) == ended


def test_a_name_need_not_be_text(folder: Path) -> None:
    name = os.fsdecode(b"M\xfcller.axiscal")
    (folder / "A.axiscal").rename(folder / name)
    assert name in {each.copy.file.name for each in shop_list(folder).listed}


def test_what_is_wrong_with_a_record_is_a_sentence(folder: Path, command: Command) -> None:
    (folder / "copy.axiscal").write_bytes((folder / "A.axiscal").read_bytes())
    (folder / "early.axiscal").write_bytes((folder / "B.axiscal").read_bytes())
    note(folder / "B.axiscal", "repaired")
    (folder / "torn.axiscal").write_bytes((folder / "A.axiscal").read_bytes()[:-10])
    (folder / "foreign.axiscal").write_text("shopping list")
    (folder / "none.axiscal").symlink_to(folder / "nowhere")
    with Campaign.create(folder / "empty.axiscal", slide(serial="C")):
        pass
    document = command("fleet", folder, "--json").document
    why = {each["file"]: each["why"] for each in document["left_out"]}
    assert why["copy.axiscal"] == "it is the same as A.axiscal"
    assert why["early.axiscal"] == "it is an earlier copy of B.axiscal"
    assert "damaged" in why["torn.axiscal"]
    assert "not a campaign record" in why["foreign.axiscal"]
    assert "no such record" in why["none.axiscal"]
    listed = {each["record"]: each for each in document["records"]}
    assert set(listed) == {"A.axiscal", "B.axiscal", "empty.axiscal"}
    assert listed["empty.axiscal"]["remarks"] == ["it has no readings"]
    said = command("fleet", folder).printed
    assert "Left out: torn.axiscal" in said
    assert "3 records of 3 machines" in said


def test_whoever_learns_judges_copies_as_the_list_does(tmp_path: Path) -> None:
    mine = write_record(tmp_path / "mine.axiscal", slide(serial="9"), read_on(6)[:6])
    for name in ("early", "fork", "same"):
        (tmp_path / f"{name}.axiscal").write_bytes(mine.read_bytes())
    with Campaign.open(tmp_path / "fork.axiscal") as campaign:
        campaign.adopt(tuple(read_on(6)[6:8]))
    note(mine, "new ball screw X (renewed: X)")
    listed, (found, left) = shop_list(tmp_path), read_records(tmp_path.glob("*.axiscal"))
    whys = {each.file: each.left_out for each in left}
    (parted,) = next(each.remarks for each in listed.listed if each.copy.file == mine)
    assert whys.pop(mine.name) == f"{parted}, and that one has as many readings or more"
    assert whys == {file.name: why for file, why in listed.left_out}
    early = "it is an earlier copy of fork.axiscal"
    assert whys == {"early.axiscal": early, "same.axiscal": "it is the same as early.axiscal"}
    assert [record.file.name for record in found] == ["fork.axiscal"]


def test_a_record_is_brought_goes_on_and_is_never_overwritten_by_less(folder: Path, tmp_path: Path) -> None:
    mine = write_record(tmp_path / "A.axiscal", slide(serial="C"), read_on(3))  # another campaign has this name
    new = brought(folder, mine)
    assert (new.what, new.events, new.file.name[:2]) == ("new", 17, "A-")
    assert brought(folder, mine).what == "there already"
    note(mine, "more")
    assert (brought(folder, mine).what, brought(folder, mine).what) == ("went on", "there already")
    with Campaign.open(mine, write=False) as here, Campaign.open(new.file, write=False) as there:
        assert here.state == there.state
    note(new.file, "in the folder")
    assert brought(folder, mine).what == "there already"  # the folder has more
    note(mine, "on the laptop")
    before = new.file.read_bytes()
    with pytest.raises(RecordError, match="from event 19"):
        brought(folder, mine)
    assert new.file.read_bytes() == before


def test_what_is_measured_in_the_folder_meanwhile_is_not_lost(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mine = write_record(tmp_path / "mine.axiscal", slide(serial="C"), read_on(3))
    there = brought(folder, mine).file
    note(mine, "on the laptop")
    looked = listing._looked_at

    def then_noted(*asked: Any) -> object:
        found = looked(*asked)
        note(there, "in the folder")
        return found

    monkeypatch.setattr(listing, "_looked_at", then_noted)
    with pytest.raises(RecordError, match="Another process has written"):
        brought(folder, mine)
    with Campaign.open(there, write=False) as campaign:
        assert campaign.state.notes[-1].text == "in the folder"


def test_one_that_cannot_be_brought_stops_no_other(
    folder: Path, tmp_path: Path, command: Command, capsys: pytest.CaptureFixture[str]
) -> None:
    mine = write_record(tmp_path / "mine.axiscal", slide(serial="C"), read_on(3))
    (tmp_path / "bad.axiscal").write_text("x")
    assert run(["bring", str(folder), str(tmp_path / "bad.axiscal"), str(mine)]) == 1
    captured = capsys.readouterr()
    assert "is new, by 17 events" in captured.out
    assert "not a campaign record" in " ".join(captured.err.split())
    assert command("bring", folder, mine, "--json").document["brought"][0]["what"] == "there already"
