"""A reading that is not believed, through the command line: complained of under the number that a program gave it."""

import json
from pathlib import Path

import numpy as np

from axiscal.cli.app import run
from axiscal.description.campaign import read_campaign
from axiscal.measurement.simulation import Simulator
from tests.generators.texts import FOUR_READINGS
from tests.golden.surfaces import of_paper

NUMBERS = range(101, 141, 2)


def test_a_reading_of_a_program_is_complained_of_under_the_number_that_the_program_gave_it(tmp_path: Path) -> None:
    """Numbers 101, 103 … with gaps: the value that is 80 um off is the one that the program calls 117."""
    (tmp_path / "c.toml").write_text(FOUR_READINGS)
    campaign, rng = read_campaign(tmp_path / "c.toml"), np.random.default_rng(4)
    machine, (setup,) = Simulator(campaign.machine, campaign.setups).drawn(4), campaign.setups
    rows = ["reading,setup,X_mm,approach,value_um"]
    for i, number in enumerate(NUMBERS):
        x, side = (i + 0.5) / len(NUMBERS), 1 if i % 2 else -1
        value = 1e6 * machine.read_all(setup, (x,), (side,), rng)[0] + 80 * (number == 117)
        rows.append(f"{number},laser,{1e3 * x},X{'+-'[side < 0]},{value}")
    (tmp_path / "r.csv").write_text("\n".join(rows) + "\n")
    out = tmp_path / "d"
    assert run(["estimate", str(tmp_path / "c.toml"), str(tmp_path / "r.csv"), "--out", str(out)]) == 0
    document = json.loads((out / "result.json").read_text())
    assert [rejected["reading"] for rejected in document["rejected"]] == [117]
    assert [row["reading"] for row in document["history"]][1:] == [*NUMBERS]
    assert "eading117" in of_paper(out / "report.pdf")
