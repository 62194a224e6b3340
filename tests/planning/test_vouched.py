"""What readings can vouch for, as a person reads it and as programs do."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

from axiscal.cli.app import app
from axiscal.design.plan.task import Limits
from axiscal.estimation.case import Case
from axiscal.estimation.defence import COUNTED, Defence, Departed
from axiscal.estimation.scatter import Scatter
from axiscal.estimation.statements import Resting, Statement
from axiscal.measurement.departures import Family
from axiscal.planning.proposal import Thoroughness, proposed
from axiscal.planning.vouched import _SHOWN_BY, _WORDS, departure_rows, vouched_by_plan, vouched_words
from tests.design.test_out_and_back import one_axis

DRIFT = Departed("drift", "laser", 0.2, 3.04e-6, 5e-6, 0.0, counted=True)
STEP = Departed("step", "EXX", 0.5, 12.3e-6, 1.5e-6, 0.4, counted=True)
BUMP = Departed("bump", "EXX", 0.0, float("inf"), 2e-6, 0.4, counted=True)
REVERSAL = Departed("reversal", "EXX_reversal", 0.1, 9e-6, 8e-6, 0.4, counted=False)
BOTH_SIDES = "A reading along x while X moves and comes from both sides would show EXX_reversal."


def case() -> Case:
    """Return the built-in axis with a laser."""
    return one_axis()[0]


def test_what_readings_could_not_show_is_said_with_its_size() -> None:
    said = vouched_words(case(), Defence(5e-6, 0.6e-6, 9, (REVERSAL, DRIFT, BUMP, STEP)))
    assert said == (
        'These 9 readings could not show a drift of "laser" above 3 um, a detail of EXX of any size, a step in EXX '
        "above 12 um; what they can vouch for is a standard uncertainty of 5 um. Readings in the widest gaps would "
        "show a detail of EXX."
    )


def test_a_drift_that_levels_off_is_a_drift() -> None:
    levelling = Departed("levelling", "laser", 0.2, 3.04e-6, 4e-6, 0.0, counted=True)
    said = vouched_words(case(), Defence(5e-6, 0.6e-6, 1, (DRIFT, levelling)))
    assert said.startswith('This 1 reading could not show a drift of "laser" above 3 um; what')
    later = replace(levelling, seen_from=4e-6)
    for both in ((DRIFT, later), (later, DRIFT)):
        said = vouched_words(case(), Defence(5e-6, 0.6e-6, 9, both))
        assert said.startswith('These 9 readings could not show a drift of "laser" above 4 um; what')


@pytest.mark.parametrize(("family", "owner"), [("excursion", "laser"), ("growth", "EXX")])
def test_what_would_show_what_comes_and_goes_is_said_where_no_size_of_it_shows(family: Family, owner: str) -> None:
    open_one = Departed(family, owner, 0.0, float("inf"), 5e-6, 0.0, counted=True)
    said = vouched_words(case(), Defence(5e-6, 0.6e-6, 4, (open_one,)))
    assert owner in said.rsplit("Places ", 1)[1]
    assert said.count("any size") == 1


def test_every_family_that_a_promise_is_defended_against_is_said_with_what_would_show_it() -> None:
    assert set(_WORDS) >= COUNTED
    assert set(_SHOWN_BY) >= COUNTED


def test_what_comes_and_goes_is_said_of_a_zero_and_of_an_axis() -> None:
    zero = Departed("excursion", "laser", 0.1, 5.38e-6, 2e-6, 0.0, counted=True)
    growth = Departed("growth", "EXX", 0.1, 31.29e-6, 2.4e-6, 0.0, counted=True)
    said = vouched_words(case(), Defence(2.4e-6, 0.6e-6, 24, (growth, zero)))
    assert said == (
        'These 24 readings could not show a growth of EXX that comes and goes above 31 um, a zero of "laser" that '
        "comes and goes above 5.4 um; what they can vouch for is a standard uncertainty of 2.4 um."
    )


def test_readings_that_show_enough_vouch_for_a_figure() -> None:
    said = vouched_words(case(), Defence(0.66e-6, 0.6e-6, 24, (replace(DRIFT, damage=0.66e-6),)))
    assert said == "24 readings could vouch for 0.66 um (standard uncertainty)."


def test_what_rests_on_statements_is_said_with_what_would_show_it() -> None:
    line, zero = Statement("EXX_reversal", "", 3e-6), Statement("zero", "laser", 1e-3, 0)
    rests_on = Resting((line,), 0.68, 4e-6, 0.07, 6e-6, (zero,))
    found = Defence(6e-6, 5e-6, 24, (), rests_on)
    leaves = "These 24 readings leave as stated EXX_reversal (3 um): 68 % of the promised variance rests on what is "
    leaves += "stated alone, and what can be vouched for is a standard uncertainty of 6 um. "
    shown = 'They would show it with zero of "laser" (1000 um) known better than that.'
    assert vouched_words(case(), found) == leaves + shown
    alone = replace(found, rests_on=replace(rests_on, shown_by=()))
    assert vouched_words(case(), alone) == leaves + BOTH_SIDES
    placed = replace(rests_on, named=(zero,), shown_by=())
    assert vouched_words(case(), replace(found, rests_on=placed)).endswith("Only another set-up would show it.")
    itself = replace(found, rests_on=replace(rests_on, named=(zero,)))
    assert vouched_words(case(), itself).endswith("Measured by itself and stated closer it would leave less.")
    two = replace(rests_on, named=(line, zero), shown_by=(zero, line))
    closer = "Measured by themselves and stated closer they would leave less."
    assert vouched_words(case(), replace(found, rests_on=two)).endswith(closer)
    both = vouched_words(case(), replace(found, departures=(replace(DRIFT, damage=7e-6),)))
    assert both.startswith('These 24 readings could not show a drift of "laser" above 3 um; what')
    leaves = (
        "They leave as stated EXX_reversal (3 um), too: 68 % of the promised variance rests on what is stated alone. "
    )
    assert both.endswith(f"a standard uncertainty of 6 um. {leaves}{shown}")
    little = replace(found, rests_on=replace(rests_on, bearable=4e-6)).promising(5e-6)
    assert vouched_words(case(), little) == "24 readings could vouch for 5 um (standard uncertainty)."
    assert departure_rows(case(), little) == []


def test_what_can_be_vouched_for_is_said_once_where_a_noise_is_open_beside_a_drift() -> None:
    scatter = Scatter(0, 3e-6, 3, 3e-6)
    found = Defence(14e-6, 1e-6, 40, (replace(DRIFT, damage=14e-6),), None, scatter)
    said = vouched_words(case(), found)
    assert said == (
        'These 40 readings could not show a drift of "laser" above 3 um; what they can vouch for is a standard '
        'uncertainty of 14 um. They do not tell the noise of "laser" (3 um) from what the machine does from place to '
        "place either. Read 3 places once more."
    )


def test_a_row_says_what_a_promise_rests_on() -> None:
    line = Statement("EXX_reversal", "", 3e-6)
    (row,) = departure_rows(case(), Defence(6e-6, 5e-6, 24, (), Resting((line,), 0.68, 4e-6, 0.07, 6e-6)))
    assert row == {
        "name": "statement EXX_reversal",
        "power": 0.0,
        "seen_from_um": None,
        "damage_um": 4.0,
        "hidden": 0.07,
        "bearable_um": 6.0,
        "unit": "um",
        "counted": True,
    }


@pytest.mark.long
def test_no_number_of_readings_is_said_to_do_for_what_is_only_stated(tmp_path: Path) -> None:
    machine = 'chain = "w-b-X-t"\n[axes.X]\ntravel = ["0 mm", "1 m"]\n[errors]\n'
    (tmp_path / "m.toml").write_text(machine + 'EXX = { std = "3 um", knots = 9 }\nEXX_reversal = { std = "20 um" }\n')
    (tmp_path / "c.toml").write_text(
        'machine = "m.toml"\n[target]\nreadings = 24\n[[setups]]\nname = "laser"\ninstrument = "interferometer"\n'
        'direction = "x"\napproach = "+"\nnoise = "0.5 um"\n'
    )
    document = json.loads(CliRunner().invoke(app, ["plan", str(tmp_path / "c.toml"), "--json"]).stdout)
    assert document["departures"][0]["name"] == "statement EXX_reversal"
    assert document["enough_readings"] is None
    assert document["defended_um"] > document["rms_um"]
    printed = CliRunner().invoke(app, ["plan", str(tmp_path / "c.toml")]).stdout
    assert "leave as stated EXX_reversal (20 um)" in printed
    assert BOTH_SIDES in " ".join(printed.split())


def test_rows_have_units_and_no_infinite_number() -> None:
    rows = departure_rows(case(), Defence(5e-6, 0.6e-6, 9, (DRIFT, BUMP)))
    assert [row["name"] for row in rows] == ["drift laser", "bump EXX"]
    assert [row["seen_from_um"] for row in rows] == [pytest.approx(3.04), None]
    assert json.loads(json.dumps(rows, allow_nan=False)) == rows


def test_a_plan_says_what_its_readings_can_vouch_for(tmp_path: Path) -> None:
    plan = proposed(case(), Limits(readings=12), Thoroughness(candidates=300)).plan
    found = vouched_by_plan(case(), plan)
    assert found.readings == 12
    assert found.u_def >= found.promise == plan.accuracy.rms
    (tmp_path / "c.toml").write_text(
        'machine = "one-axis"\n[target]\nreadings = 14\n[[setups]]\nname = "laser"\ninstrument = "interferometer"\n'
        'direction = "x"\napproach = "both"\nnoise = "0.5 um"\n'
    )
    document = json.loads(CliRunner().invoke(app, ["plan", str(tmp_path / "c.toml"), "--json"]).stdout)
    assert document["defended_um"] >= document["rms_um"]
    assert document["guarded"] is True
    assert document["enough_readings"] > 14
    assert document["enough_defended_um"] < document["defended_um"]
    assert {row["name"] for row in document["departures"]} >= {"drift laser", "step EXX", "pitch EXX", "bump EXX"}
    printed = CliRunner().invoke(app, ["plan", str(tmp_path / "c.toml")]).stdout
    assert f"{document['enough_readings']} readings could vouch for {document['enough_defended_um']:.3g} um." in printed


@pytest.mark.long
@pytest.mark.parametrize("criterion", ["joint", "worst"])
def test_a_plan_by_another_criterion_says_that_nothing_guards_it(criterion: str, tmp_path: Path) -> None:
    (tmp_path / "c.toml").write_text(
        f'machine = "one-axis"\n[target]\nreadings = 12\ncriterion = "{criterion}"\n[[setups]]\nname = "laser"\n'
        'instrument = "interferometer"\ndirection = "x"\napproach = "both"\nnoise = "0.5 um"\n'
    )
    asked = ["plan", str(tmp_path / "c.toml"), "--candidates", "300"]
    document = json.loads(CliRunner().invoke(app, [*asked, "--json"]).stdout)
    assert document["guarded"] is False
    assert document["defended_um"] > 1.25 * document["rms_um"]
    printed = " ".join(CliRunner().invoke(app, asked).stdout.split())
    assert "These 12 readings could not show" in printed
    assert f'Mind: criterion = "{criterion}" chooses readings by the model alone' in printed


@pytest.mark.long
def test_a_plan_that_is_to_teach_what_two_axes_do_together_says_that_nothing_guards_it(tmp_path: Path) -> None:
    travel = 'travel = ["0 mm", "400 mm"]\n'
    curve = '{ std = "10 um", length = "200 mm", knots = 5 }\n'
    plane = 'EZXY = { std = "10 um", length = "150 mm", knots = 5 }\n'
    (tmp_path / "m.toml").write_text(
        f'chain = "w-b-X-Y-t"\n[axes.X]\n{travel}[axes.Y]\n{travel}[errors]\nEZX = {curve}EZY = {curve}{plane}'
    )
    (tmp_path / "c.toml").write_text(
        'machine = "m.toml"\nSCALES[target]\nreadings = 9\n[[setups]]\nname = "probe"\ninstrument = "probe"\n'
        'direction = "z"\nnoise = "0.5 um"\nreach = { X = ["0 mm", "400 mm"], Y = ["0 mm", "400 mm"] }\n'
    )
    learnt = (tmp_path / "c.toml").read_text()
    said = {}
    for scales in ('scales = "estimate"\n', ""):
        (tmp_path / "c.toml").write_text(learnt.replace("SCALES", scales))
        asked = ["plan", str(tmp_path / "c.toml"), "--candidates", "200"]
        said[scales] = " ".join(CliRunner().invoke(app, asked).stdout.split())
    assert [words.count("These 9 readings could not show") for words in said.values()] == [1, 1]
    alone = "Mind: readings that are to teach how much two axes do together are chosen by the model alone;"
    assert [words.count(alone) for words in said.values()] == [1, 0]
