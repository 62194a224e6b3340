"""Files of a control from what the core knows: they hold what was put in, and what no table holds is refused."""

import csv
from pathlib import Path

import numpy as np
import pytest

import axiscal as ac
from axiscal.exceptions import TableError


def slide(aligned: bool = True) -> ac.Case:
    """Return two axes with the positioning and a straightness of the first."""
    axes = [ac.Axis.linear("X", "x", (0, "600 mm")), ac.Axis.linear("Y", "y", (0, "400 mm"))]
    errors = [ac.Error("EXX", "20 um", length="150 mm"), ac.Error("EYX", "20 um", length="150 mm")]
    instruments = [ac.Laser("x", "X", along="x"), ac.Laser("y", "X", along="y")]
    return ac.Case(ac.Machine(axes, errors), instruments, usual="off", sure="exactly", aligned=aligned)


def bent(case: ac.Case) -> ac.Known:
    """Return the knowledge of a slide that is longer by 50 um/m and bent by 30 um in its middle."""
    mean = np.zeros(case.size)
    for term in case.machine.curves:
        at = term.spline.knots
        mean[term.columns] = 50e-6 * at if term.name == "EXX" else 30e-6 * (1 - (at / 0.3 - 1) ** 2)
    return case.known(mean, 1e-20 * np.eye(case.size))


def read(file: Path) -> tuple[list[float], list[float]]:
    """Return positions in mm and deviations in um of a table."""
    rows = [*csv.DictReader(file.read_text(encoding="utf-8").splitlines())]
    return [float(row["position_mm"]) for row in rows], [float(row["forward_um"]) for row in rows]


@pytest.mark.parametrize("aligned", [True, False])
def test_tables_hold_what_is_known(tmp_path: Path, aligned: bool) -> None:
    files = ac.export(bent(slide(aligned)), "csv", tmp_path)
    assert sorted(files) == sorted(tmp_path.iterdir())
    at, found = read(tmp_path / "X.csv")
    assert np.array(found) - found[0] == pytest.approx(0.05 * (np.array(at) - at[0]), abs=0.05)
    at, found = read(tmp_path / "Y_over_X.csv")
    ends = np.interp(at, [at[0], at[-1]], [found[0], found[-1]])  # what a squareness takes is another table's
    assert np.array(found) - ends == pytest.approx(30 * (1 - (np.array(at) / 300 - 1) ** 2), abs=0.7)


def test_the_figures_of_a_readme_are_those_of_the_core(tmp_path: Path) -> None:
    case = slide()
    known = case.estimate(ac.Readings.simulated(case, case.lattice(24), seed=1))
    ac.export(known, "linuxcnc", tmp_path)
    text = (tmp_path / "README.txt").read_text(encoding="utf-8")
    assert f"U of the estimate is {1e6 * known.U:.2g} um" in text


def test_what_no_table_holds_is_refused(tmp_path: Path) -> None:
    tracker = ac.Tracker("tracker", ["J1"], ("1 m", "0 m", "0 m"))
    joint = ac.Machine([ac.Axis.turning("J1", "z", ("-90 deg", "90 deg"))], [ac.Error("ECJ1", "50 urad")], tool="0.1 m")
    tilted = ac.Machine(slide().machine.axes, [ac.Offset("tilt", "tool", (0, 0, 0, 0, 1, 0), "50 urad")])
    for machine, instrument, why in (
        (joint, tracker, r"has the axes J1, which no control has\. Correct poses by known\.deviation"),
        (tilted, ac.Level("level", "X", about="y"), r"has errors of its own basis \(tilt\)"),
    ):
        case = ac.Case(machine, [instrument], aligned=False)
        with pytest.raises(ac.InputError, match=f"export: known {why}"):
            ac.export(case.known(case.prior.mean, case.prior.covariance), "csv", tmp_path)
    with pytest.raises(TableError, match="not a controller that tables can be made for"):
        ac.export(bent(slide()), "abacus", tmp_path)
    with pytest.raises(ac.InputError, match="export: known"):
        ac.export("slide", "csv", tmp_path)  # type: ignore[arg-type]
    assert [*tmp_path.iterdir()] == []
