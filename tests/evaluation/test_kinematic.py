"""Kinematic tests against closed forms: what one error does while a point is held, on machines with a known truth."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from axiscal.cli.app import run
from axiscal.description.campaign import campaign_from_texts
from axiscal.evaluation import StandardFigures, figures_of
from axiscal.exceptions import EvaluationError, ReadingError
from axiscal.machine import load_machine
from axiscal.measurement.candidates import chart_candidates
from axiscal.measurement.readers.truth_curves import TruthCurve
from axiscal.measurement.simulation import Simulator
from axiscal.numerics import Array

SETUP = """
machine = "machine.toml"
[[artefacts]]
name = "ball"
balls = {{ one = ["60 mm", "0 mm", "-20 mm"] }}
[[setups]]
name = "held"
instrument = "rtest"
artefact = "ball"
moves = ["{axis}"]
raster = {{ {axis} = "10 deg" }}
noise = "0.0001 um"
approach = "both"
"""


def machine_with(axis: str) -> str:
    if axis != "A":
        return load_machine("dmu60").text
    return (Path(__file__).parents[1] / "linuxcnc/machines/xyzac.machine.toml").read_text(encoding="utf-8")


def read_held(axis: str, error: str, value: float, folder: Path) -> tuple[StandardFigures, Array]:
    """Return the figures of a test on a machine with one error, and the angles at which it was read."""
    campaign = campaign_from_texts(SETUP.format(axis=axis), "c.toml", machine_with(axis), "machine.toml")
    (setup,) = campaign.setups
    assert setup.chart is not None
    curve = TruthCurve(np.array([-10.0, 10.0]), np.full(2, value))
    truth = Simulator(campaign.machine, ()).with_curves({error: curve}, 0)
    poses, approaches = chart_candidates(campaign.machine, setup, setup.chart, 10_000)
    rng, index, rows = (
        np.random.default_rng(0),
        campaign.machine.index(axis),
        ["test,angle_deg,direction,x_um,y_um,z_um"],
    )
    for pose, approach in zip(poses, approaches, strict=True):
        x, y, z = (1e6 * v for v in truth.read_all(setup, tuple(pose), tuple(approach), rng))
        way = "+" if approach[index] > 0 else "-"
        rows.append(f"{axis}K,{np.degrees(pose[index]):.6f},{way},{x:.6f},{y:.6f},{z:.6f}")
    file = folder / "readings.csv"
    file.write_text("\n".join(rows) + "\n")
    found = figures_of(file)
    assert isinstance(found, StandardFigures)
    return found, poses[:, index]


@pytest.mark.parametrize(("axis", "error", "turned"), [("C", "X0C", "xy"), ("B", "Z0B", "xz"), ("A", "Y0A", "yz")])
def test_an_axis_off_its_place_draws_a_circle(axis: str, error: str, turned: str, tmp_path: Path) -> None:
    """On the part the offset e goes round: e cos and e sin of the angle, and of A with what C keeps."""
    found, angles = read_held(axis, error, 8e-6, tmp_path)
    directions = sorted(turned)
    widths = {name: 1e-6 * 8 * np.ptp(wave(angles)) for name, wave in (("c", np.cos), ("s", np.sin))}
    seen = sorted(found.figures[f"{axis}K_{name}"] for name in directions)
    assert seen == pytest.approx(sorted(widths.values()), rel=1e-3)
    (still,) = set("xyz") - set(turned)
    assert found.figures[f"{axis}K_{still}"] == pytest.approx(0.0, abs=1e-8)


def test_what_changes_with_the_way_is_in_both_together(tmp_path: Path) -> None:
    rows = ["test,angle_deg,direction,deviation_um"]
    rows += [f"K2,{angle},{way},{np.sin(np.radians(angle)) + (2 if way == '+' else -2):.9f}"
             for way in "+-" for angle in range(0, 360, 10)]  # fmt: skip
    (tmp_path / "k.csv").write_text("\n".join(rows) + "\n")
    found = figures_of(tmp_path / "k.csv")
    assert isinstance(found, StandardFigures)
    assert found.figures == pytest.approx({"K2": 6e-6, "K2_plus": 2e-6, "K2_minus": 2e-6})
    assert found.warnings == ()


def test_one_way_alone_is_said_and_three_readings_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "k.csv"
    file.write_text("test,angle_deg,direction,deviation_um\n" + "".join(f"K1,{a},+,{a}\n" for a in (0, 10, 20, 30)))
    found = figures_of(file)
    assert isinstance(found, StandardFigures)
    assert found.figures == pytest.approx({"K1": 30e-6, "K1_plus": 30e-6})
    assert "only one way" in found.warnings[0]
    file.write_text("test,angle_deg,direction,deviation_um\nK1,0,+,1\nK1,1,+,1\nK1,2,+,1\n")
    with pytest.raises(EvaluationError, match="fewer than 4"):
        figures_of(file)
    file.write_text("test,angle_deg,direction,x_um,y_um\nK1,0,+,1,1\n")
    with pytest.raises(ReadingError):
        figures_of(file)


def test_the_command_prints_them(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "k.csv"
    file.write_text("test,angle_deg,direction,deviation_um\n" + "".join(f"K1,{a},-,{a}\n" for a in (0, 10, 20, 30)))
    assert run(["iso230", str(file)]) == 0
    assert "K1                      30.000 um   ISO 10791-6" in capsys.readouterr().out
