"""One case: pure, paired over variants, and true to what an independent look at the machine finds."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from axiscal.exceptions import PlanError
from axiscal.numerics.remembered import Memo
from axiscal.ports.study.study_case import FIGURES, Stop, StudyCase, outcome, prepared, taken
from axiscal.ports.study.study_file import read_study
from tests.ports.texts import STUDY, written

GRID = '[grid]\n"errors.EXX.std" = ["5 um", "15 um"]\n"setups" = [["laser"], "all"]\n'


def _cases(folder: Path) -> list[StudyCase]:
    return list(read_study(written(folder, STUDY.split("[grid]")[0] + GRID)).cases())


@pytest.mark.long
def test_a_case_is_a_function_of_itself(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cases = _cases(tmp_path)
    first = [outcome(case) for case in cases]
    monkeypatch.setattr("axiscal.ports.study.study_case._PREPARED", Memo())
    np.random.default_rng(5).random(3)
    assert [outcome(case) for case in reversed(cases)] == first[::-1]
    assert all(set(found) == {figure.column for figure in FIGURES.values()} for found in first)
    assert all(found["readings"] == 6 for found in first)


@pytest.mark.long
def test_every_variant_measures_the_same_machines(tmp_path: Path) -> None:
    cases = _cases(tmp_path)
    poses = np.linspace(0.0, 0.4, 9)[:, None]
    ways = np.ones_like(poses)
    shown = [prepared(case.variant).simulator.drawn(12).deviation(poses, ways) for case in cases]
    assert all(np.array_equal(each, shown[0]) for each in shown)
    zeros = [prepared(case.variant).simulator.drawn(12).offsets["laser"] for case in cases]
    assert all(each == zeros[0] for each in zeros)


def test_the_grid_states_a_std_and_the_truth_stays(tmp_path: Path) -> None:
    once, thrice = (prepared(case.variant) for case in _cases(tmp_path)[::4])
    stated = [{e.name: e.std for e in each.case.description.machine.errors}["EXX"] for each in (once, thrice)]
    assert stated == pytest.approx([5e-6, 15e-6])
    assert [e.std for e in thrice.simulator.machine.errors] == [e.std for e in once.simulator.machine.errors]


def test_readings_are_what_the_machine_does_within_their_noise(tmp_path: Path) -> None:
    ready = prepared(_cases(tmp_path)[0].variant)
    truth = ready.simulator.drawn(12)
    readings = taken(ready.case, truth, ready.places, 12)
    assert readings == taken(ready.case, truth, ready.places, 12)
    poses = np.array([each.pose for each in readings])
    ways = np.array([each.approach for each in readings], dtype=float)
    left = np.array([each.value for each in readings]) - truth.deviation(poses, ways)[:, 0]
    noise = ready.case.description.setups[0].noise_alone
    assert left - truth.offsets["laser"]["zero"] == pytest.approx(np.zeros(len(left)), abs=6 * noise + 1e-5)


@pytest.mark.long
def test_a_budget_is_kept_and_one_that_is_too_short_is_said(tmp_path: Path) -> None:
    case = _cases(tmp_path)[0]
    within = outcome(replace(case, variant=replace(case.variant, stop=Stop(budget=700.0))))
    assert within["minutes"] <= 700.0 / 60
    assert within["readings"] > 1
    with pytest.raises(PlanError, match="that the first reading takes"):
        prepared(replace(case.variant, stop=Stop(budget=1.0)))
