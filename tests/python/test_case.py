"""A campaign without a file: planned, estimated and exported in Python as on the command line."""

from __future__ import annotations

import sys
from pathlib import Path
from types import ModuleType
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

import axiscal as ac
import axiscal_core
from axiscal.exceptions import DescriptionError, ReadingError
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator
from axiscal.python.measured_case import Case
from axiscal_core import InputError
from tests.core.strangers import Grid
from tests.golden.surfaces import of_paper


def case() -> Case:
    laser = ac.setup("interferometer", "x", moves=["X"], name="laser", approach="both", park={"Y": "100 mm"})
    return ac.Case(ac.load_machine("three-axis-mill"), [laser], {"rms": "2 um"})


def test_the_keys_are_those_of_a_file(tmp_path: Path) -> None:
    written = tmp_path / "campaign.toml"
    written.write_text(
        'machine = "three-axis-mill"\n[target]\nrms = "2 um"\n'
        '[[setups]]\nname = "laser"\ninstrument = "interferometer"\n'
        'direction = "x"\nmoves = ["X"]\napproach = "both"\npark = { Y = "100 mm" }\n',
        encoding="utf-8",
    )
    described = ac.read_campaign(written)
    assert (case().description.setups, case().description.target) == (described.setups, described.target)


@pytest.mark.long
def test_a_class_of_ones_own_is_an_instrument(tmp_path: Path) -> None:
    grid = ac.Case(ac.load_machine("three-axis-mill"), [ac.setup(Grid, moves=["X", "Y"])])
    plan = grid.plan(readings=8, candidates=60)
    assert {place.setup for place in plan.places} == {"grid"}
    readings = [Reading(place.setup, place.pose, place.approach, 0.0, others=(0.0,)) for place in plan.places]
    known = ac.estimate(grid, readings)
    assert "AngabederUnsicherheit" in of_paper(known.report(tmp_path, language="de"))
    with pytest.raises(DescriptionError, match="is no class that is derived from"):
        ac.Case(ac.load_machine("three-axis-mill"), [ac.setup(Path)])  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        (Reading("laser", (0.1, 0.1), (1, 0), 1e-6), "readings, line 2: pose and approach"),
        (Reading("lazer", (0.1, 0.1, 0.2), (1, 0, 0), 1e-6), 'line 2: there is no set-up "lazer"'),
        (Reading("laser", (0.1, 0.1, 0.2), (1, 0, 0), 1e-6, others=(0.0,)), "line 2: .* gives 1 values a reading"),
        (Reading("laser", (9.0, 0.1, 0.2), (1, 0, 0), 1e-6), "line 2: X = 9000 mm"),
        (Reading("laser", (0.1, 0.1, 0.2), (3, 0, 0), 1e-6), "line 2: pose and approach"),
        (Reading("laser", (0.1, 0.1, 0.2), (1, 0, 0), np.nan), "line 2: its values or its std are no numbers"),
        (Reading("laser", (0.1, 0.1, 0.2), (1, 0, 0), 1e-6, std=-1e-6), "line 2: its values or its std"),
        (Reading("laser", (0.1, 0.1, 0.2), (1, 0, 0), 1e-6, std=0.0), "line 2: its values or its std"),
        (Reading("laser", ("0.1", 0.1, 0.2), (1, 0, 0), 1e-6), "line 2: pose and approach"),  # type: ignore[arg-type]
        (Reading("laser", (0.1, 0.1, 0.2), None, 1e-6), "line 2: pose and approach"),  # type: ignore[arg-type]
        (Reading("laser", (0.1, 0.1, 0.2), (1, 0, 0), 1e-6, time=np.nan), "line 2: its values or its std"),
        (Reading("laser", (0.1, 0.1, 0.2), (1, 0, 0), 1e-6, others=None), "line 2: its values"),  # type: ignore[arg-type]
    ],
)
def test_a_reading_that_no_setup_takes_is_refused_by_its_number(wrong: Reading, says: str) -> None:
    with pytest.raises(ReadingError, match=says):
        ac.estimate(case(), iter([Reading("laser", (0.1, 0.1, 0.2), (1, 0, 0), 1e-6), wrong]))


def test_a_plan_says_its_figures_and_shows_itself() -> None:
    plan = case().plan(readings=4, candidates=30)
    document = plan.document
    assert (len(plan), len(plan.places)) == (4, 4)
    assert document["rms_um"] == pytest.approx(1e6 * plan.rms)
    assert document["minutes"] == pytest.approx(plan.minutes)
    assert plan.bound is not None
    assert plan.bound <= plan.rms
    assert plan._repr_html_().count("<tr>") == 5
    assert "plan of 4 readings" in repr(plan)
    assert plan.plot().plots[0].y == pytest.approx(
        [document["before_rms_um"], *(p["rms_um"] for p in document["points"])]
    )


LINE = ac.Places("laser", [[x, 0.1, 0.2] for x in np.linspace(0.02, 0.58, 8).round(3)], [[1.0, 0.0, 0.0]] * 8)


def test_places_of_ones_own_are_judged_as_a_plan_is() -> None:
    plan = case().plan(readings=5, candidates=30)
    found = case().evaluate(plan.places)
    assert (found.rms, found.minutes) == pytest.approx((plan.rms, plan.minutes), rel=1e-9, abs=0)
    assert pytest.approx(plan.J, rel=1e-9, abs=0) == found.J
    assert found.rms < found.U < 2 * found.rms


def test_a_plan_goes_on_after_places_or_readings() -> None:
    mine = case()
    later = mine.plan(readings=3, after=LINE)
    whole = mine.evaluate(LINE + later.places)
    assert pytest.approx(whole.J, rel=1e-9, abs=0) == mine.evaluate(later.places, after=LINE).J
    assert mine.next(after=later.places).poses.shape == (1, 3)
    assert len(ac.Readings.simulated(mine, later.places, seed=1)) == len(later.places) == 3
    assert later.minutes < 5, "the laser is mounted already"
    read = ac.Readings.simulated(mine, LINE, seed=1)
    assert mine.plan(readings=3, after=read).rms < mine.estimate(read).rms
    assert np.array_equal(mine.next(after=mine.estimate(read)).poses, mine.next(after=read).poses)


@pytest.mark.parametrize("end", [{"readings": 4}, {"minutes": 32}, {"rms": "14 um"}])
def test_candidates_of_ones_own_are_the_only_places(end: dict[str, Any]) -> None:
    found = case().plan(candidates=LINE, **end).places
    assert {place.pose for place in found} <= {tuple(pose) for pose in LINE.poses.tolist()}


def test_what_is_shown_scatters_as_it_says() -> None:
    mine, truth = case(), case().prior.sample(1, seed=3)[0]
    shown = mine.shows(LINE, truth)
    drawn = np.array([ac.Readings.simulated(mine, LINE, seed, truth).values for seed in range(400)])
    root = np.linalg.cholesky(shown.covariance)
    apart = np.linalg.solve(root, (drawn - shown.mean).T)
    assert np.abs(apart @ apart.T / 400 - np.eye(len(LINE))).max() < 0.3


def test_arrays_a_table_and_a_list_are_the_same_readings(tmp_path: Path) -> None:
    mine = case()
    read = ac.Readings.simulated(mine, LINE, seed=2)
    listed = [Reading("laser", tuple(p), (1, 0, 0), v) for p, v in zip(LINE.poses.tolist(), read.values, strict=True)]
    table: dict[str, Any] = {
        "setup": ["laser"] * len(LINE), "X_mm": 1e3 * LINE.poses[:, 0], "approach": ["X+"] * len(LINE),
        "value_um": [repr(1e6 * float(value)) for value in read.values],
    }  # fmt: skip
    expected = mine.estimate(listed)
    for known in (mine.estimate(read), mine.estimate(table)):
        assert known.mean == pytest.approx(expected.mean, rel=1e-6, abs=1e-15)
    assert expected.table()["name"] == [*expected.names]
    assert np.cov(expected.sample(4000, seed=1).T)[0, 0] == pytest.approx(expected.covariance[0, 0], rel=0.1)
    found = expected.deviation([["100 mm", "100 mm", "200 mm"], [0.3, 0.1, 0.2]])
    assert (found.mean.shape, found.covariance.shape) == ((2, 3), (2, 3, 3))


def test_curves_are_a_dataset(monkeypatch: pytest.MonkeyPatch) -> None:
    known = case().estimate(ac.Readings.simulated(case(), LINE, seed=2))
    with pytest.raises(InputError, match="pip install xarray"):
        known.to_xarray()
    monkeypatch.setitem(sys.modules, "xarray", ModuleType("xarray"))
    monkeypatch.setattr(sys.modules["xarray"], "Dataset", dict, raising=False)
    data = known.to_xarray()
    along, mean, unit = data["EXX_mean"]
    assert (unit, data[along][2], data["ECX_std"][2]) == ({"units": "m"}, {"units": "m"}, {"units": "rad"})
    assert np.array_equal(mean, known["EXX"](data[along][1]).mean)


def test_instruments_of_the_core_read_a_machine_that_is_built_in() -> None:
    machine = ac.load_machine("three-axis-mill")
    laser = ac.Laser("laser", "X", along="x", noise="0.5 um", unknowns={"zero": "2 mm"}, park={"Y": "100 mm"})
    mine = ac.Case(machine, [laser, Grid("grid", "XY")])
    first, second = mine.description.setups
    assert (first.name, first.noise, first.park[1], first.unknowns[0].std) == ("laser", 0.5e-6, 0.1, 2e-3)
    assert {place.setup for place in mine.plan(readings=8, candidates=60).places} <= {first.name, second.name}
    ours = ac.setup("interferometer", "x", moves=["X"], approach="both", noise="0.5 um", unknowns={"zero": "2 mm"})
    there = [ac.Places(name, LINE.poses, LINE.sides) for name in ("laser", "interferometer x X")]
    theirs = ac.Case(machine, [{**ours, "park": {"Y": "100 mm"}}])
    assert (
        pytest.approx(theirs.evaluate(there[1]).J, rel=1e-12, abs=0) == ac.Case(machine, [laser]).evaluate(there[0]).J
    )


def test_a_machine_made_in_python_has_the_case_of_the_core() -> None:
    machine = ac.Machine([ac.Axis.linear("X", "x", (0, "600 mm"))], [ac.Error("EXX", "10 um", length="200 mm")])
    made = ac.Case(machine, [ac.Laser("laser", "X")], usual="off")
    assert isinstance(made, axiscal_core.Case)
    assert len(made.plan(readings=3)) == 3
    assert isinstance(ac.estimate(made, ac.Readings(ac.Places("laser", [[0.1]]), [0.0])), axiscal_core.Known)


def test_what_is_known_already_makes_curves_and_tables(tmp_path: Path) -> None:
    mine = case()
    size = mine.inner.errors.size
    known = mine.known(np.full(size, 5e-6), 1e-14 * np.eye(size))
    assert known["EXX"](["100 mm"]).mean == pytest.approx([5e-6])
    assert "X.comp" in {file.name for file in known.export("linuxcnc", tmp_path)}
    with pytest.raises(InputError, match=r"Estimated\.report: readings are none"):
        known.report(tmp_path)


def test_a_hostile_name_stays_text() -> None:
    name = '<b>"x"</b>'
    laser = ac.setup("interferometer", "x", moves=["X"], name=name)
    plan = ac.Case(ac.load_machine("three-axis-mill"), [laser]).plan(readings=2, candidates=40)
    assert plan.places[0].setup == name
    assert "<b>" not in plan._repr_html_()


def test_the_estimate_holds_the_truth_within_its_band() -> None:
    described = case().description
    truth, rng = Simulator(described.machine, described.setups).drawn(4), np.random.default_rng(1)
    setup = described.setups[0]
    readings = []
    for x in np.linspace(0.02, 0.58, 15):
        for side in (1, -1):
            pose, approach = (float(x), *setup.park[1:]), (side, 0, 0)
            readings.append(Reading("laser", pose, approach, truth.read_all(setup, pose, approach, rng)[0]))
    known = ac.estimate(case(), readings)
    poses: list[dict[str, float | int | str]] = [{"X": x, "Y": "100 mm"} for x in (0.1, 0.3, 0.5)]
    mean, std = known.deviation(*poses, approach={"X": 1})
    at = np.array([(x, *setup.park[1:]) for x in (0.1, 0.3, 0.5)])
    shown = truth.deviation(at, np.tile([1.0, 0.0, 0.0], (3, 1)))
    assert np.all(np.abs(mean - shown) < 4 * std)
    assert set(known) == set(known.estimation.case.errors.names)
    drawn = known.plot()
    assert [each.name for each in drawn.plots] == [name for name in known if known[name].spline.size > 1]
    assert [ElementTree.fromstring(svg).tag for svg in drawn.svg] == ["{http://www.w3.org/2000/svg}svg"] * len(
        drawn.plots
    )
    assert known._repr_html_().count("<tr>") == len(known) + 1


def test_tables_are_those_of_the_command(tmp_path: Path) -> None:
    known = ac.estimate(case(), [Reading("laser", (x, 0.1, 0.2), (1, 0, 0), 3e-4 * x) for x in (0.1, 0.2, 0.3, 0.5)])
    files = known.export("linuxcnc", tmp_path)
    assert sorted(file.name for file in files) == sorted(file.name for file in tmp_path.iterdir())
    assert (tmp_path / "X.comp").is_file()
