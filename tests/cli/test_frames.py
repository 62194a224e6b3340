"""Touches of a ball on a turning table as a control finds it: in columns of their own, and in the wrong frame.

The table is written out here: its axis stands aside, and a ball on it is where no chain of the program puts it.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import read_campaign
from axiscal.exceptions import AxiscalError
from axiscal.numerics import Array
from axiscal.present.guide.question import measured
from benchmarks.zoo.running import given, rows_of
from tests.generators.texts import artefact_text, campaign_text, machine_text, setup_text

CENTRE = np.array([-0.035, 0.110, 0.0])
BALL, STANDS = np.array([48.0, -22.0, 70.0]), np.array([48.31, -22.17, 70.06])
"""mm, where the campaign has it and where it stands, with the table at zero."""
TURNS = np.arange(0.0, 360.0, 40.0)
MACHINE = machine_text(
    "w-C'-b-X-Y-Z-t",
    {"X": (-150, 150), "Y": (-150, 150), "Z": (0, 200), "C": (0, 360)},
    {"X0C Y0C": "100 um", "ECC": 'std = "50 urad", length = "90 deg"'},
).replace("[axes.C]\n", '[axes.C]\ndirection = "reversed"\n')
CAMPAIGN = campaign_text(
    "machine.toml",
    artefact_text("ball", balls={"one": ["48 mm", "-22 mm", "70 mm"]}),
    setup_text("touch", "sphere", artefact="ball", noise="2 um"),
    target={"readings": 20, "wants": ["centre of C"]},
    compensation_active=False,
    tool_length="0 um",
)


def about(point: Array, degrees: float) -> Array:
    """Return a point turned about z, (3,)."""
    sin, cos = np.sin(np.radians(degrees)), np.cos(np.radians(degrees))
    return np.array([cos * point[0] - sin * point[1], sin * point[0] + cos * point[1], point[2]])


def found() -> Array:
    """Return where the control finds the ball at each turn, (m, 3) mm in machine coordinates."""
    noise = np.random.default_rng(11).normal(0, 0.002, (len(TURNS), 3))
    return np.array([CENTRE + about(STANDS - CENTRE, turn) for turn in TURNS]) + noise


def campaign(folder: Path) -> Path:
    for name, text in (("machine.toml", MACHINE), ("campaign.toml", CAMPAIGN)):
        (folder / name).write_text(text)
    return folder / "campaign.toml"


def estimated(folder: Path, columns: str, values: Array) -> tuple[str, Path]:
    """Return what is said of readings, and the record."""
    rows = (("touch", turn, *each) for turn, each in zip(TURNS.tolist(), np.round(values, 5).tolist(), strict=True))
    (folder / "r.csv").write_text(rows_of(f"setup,C_deg,{columns}", rows))
    told = given("data", "estimate", campaign(folder), folder / "r.csv", "--out", folder / "out")
    return told.out + told.err, folder / "out" / "campaign.axiscal"


def centre(results: Path) -> list[float]:
    """Return where the axis is said to stand, mm."""
    constants = json.loads((results / "result.json").read_text())["constants"]
    return [1e-3 * constants[name]["mean"] for name in ("X0C", "Y0C")]


FOUND = "found_x_mm,found_y_mm,found_z_mm"
VALUES = "value_x_um,value_y_um,value_z_um"


def test_what_the_control_found_is_enough(tmp_path: Path) -> None:
    said, _ = estimated(tmp_path, FOUND, found())
    assert f"agree: {len(TURNS)} of {len(TURNS)}" in said
    assert centre(tmp_path / "out") == pytest.approx(CENTRE[:2], abs=0.003)


def test_values_in_the_machines_frame_are_named_and_accepted(tmp_path: Path) -> None:
    nominal = np.array([about(BALL, turn) for turn in TURNS])
    said, record = estimated(tmp_path, VALUES, 1000 * (nominal - found()))
    assert "CONTRADICT" in said
    assert "the machine's x, y, z" in " ".join(said.split())
    assert given("step", "undo", record).status == 0
    for command in ("accept", "undo", "accept"):
        assert given("step", command, record, *(["frame"] if command == "accept" else [])).status == 0
    assert given("finish", record, "--out", tmp_path / "right").status == 0
    assert centre(tmp_path / "right") == pytest.approx(CENTRE[:2], abs=0.003)


def test_what_the_control_found_is_typed_as_it_prints_it(tmp_path: Path) -> None:
    printed = np.round(found(), 4)
    turn, (x, y, z) = TURNS[3], printed[3]
    estimated(tmp_path, FOUND, printed)
    with Campaign.open(tmp_path / "out" / "campaign.axiscal", write=False) as told:
        wanted = next(each for each in told.state.readings if each.pose[0] == pytest.approx(np.radians(turn)))
    record = tmp_path / "typed.axiscal"
    Campaign.create(record, read_campaign(campaign(tmp_path))).close()
    done = given(
        "step", "record", record, f"found {x} {y} {z}", "--at", f"C={turn} deg", "--setup", "touch", "--approach", "C+"
    )
    assert done.status == 0, done
    with Campaign.open(record, write=False) as kept:
        (reading,) = kept.state.readings
        setup, at = kept.description.setup("touch"), (kept.description.machine, reading.pose)
        prompted = measured(f"found {x}; {y}; {z}", setup, at)
        with pytest.raises(AxiscalError, match="2 values"):
            measured("found 1 2", setup, at)
    assert reading.values == pytest.approx(wanted.values, abs=1e-12)
    assert prompted.tolist() == pytest.approx(list(wanted.values), abs=1e-12)
