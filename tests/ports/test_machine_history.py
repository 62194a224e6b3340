"""A machine over the years: its pieces are what is left with its tables, its figures what its campaigns found."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.cli.app import run
from axiscal.description.campaign import campaign_from_texts
from axiscal.exceptions import TargetError
from axiscal.ports.fleet.due_dates import Wanted, due_dates
from axiscal.ports.fleet.history_page import MachineHistory, histories, render, year_of
from axiscal.ports.fleet.wearing import YEAR
from axiscal.ports.fleet.worn_machine import WornMachine
from axiscal.record import log
from tests.generators.sisters import read_on, slide, write_record

TODAY = datetime(2026, 7, 1, tzinfo=UTC)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    def on(day: str) -> None:
        monkeypatch.setattr(log, "_now", lambda: f"{day}T08:00:00.000+00:00")

    for number, day in enumerate(("2022-03-01", "2024-09-01")):
        on(day)
        write_record(tmp_path / f"a-{number}.axiscal", slide(serial="A"), read_on(1 + 7 * number))
    on("2023-07-02")
    with Campaign.open(tmp_path / "a-0.axiscal") as campaign:
        campaign.note("new <ball> screw (renewed: X)")
    return tmp_path


def drawn(folder: Path) -> tuple[MachineHistory, str]:
    """Return the history of the machine, and the page."""
    shop = due_dates(folder.glob("*.axiscal"), TODAY.date(), Wanted(15e-6))
    found = histories(shop, TODAY)
    return found[0], render(shop, found)


def test_a_machine_without_a_target_is_left_out_by_name(folder: Path) -> None:
    """Others are drawn; only where no campaign has one the command ends."""
    told = slide(serial="B")
    text = told.text.replace('rms = "2 um"', "readings = 5")
    without = campaign_from_texts(text, "campaign.toml", told.machine.text, "machine.toml")
    write_record(folder / "b.axiscal", without, read_on(3))
    shop = due_dates(folder.glob("*.axiscal"), TODAY.date())
    (machine,) = histories(shop, TODAY)
    page = render(shop, (machine,))
    assert machine.records[0].file.name == "a-0.axiscal"
    assert "b.axiscal" in page
    assert "--target" in page
    with pytest.raises(TargetError, match="no RMS"):
        due_dates([folder / "b.axiscal"], TODAY.date())


def test_between_campaigns_it_is_what_the_tables_of_the_last_one_leave(folder: Path) -> None:
    shop = due_dates(folder.glob("*.axiscal"), TODAY.date(), Wanted(15e-6))
    (machine,) = histories(shop, TODAY)
    assert [record.file.name for record in machine.records] == ["a-0.axiscal", "a-1.axiscal"]
    before, renewed, after = machine.left
    first = shop.known[machine.records[0].digest]
    begun = year_of(datetime(2022, 3, 1, 8, tzinfo=UTC))
    for piece, axes in ((before, ()), (renewed, ("X",))):
        left = WornMachine(first, shop.aging, axes).rms
        np.testing.assert_allclose(piece[:, 1], [left(year - begun) for year in piece[:, 0]], rtol=1e-12)
    assert before[-1, 0] == renewed[0, 0] == machine.happened[0].year
    assert renewed[0, 1] > 1.5 * before[-1, 1]
    assert after[0, 0] == renewed[-1, 0] == year_of(datetime(2024, 9, 1, 8, tzinfo=UTC))
    now = np.interp(year_of(TODAY), after[:, 0], after[:, 1])
    np.testing.assert_allclose(now, machine.due.now, rtol=0.01)


def test_figures_are_those_of_the_campaigns(folder: Path) -> None:
    machine, _ = drawn(folder)
    figures = {each.name: each for each in machine.parameters}
    assert figures["EXX"].spans
    assert not figures["EXX_reversal"].spans
    for found, record in zip(figures["EXX"].found, machine.records, strict=True):
        with Campaign.open(record.file, write=False) as campaign:
            known = campaign.estimate(ended=True)
        function, belief = known.case.errors.names["EXX"], known.printed.belief
        curve = function.rows(np.linspace(0.0, 0.5, 61)) @ belief.mean[function.columns]
        np.testing.assert_allclose(found.mean, np.ptp(curve), rtol=1e-6)
        assert 0 < found.std < 5e-6


def test_the_page_says_what_happened_and_is_markup_nowhere(folder: Path) -> None:
    machine, page = drawn(folder)
    assert "new &lt;ball&gt; screw (renewed: X)" in page
    assert page.index("2022-03-01") < page.index("2023-07-02") < page.index("2024-09-01")
    assert page.count("<svg class=") == 3 + len(machine.parameters)  # one picture for each width, and the errors
    assert "http://" not in page.replace("http://www.w3.org", "")


def test_the_command_writes_it(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    page = folder / "years.html"
    assert run(["fleet", str(folder), "--page", str(page), "--target", "15 um"]) == 0
    assert "Written" in capsys.readouterr().out
    assert "Slide A" in page.read_text()
    assert run(["fleet", str(folder), "--page", str(page), "--target", "4 mrad"]) == 1
    assert run(["fleet", str(folder), "--page", str(page), "--target", "0 um"]) == 1


def test_a_year_has_its_fraction() -> None:
    assert year_of(datetime(2024, 1, 1, tzinfo=UTC)) == 2024.0
    assert year_of(datetime(2023, 7, 2, 12, tzinfo=UTC)) == 2023.5
    a, b = datetime(2023, 2, 1, tzinfo=UTC), datetime(2025, 9, 1, tzinfo=UTC)
    assert abs((year_of(b) - year_of(a)) * YEAR - (b - a).total_seconds()) < 2 * 86400
