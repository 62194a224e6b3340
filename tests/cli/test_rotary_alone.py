"""A table of an angle is judged by the angle: a rotary axis alone moves no tool point, and its table is worth loading.

The encoder is written out here: eccentric by 0.3 deg, with a second wave and a backlash of 0.08 deg.
"""

from __future__ import annotations

import json

import numpy as np
import pytest

from axiscal.numerics import Array
from benchmarks.zoo.answers import Answer
from benchmarks.zoo.running import given, rows_of
from tests.generators.texts import campaign_text, machine_text, setup_text

NOISE = 0.004
MACHINE = machine_text(
    "w-C'-b-t",
    {"C": (0, 360)},
    {"ECC": 'std = "0.3 deg", knots = 13, length = "90 deg"', "ECC_reversal": "0.05 deg"},
)
CAMPAIGN = campaign_text(
    "machine.toml",
    setup_text("reference", "autocollimator", direction="z", moves=["C"], noise=f"{NOISE} deg", approach="both"),
    target={"readings": 60},
    compensation_active=False,
)


def encoder(turns: Array, side: float) -> Array:
    """Return by how much the table is turned too far, deg; side : +1 or -1, from where it comes."""
    at = np.radians(turns)
    found: Array = 0.3 * np.sin(at + 0.4) + 0.05 * np.sin(2 * at) + 0.04 * side
    return found


@pytest.fixture(scope="module")
def answer(tmp_path_factory: pytest.TempPathFactory) -> Answer:
    folder, rng = tmp_path_factory.mktemp("encoder"), np.random.default_rng(8)
    turns = np.arange(0.0, 360.0, 7.5)
    rows = [
        ("reference", turn, f"C{sign}", round(value + rng.normal(0, NOISE), 5))
        for sign, side in (("+", 1.0), ("-", -1.0))
        for turn, value in zip(turns.tolist(), encoder(turns, side).tolist(), strict=True)
    ]
    for name, text in (("machine.toml", MACHINE), ("campaign.toml", CAMPAIGN)):
        (folder / name).write_text(text)
    (folder / "r.csv").write_text(rows_of("setup,C_deg,approach,value_deg", rows))
    return Answer(
        folder / "out", given("data", "estimate", folder / "campaign.toml", folder / "r.csv", "--out", folder / "out")
    )


def test_its_row_says_what_the_table_leaves(answer: Answer) -> None:
    rows = {row["row"]: row for row in answer.result["rows"]}
    for name in ("positioning C", "backlash C"):
        left, found = rows[name]["left"]["linuxcnc"], rows[name]["found"]
        assert left < 0.1 * found
        assert left < rows[name]["known_to"]


def test_the_table_is_right_for_the_angle(answer: Answer) -> None:
    assert (
        given("export", answer.folder / "campaign.axiscal", "--to", "csv", "--out", answer.folder / "csv").status == 0
    )
    lines = (answer.folder / "csv" / "C.csv").read_text().splitlines()
    names, rows = lines[0].split(","), [line.split(",") for line in lines[1:]]
    column = {name: np.array([float(row[n]) for row in rows]) for n, name in enumerate(names) if n}
    for name, side in (("forward_arcsec", 1.0), ("reverse_arcsec", -1.0)):
        off = encoder(column["position_deg"], side) - column[name] / 3600
        assert np.ptp(off) < 4 * NOISE, json.dumps(names)
