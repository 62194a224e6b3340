"""Twelve readings, where crashes show, tell a machine in order from one that is not, rarely wrongly."""

from __future__ import annotations

import csv
import io
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.cli.app import run
from axiscal.description.campaign import campaign_from_texts
from axiscal.errors.model import ErrorModel
from axiscal.estimation.case import Case
from axiscal.estimation.promise.problem import Inherited
from axiscal.evaluation.check import Check
from axiscal.exceptions import ReadingError
from axiscal.measurement.readers.csv_readings import filled_sheet
from axiscal.measurement.reading import Place, Places, Reading
from axiscal.measurement.simulation import Simulator
from axiscal.numerics import Array
from axiscal.ports.fleet.quick_check import QuickCheck, _CrashRows, crashes, showing_crashes
from tests.commands import Command
from tests.generators.campaigns import mixed
from tests.generators.sisters import measured, read_on, slide, write_record

KEPT, TRIALS = 0.9, 40


def _read(check: QuickCheck, errors: Array, seed: int, places: tuple[Place, ...]) -> tuple[Reading, ...]:
    described = check.case.description
    virtual = Simulator(described.machine, described.setups).with_coefficients(errors, seed)
    return measured(check.case, virtual, places, seed)


@pytest.mark.long
def test_false_alarms_are_as_rare_as_said_and_a_crash_is_found() -> None:
    described, rng = slide(), np.random.default_rng(12)
    model = ErrorModel(described.machine)
    root, size = model.prior_root(), model.size
    last = Inherited(5e-6 * rng.standard_normal(size), 0.01 * Case(described).errors.prior_covariance())
    check = QuickCheck(described, last, KEPT)
    places = check.planned(12)
    assert len(places) == 12
    alarms, found, by_tables = 0, 0, 0
    crash = np.zeros(size)
    crash[: size - 1] = np.linspace(0.0, 120e-6, size - 1)  # the scale is off by 120 um over the travel
    for trial in range(TRIALS):
        before = last.mean + 0.1 * root @ rng.standard_normal(size)
        now = KEPT * before + np.sqrt(1 - KEPT**2) * root @ rng.standard_normal(size)
        alarms += not check.judged(_read(check, now, trial, places)).in_order
        by_tables += not check.judged(_read(check, now - last.mean, trial, places), tables=True).in_order
        found += not check.judged(_read(check, now + crash, trial, places)).in_order
    assert alarms <= 0.03 * TRIALS
    assert by_tables <= 0.03 * TRIALS
    assert found >= 0.9 * TRIALS


SQUARE = """[[setups]]
name = "square"
instrument = "probe"
direction = "y"
moves = ["X"]
approach = "both"
noise = "0.5 um"
unknowns = { zero = "100 um" }
reach = { X = ["10 mm", "490 mm"] }
"""


def test_what_a_control_cannot_hold_is_no_alarm_where_its_tables_are_named() -> None:
    """A table of X holds no straightness in y: 40 um of it stay, which are no change of the machine."""
    machine = slide().machine.text.replace("EXX_rev", 'EYX = { std = "20 um", knots = 7, length = "150 mm" }\nEXX_rev')
    described = campaign_from_texts(slide().text + SQUARE, "campaign.toml", machine, "machine.toml")
    model = ErrorModel(described.machine)
    mean = 40e-6 * np.sin(np.linspace(0.0, 6.0, model.size))
    straight = next(term.columns for term in model.terms if term.name == "EYX")
    last = Inherited(mean, 0.01 * Case(described).errors.prior_covariance())
    held = np.ones(model.size)
    held[straight] = 0.0

    def control(poses: Array, approaches: Array) -> Array:
        return -model.rows(poses, approaches)[:, 0] @ (mean * held)[:, None]

    named, all_away = QuickCheck(described, last, 0.98, control), QuickCheck(described, last, 0.98)
    places = named.planned(12)
    assert {place.setup for place in places} == {"laser", "square"}
    crash = np.zeros(model.size)
    crash[straight] = np.linspace(0.0, 150e-6, straight.stop - straight.start) ** 2 / 150e-6
    readings = _read(named, mean * (1 - held), 1, places)
    assert named.judged(readings, tables=True).in_order
    assert not all_away.judged(readings, tables=True).in_order
    assert not named.judged(_read(named, mean * (1 - held) + crash, 1, places), tables=True).in_order


def test_the_command_plans_and_judges(
    tmp_path: Path, command: Command, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    record, sheet = write_record(tmp_path / "slide.axiscal", slide(), read_on(1)), tmp_path / "check.csv"
    assert run(["check", str(record), "--plan", str(sheet), "--readings", "6"]) == 0
    capsys.readouterr()
    rows = list(csv.DictReader(io.StringIO(sheet.read_text())))
    assert len(rows) == 6
    for far, in_order in ((0.0, True), (2000.0, False)):
        lines = [",".join([*rows[0]])]
        lines += [",".join([*list(row.values())[:-1], str(far * float(row["X_mm"]) / 500)]) for row in rows]
        sheet.write_text("\n".join(lines))
        assert command("check", record, sheet, "--kept", "0.5", "--json").document["in_order"] is in_order
        for language, words in (("en", "In order: |Measure again: "), ("de", "In Ordnung: |Neu messen: ")):
            monkeypatch.setenv("AXISCAL_LANGUAGE", language)
            assert command("check", record, sheet, "--kept", "0.5").printed.startswith(words.split("|")[not in_order])
        monkeypatch.setenv("AXISCAL_LANGUAGE", "en")
    for tables, said in (
        ("linuxcnc", ""),
        ("klipper", "This control is for X, Y and Z"),
        ("nobody", "not a controller"),
    ):
        assert run(["check", str(record), str(sheet), "--tables", tables]) == (1 if said else 0), tables
        assert said in capsys.readouterr().err
    sheet.write_text("setup,X_mm,approach,value_um\nother,10,X+,1\n")
    assert run(["check", str(record), str(sheet)]) == 1
    assert "no readings" in command("check", write_record(tmp_path / "empty.axiscal", slide(), [])).refusal


@pytest.mark.parametrize(("factor", "words"), [(1e3, "mm instead of um?"), (1e-3, "multiplied by 1000")])
def test_readings_in_another_unit_are_refused_as_when_they_are_recorded(
    tmp_path: Path, command: Command, factor: float, words: str
) -> None:
    record, sheet = write_record(tmp_path / "slide.axiscal", slide(), read_on(1)), tmp_path / "check.csv"
    slipped = [replace(each, value=factor * each.value) for each in read_on(1, again=1)]
    sheet.write_text(filled_sheet(slide().machine.axes, slipped))
    said = command("check", record, sheet).refusal
    assert f"{sheet}, line " in said
    assert words in said


def test_a_check_of_tables_refuses_what_was_found_in_another_unit(tmp_path: Path) -> None:
    """Tables that a control takes in another unit leave as much: that is no fault of the file."""
    with Campaign.open(write_record(tmp_path / "slide.axiscal", slide(), read_on(1)), write=False) as campaign:
        check = Check.from_campaign(campaign, "csv")
    found, left = tmp_path / "found.csv", tmp_path / "left.csv"
    for file, readings in zip((found, left), check.asked("sim:1", check.planned(10)), strict=True):
        file.write_text(filled_sheet(check.description.machine.axes, readings))
    left.write_text(left.read_text().replace("value_um", "value_mm"))
    assert check.read(found, left)[1]
    found.write_text(found.read_text().replace("value_um", "value_mm"))
    with pytest.raises(ReadingError, match=r"found\.csv, line .*mm instead of um"):
        check.read(found, left)


def _loss(case: Case, places: Places) -> float:
    """Return the sum over the crashes, by a Cholesky root of the scatter of all numbers."""
    rows, variances = list[Array](), list[Array]()
    for index in range(len(places)):
        one = places.single(index)
        for seen in case.observation.rows_each(int(one.setups[0]), one.poses, one.approaches):
            rows.append(seen.rows)
            variances.append(seen.variances)
    whole = np.concatenate(rows)
    root = np.linalg.cholesky(whole @ case.prior.covariance @ whole.T + np.diag(np.concatenate(variances)))
    looked_for = crashes(case.errors)
    off = np.linalg.solve(root, whole[:, : looked_for.shape[1]] @ looked_for.T)
    return float(np.sum(np.exp(-np.sum(off**2, axis=0) / 12.0)))


def test_how_far_crashes_stand_out_is_what_dense_algebra_says() -> None:
    case = mixed()
    first, second = (np.flatnonzero(case.lattice.setups == setup) for setup in (0, 1))
    places = case.lattice.within(np.concatenate([first[[0, 3, 9]], second[[0, 5, 11, 40]]]))
    assert len(set(places.setups.tolist())) == 2  # of one value and of three
    found = _CrashRows(case, places, crashes(case.errors)).losses([0, 2, 3, 4])
    assert np.isinf(found[[0, 2, 3, 4]]).all()
    for index in (1, 5, 6):
        np.testing.assert_allclose(found[index], _loss(case, places.within(np.array([0, 2, 3, 4, index]))), rtol=1e-8)


def test_readings_that_would_not_show_a_scale_are_moved_until_they_do() -> None:
    case = Case(slide())
    names = [term.name for term in case.errors.terms]
    assert names == ["EXX", "EXX_reversal"]
    looked_for = crashes(case.errors)
    assert looked_for.shape == (1, case.errors.size)
    np.testing.assert_allclose(looked_for[0, [0, -2]], [-60e-6, 60e-6], rtol=1e-6)
    middle = np.argsort(np.abs(case.lattice.poses[:, 0] - 0.25))[:5]
    before = case.lattice.within(middle)
    after = showing_crashes(case, before)
    assert len(after) == 5
    assert np.ptp(before.poses[:, 0]) < 0.02
    assert np.ptp(after.poses[:, 0]) > 0.4
    assert _loss(case, after) < 0.5 * _loss(case, before)
    assert showing_crashes(case, Places.none(1)).poses.shape == (0, 1)
