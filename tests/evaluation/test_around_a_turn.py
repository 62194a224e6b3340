"""Circles, diagonals and spindles against closed forms, scipy's optimiser and figures put together by hand."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import minimize

from axiscal.cli import app
from axiscal.evaluation import circular, error_motion, evaluate, figures_of, read_iso230
from axiscal.exceptions import EvaluationError, ReadingError
from axiscal.measurement.readers.around import CircularTest, Turns
from axiscal.numerics import Array

AROUND = np.arange(72) * np.pi / 36


def _circle(plus: Array, minus: Array | None = None, angles: Array = AROUND) -> CircularTest:
    if minus is None:
        return CircularTest(angles, plus, np.ones(len(angles)))
    return CircularTest(np.tile(angles, 2), np.concatenate([plus, minus]), np.repeat([1.0, -1.0], len(angles)))


def test_an_oval_off_its_centre_has_twice_its_amplitude_as_g() -> None:
    oval = 4e-6 * np.cos(2 * AROUND + 0.3)
    place = 30e-6 * np.cos(AROUND) - 12e-6 * np.sin(AROUND)
    found = circular(_circle(7e-6 + oval + place))
    assert found.figures["G_plus"] == pytest.approx(8e-6, rel=0.01)
    assert found.centre == pytest.approx((30e-6, -12e-6))
    assert found.figures["F_max"] == pytest.approx(11e-6, rel=0.01)
    assert found.figures["F_min"] == pytest.approx(3e-6, rel=0.01)
    assert "G_b" not in found.figures
    assert "one direction" in found.warnings[0]


def test_both_directions_are_judged_about_their_common_centre() -> None:
    lag = 2e-6 * np.sign(np.sin(2 * AROUND + 0.01))
    found = circular(_circle(1e-6 + lag, 3e-6 - lag)).figures
    assert found["G_plus"] == pytest.approx(4e-6)
    assert found["G_minus"] == pytest.approx(4e-6)
    assert found["D"] == pytest.approx(2e-6)
    assert found["G_b"] == pytest.approx(6e-6)
    assert found["F_max"] == pytest.approx(5e-6)
    assert found["F_min"] == pytest.approx(-1e-6)


def test_g_is_no_smaller_than_that_of_the_two_circles_of_least_separation() -> None:
    rng = np.random.default_rng(1)
    for _ in range(5):
        radial = sum(rng.normal() * np.cos(n * AROUND + rng.uniform(0, 6)) for n in range(1, 6))
        deviations = np.asarray(radial, dtype=float)

        def width(centre: Array, e: Array = deviations) -> float:
            left = e - centre[0] * np.cos(AROUND) - centre[1] * np.sin(AROUND)
            return float(np.ptp(left))

        least = minimize(width, np.zeros(2), method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-9}).fun
        found = circular(_circle(1e-6 * deviations)).figures["G_plus"] * 1e6
        assert least - 1e-6 <= found <= 1.25 * least


def test_a_constant_and_a_turn_of_the_start_change_no_width() -> None:
    radial = 1e-6 * np.random.default_rng(2).standard_normal(72)
    one = circular(_circle(radial)).figures["G_plus"]
    assert circular(_circle(radial + 5e-6)).figures["G_plus"] == pytest.approx(one)
    assert circular(_circle(radial, angles=AROUND + 0.7)).figures["G_plus"] == pytest.approx(one)


def test_half_a_circle_is_refused() -> None:
    with pytest.raises(EvaluationError, match="do not go all around"):
        circular(CircularTest(AROUND[:36], np.zeros(36), np.ones(36)))


def test_error_motions_put_together_are_taken_apart() -> None:
    """Runout 20 um, two lobes of 1 um in every turn, and turns that lie 0.3 um apart by turns."""
    angles = np.arange(36) * np.pi / 18
    once = 20e-6 * np.cos(angles + 1.0) + 1e-6 * np.cos(2 * angles)
    turns = once[:, None] + 0.15e-6 * (-1.0) ** np.arange(20)
    found = error_motion(Turns(angles, turns))
    figures = found.figures
    assert figures["fundamental"] == pytest.approx(20e-6)
    assert figures["radial_synchronous"] == pytest.approx(2e-6, rel=0.01)
    assert figures["radial_asynchronous"] == pytest.approx(0.3e-6)
    assert figures["radial_total"] == pytest.approx(2.3e-6, rel=0.01)
    assert figures["axial_synchronous"] == pytest.approx(np.ptp(once))
    assert figures["axial_total"] >= figures["axial_synchronous"]
    assert found.warnings == ()


def test_few_turns_are_said_and_one_is_refused() -> None:
    turns = np.zeros((12, 3))
    angles = np.arange(12) * np.pi / 6
    assert "asks for 20 turns; there are 3" in error_motion(Turns(angles, turns)).warnings[0]
    with pytest.raises(EvaluationError, match="needs two turns"):
        error_motion(Turns(angles, turns[:, :1]))


def _runs(wrong: float = 0.0) -> list[str]:
    """Return the rows of a test of five targets and five runs each way, one reading off by so much, um."""
    rng = np.random.default_rng(3)
    rows = []
    for direction in ("+", "-"):
        for run in range(1, 6):
            for target in (0, 137, 260, 391, 505):
                off = wrong if (direction, run, target) == ("+", 3, 260) else 0.0
                rows.append(f"{target},{direction},{run},{0.01 * target + 0.5 * rng.standard_normal() + off:.4f}")
    return rows


def test_a_reading_that_the_other_runs_contradict_is_named(tmp_path: Path) -> None:
    for wrong, named in ((0.0, False), (6.0, True)):
        file = tmp_path / f"{wrong:g}.csv"
        file.write_text("\n".join(["target_mm,direction,run,deviation_um", *_runs(wrong)]))
        said = " ".join(evaluate(read_iso230(file)).warnings)
        assert ("Run 3 in direction + at 260 mm is" in said) is named


def test_diagonals_are_tests_of_their_own_and_the_largest_counts(tmp_path: Path) -> None:
    first, second = _runs(), [f"{row.rsplit(',', 1)[0]},{3 * float(row.rsplit(',', 1)[1]):.4f}" for row in _runs()]
    rows = [f"{name},{row}" for name, of in (("PPP", first), ("PPN", second)) for row in of]
    (tmp_path / "d.csv").write_text("\n".join(["diagonal,target_mm,direction,run,deviation_um", *rows]))
    (tmp_path / "one.csv").write_text("\n".join(["target_mm,direction,run,deviation_um", *second]))
    found, alone = figures_of(tmp_path / "d.csv").as_json(), evaluate(read_iso230(tmp_path / "one.csv")).as_json()
    assert found["schema"] == "axiscal-iso230-6/1"
    assert (found["E_d"], found["B_d"]) == (pytest.approx(alone["E"]), pytest.approx(alone["B"]))
    assert found["diagonals"]["PPN"]["A"] == alone["A"]  # type: ignore[index]


def test_the_command_knows_the_tests_by_their_columns(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    circle = [f"{np.degrees(a):.4f},{way},{3 * np.cos(2 * a):.4f}" for way in "+-" for a in AROUND]
    (tmp_path / "c.csv").write_text("\n".join(["angle_deg,direction,deviation_um", *circle]))
    turns = [f"{10 * n},{turn},{np.sin(n / 3):.4f}" for turn in (1, 2) for n in range(36)]
    (tmp_path / "s.csv").write_text("\n".join(["angle_deg,turn,deviation_um", *turns]))
    assert app.run(["iso230", str(tmp_path / "c.csv"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["G_b"] == pytest.approx(6.0, rel=0.01)
    assert app.run(["iso230", str(tmp_path / "s.csv")]) == 0
    said = capsys.readouterr().out
    assert "ISO 230-7, synchronous error motion, radial" in said
    assert "asks for 20 turns; there are 2" in said


def test_a_turn_that_leaves_out_an_angle_is_refused(tmp_path: Path) -> None:
    turns = [f"{10 * n},{turn},0.1" for turn in (1, 2) for n in range(36) if (turn, n) != (2, 7)]
    (tmp_path / "s.csv").write_text("\n".join(["angle_deg,turn,deviation_um", *turns]))
    with pytest.raises(ReadingError, match="turn 2 has no reading at 70 deg"):
        figures_of(tmp_path / "s.csv")
