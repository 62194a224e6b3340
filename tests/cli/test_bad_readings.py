"""Readings in the wrong unit, through the command line: seen at once, kept, not believed; no tables of millimetres."""

from __future__ import annotations

import json
import shlex
import sys
from pathlib import Path

import numpy as np
import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.cli.app import run
from axiscal.description.campaign import read_campaign
from axiscal.measurement.simulation import Simulator
from tests.commands import Command

CAMPAIGN = """machine = "one-axis"
[target]
{target}
[[setups]]
name = "laser"
instrument = "interferometer"
direction = "x"
noise = "0.5 um"
approach = "both"
"""

INSTRUMENT = """import json, math, sys
for number, line in enumerate(sys.stdin):
    value = 6 + 2 * math.sin(json.loads(line)["position"]["X"] / 90)  # never so small that mm look like inches
    print(json.dumps({"value": value, "unit": "um" if number < 5 else "mm"}), flush=True)
"""


def _campaign(folder: Path, target: str) -> Path:
    path = folder / "c.toml"
    path.write_text(CAMPAIGN.format(target=target))
    return path


def _table(folder: Path, seed: int, column: str, factor: float, count: int = 20) -> Path:
    """Write readings of a virtual machine whose errors are `factor` times too large, as numbers of um."""
    campaign, rng = read_campaign(_campaign(folder, "readings = 9")), np.random.default_rng(seed)
    machine, (setup,) = Simulator(campaign.machine, campaign.setups).drawn(seed), campaign.setups
    places = [((i + 0.5) / count, 1 if i % 2 else -1) for i in range(count)]
    values = [1e6 * factor * machine.read_all(setup, (x,), (side,), rng)[0] for x, side in places]
    rows = [f"laser,{1e3 * x},X{'+-'[s < 0]},{v}" for (x, s), v in zip(places, values, strict=True)]
    path = folder / "r.csv"
    path.write_text("\n".join([f"setup,X_mm,approach,{column}", *rows]) + "\n")
    return path


@pytest.mark.long
def test_a_source_that_slips_to_mm_is_stopped_and_its_reading_kept(tmp_path: Path, command: Command) -> None:
    script, out = tmp_path / "slip.py", tmp_path / "out"
    script.write_text(INSTRUMENT)
    source = f"exec:{shlex.quote(sys.executable)} {shlex.quote(str(script))}"
    campaign = _campaign(tmp_path, 'rms = "1 um"')
    assert "mm instead of um?" in command("run", campaign, "--source", source, "--out", out).refusal
    assert [path.name for path in out.iterdir()] == ["campaign.axiscal"]
    with Campaign.open(out / "campaign.axiscal") as kept:
        assert len(kept.state.readings) == 6
        assert kept.state.finished is None
        assert np.max(np.abs(kept.estimate(ended=True).knowledge.belief.mean[:21])) < 50e-6


@pytest.mark.long
def test_one_value_typed_in_mm_is_flagged_at_once_and_stays_so(tmp_path: Path, command: Command) -> None:
    record = str(tmp_path / "m.axiscal")
    assert run(["start", str(_campaign(tmp_path, "readings = 9")), record]) == 0
    for value in ("1.2 um", "-0.7 um", "2.5 mm", "1.9 um", "0.4 um"):
        assert run(["next", record]) == 0
        assert ("mm instead of um?" in command("record", record, value).printed) == (value == "2.5 mm")
    with Campaign.open(Path(record)) as campaign:
        estimation = campaign.estimate(ended=True)
        assert [doubt.reading for doubt in estimation.outliers] == [2]
        assert np.max(np.abs(estimation.knowledge.belief.mean[:21])) < 50e-6
    assert run(["finish", record, "--out", str(tmp_path / "d")]) == 0
    warnings = json.loads((tmp_path / "d" / "result.json").read_text())["warnings"]
    assert [warning["text"] for warning in warnings if "Reading 3" in warning["text"]]
    assert "Reading 3" in (tmp_path / "d" / "report.html").read_text()


def test_a_reading_of_a_program_is_complained_of_under_the_number_that_the_program_gave_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Numbers 101, 102 … with gaps: the value that is 80 um off is the one that the program calls 117."""
    table = _table(tmp_path, 4, "value_um", 1.0)
    header, *rows = table.read_text().splitlines()
    numbers = [101 + 2 * k for k in range(len(rows))]
    rows = [f"{n},{row}" for n, row in zip(numbers, rows, strict=True)]
    spoilt = rows[8].rsplit(",", 1)
    rows[8] = f"{spoilt[0]},{float(spoilt[1]) + 80}"
    table.write_text("\n".join([f"reading,{header}", *rows]) + "\n")
    out = tmp_path / "d"
    assert run(["estimate", str(tmp_path / "c.toml"), str(table), "--out", str(out)]) == 0
    capsys.readouterr()
    document = json.loads((out / "result.json").read_text())
    (rejected,) = document["rejected"]
    assert rejected["reading"] == 117
    assert [row["reading"] for row in document["history"]][1:] == numbers
    assert "eading 117" in (out / "report.html").read_text()
