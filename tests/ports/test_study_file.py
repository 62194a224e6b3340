"""study.toml: its cases, each pure and true to the machine, and what is wrong with it, with its line."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from axiscal.description.campaign import campaign_from_texts, read_campaign
from axiscal.estimation.timed import ends_along
from axiscal.exceptions import InputError, PlanError
from axiscal.measurement.simulation import by_number
from axiscal.numerics.remembered import Memo
from axiscal.ports.study.study_case import FIGURES, Stop, StudyCase, outcome, prepared
from axiscal.ports.study.study_file import read_study
from tests.ports.texts import CAMPAIGN, STUDY, written

HEAD = '[study]\ncampaign = "campaign.toml"\nmachines = 3\n'


def test_cases_are_every_combination_with_every_machine(tmp_path: Path) -> None:
    grid = '[grid]\n"target.rms" = ["2 um", "3 um"]\n"setups[*].noise" = ["0.3 um", "1 um", "2 um"]\n'
    study = read_study(written(tmp_path, HEAD + grid.replace("setups[*]", "setups[laser]")))
    cases = list(study.cases())
    assert study.count == len(cases) == 2 * 3 * 3
    assert len({case.key for case in cases}) == len(cases)
    assert [case.machine for case in cases] == [0, 1, 2] * 6


def test_a_choice_changes_what_it_names_and_nothing_else(tmp_path: Path) -> None:
    grid = '[grid]\n"target.rms" = ["4 um"]\n"setups[2].noise" = ["7 um"]\n"errors.EXX.std" = ["9 um"]\n'
    study = read_study(written(tmp_path, HEAD + grid))
    variant = next(study.cases()).variant
    base = read_campaign(tmp_path / "campaign.toml")
    changed = campaign_from_texts(variant.campaign, "c", variant.machine, "m")
    assert changed.target.rms == pytest.approx(4e-6)
    assert [setup.noise_alone for setup in changed.setups] == pytest.approx([base.setups[0].noise_alone, 7e-6])
    stds = {entry.name: entry.std for entry in changed.machine.errors}
    assert stds == pytest.approx({entry.name: entry.std for entry in base.machine.errors} | {"EXX": 9e-6})
    assert variant.truth == base.machine.text


FAULTS = [
    ('[grid]\n"target.rmss" = ["2 um"]\n', 5, "rmss", 'Perhaps "rms" is meant'),
    ('[grid]\n"targets.rms" = ["2 um"]\n', 5, 'there is no key "targets"', 'Perhaps "target" is meant'),
    ('[grid]\n"errors.EYY.std" = ["2 um"]\n', 5, 'there is no "EYY"', "EXX"),
    ('[grid]\n"errors.EXX.stdd" = ["2 um"]\n', 5, "stdd", '"std"'),
    ('[grid]\n"setups[3].noise" = ["2 um"]\n', 5, 'there is no "3" in setups', "its name"),
    ('[grid]\n"setups[lasr].noise" = ["2 um"]\n', 5, 'there is no "lasr"', "[laser]"),
    ('[grid]\n"setups.noise" = ["2 um"]\n', 5, "is no table", "setups[*]"),
    ('[grid]\n"setups[*]..noise" = ["2 um"]\n', 5, "is no path", "setups[*].noise"),
    ('[grid]\n"target.rms" = ["2 um", "2 parsec"]\n', 5, "parsec", ""),
    ('[grid]\n"target.rms" = []\n', 5, "there is no value", ""),
    ('[grid]\n"target.rms" = ["2 um", "2 um"]\n', 5, "is there twice", ""),
    ('[grid]\nsetups = [["laser", "lazer"]]\n', 5, 'no set-up "lazer"', '"laser", "dial"'),
    ("[grid]\nsetups = [3]\n", 5, "names no set-ups", '"all"'),
    ('[grid]\nmachine = ["five.toml"]\n', 5, "cannot vary", ""),
    ("[gird]\n", 4, 'unknown key "gird"', '"grid"'),
]


@pytest.mark.parametrize(("text", "line", "what", "remedy"), FAULTS)
def test_a_fault_is_said_with_its_line_and_what_would_be_right(
    tmp_path: Path, text: str, line: int, what: str, remedy: str
) -> None:
    file = written(tmp_path, HEAD + text)
    with pytest.raises(InputError) as caught:
        read_study(file)
    assert str(caught.value).startswith(f"{file}, line {line}: ")
    assert what in caught.value.what
    assert remedy in caught.value.remedy


@pytest.mark.parametrize(
    ("stop", "said"),
    [
        ('"now"', "not possible here"),
        ("{ readings = 0 }", "no number of readings"),
        ("{ readings = 3, budget = '1 h' }", "not possible here"),
        ("{ budget = '0 min' }", "no time to measure in"),
        ("{ budget = '3 um' }", "3 um"),
    ],
)
def test_a_stop_that_is_none_is_refused(tmp_path: Path, stop: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        read_study(written(tmp_path, f"{HEAD}stop = {stop}\n"))


def test_a_campaign_without_target_needs_a_stop(tmp_path: Path) -> None:
    campaign = CAMPAIGN.replace('rms = "3 um"', "")
    with pytest.raises(InputError, match="has no target to stop at"):
        read_study(written(tmp_path, HEAD, campaign))
    read_study(written(tmp_path, STUDY, campaign))


def test_the_digest_follows_every_text(tmp_path: Path) -> None:
    texts = product((STUDY, STUDY + "# note\n"), (CAMPAIGN, CAMPAIGN.replace("0.5 um", "0.6 um")))
    digests = {read_study(written(tmp_path, *pair)).digest for pair in texts}
    assert len(digests) == 4


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
    given = ready.case.description.setups, ready.places, ends_along(ready.case, ready.places)
    readings = truth.measured(*given, by_number(12))
    assert readings == truth.measured(*given, by_number(12))
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
