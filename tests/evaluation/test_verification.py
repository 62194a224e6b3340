"""The check after compensation: new places, both extremes, and a verdict that knows its uncertainty."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import CampaignDescription
from axiscal.estimation.case import Case
from axiscal.estimation.machine_estimate import Estimate
from axiscal.evaluation import table_checks
from axiscal.evaluation.check import Check, tolerance_of
from axiscal.evaluation.datums import GUARD
from axiscal.evaluation.verification import decision, judge, plan_check, with_displacements
from axiscal.exceptions import ReadingError
from axiscal.measurement.reading import Places, Reading
from axiscal.measurement.reading_rows import places_of
from axiscal.measurement.simulation import Simulator, VirtualMachine
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.registry import export
from axiscal.tables.surface import Control
from tests.evaluation.said import idle, measured, readings_of, said_of
from tests.generators.campaigns import on
from tests.generators.reaches import reach_of
from tests.generators.texts import machine_text, setup_text

MACHINE = machine_text(
    "w-X'-b-Y-t",
    {"X": (0, 300), "Y": (0, 200)},
    {"EXX EYY": "20 um", "C0Y": "90 urad", "EXX_reversal": "4 um"},
    tool=50,
    name="Bench",
)
PROBES = [
    setup_text(f"along {way}", "probe", direction=way, noise="0.4 um", unknowns={"zero": "100 um"}) for way in "xy"
]
SETUPS = [each + reach_of(MACHINE) for each in (*PROBES, setup_text("level", "level", direction="z"))]
SEED = 11


def description() -> CampaignDescription:
    return on(MACHINE, *SETUPS, target={"rms": "1.5 um", "readings": 40}, usual="off", sure="exactly")


def true() -> VirtualMachine:
    return Simulator(description().machine, description().setups).drawn(SEED)


@pytest.fixture(scope="module")
def record(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return measured(tmp_path_factory.mktemp("verify") / "bench.axiscal", description(), SEED)


State = tuple[Estimate, tuple[Reading, ...], Control]
"""What a campaign has made known, its readings, and what its tables add."""


@pytest.fixture(scope="module")
def state(record: Path) -> State:
    with Campaign.open(record, write=False) as campaign:
        estimate = campaign.estimate().estimate()
        return estimate, tuple(campaign.state.readings), export(estimate, "csv", ExportOptions()).control


@pytest.fixture(scope="module")
def eight(state: State) -> Places:
    """Return eight places of a check."""
    return planned(state, 8)


def planned(state: State, count: int) -> Places:
    estimate, used, _ = state
    setups = description().setups
    candidates = with_displacements(setups, Case(description()).lattice)
    new = candidates.within(table_checks.far_from(estimate.machine, candidates, places_of(setups, used)))
    return plan_check(estimate, setups, new, (), count)


def readings(truth: VirtualMachine, places: Places, control: Control, seed: int) -> tuple[Reading, ...]:
    """What the set-ups of a campaign would show on the true machine under a control."""
    return readings_of(description().setups, truth, places, control, seed)


@pytest.mark.long
def test_places_are_new_and_of_both_set_ups(state: State) -> None:
    estimate, used, _ = state
    chosen = planned(state, 12)
    assert len(chosen.setups) == 12
    assert set(chosen.setups.tolist()) == {0, 1}
    lengths = np.array([axis.length for axis in estimate.machine.axes])
    for reading in used:
        mine = chosen.poses[chosen.setups == [s.name for s in description().setups].index(reading.setup)]
        if len(mine):
            assert np.min(np.max(np.abs(mine - np.array(reading.pose)) / lengths, axis=1)) >= 0.05
    assert len(np.unique(np.hstack([chosen.setups[:, None], chosen.poses, chosen.approaches]), axis=0)) == 12


def test_more_places_than_are_new_are_refused(state: State) -> None:
    with pytest.raises(ReadingError, match=r"only \d+ places of 500 are new") as refused:
        planned(state, 500)
    new = int(str(refused.value.what).split()[1])
    assert refused.value.remedy == f"Ask for --points {new} or fewer"
    few = planned(state, 8).within(np.array([0]))
    with pytest.raises(ReadingError, match=r"too few places are new to tell the machine") as refused:
        plan_check(state[0], description().setups, few, (), 2)
    assert "fewer" not in refused.value.remedy


LEVEL = machine_text("w-X'-Y'-b-Z-t", {"X": (0, 600), "Y": (0, 400), "Z": (-250, 0)}, {"EZY": "100 um"})
EDGE = setup_text(
    "edge", "straightedge", direction="z", moves=["Y"], reach={"Y": ["0 mm", "400 mm"]}, raster={"Y": "40 mm"}
)


@pytest.mark.parametrize("tables", ["as they are", "that ask for no place"])
def test_where_fewer_places_are_new_than_usual_those_are_read(
    tables: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Eleven places, of which the campaign has read six."""
    described = on(LEVEL, EDGE, target={"readings": 6}, usual="off", sure="exactly")
    with Campaign.open(measured(tmp_path / "m.axiscal", described, 1), write=False) as campaign:
        check = Check.from_campaign(campaign, "csv")
        if tables == "that ask for no place":
            monkeypatch.setattr(Check, "parts", ())
        assert 4 <= len(check.planned()) <= 7


def test_the_right_tables_pass_and_the_wrong_ones_fail(state: State) -> None:
    estimate, _, control = state
    truth, setups, places = true(), description().setups, planned(state, 12)
    found = readings(truth, places, idle, 1)
    good = judge(estimate, setups, found, readings(truth, places, control, 2), control, 6e-6, (), 6e-6)
    assert (good.verdict, good.decision) == ("promised", "conform")
    assert np.max(np.abs(good.left)) < 0.3 * np.max(np.abs(good.found))
    wrong = judge(
        estimate, setups, found, readings(truth, places, lambda p, a: -control(p, a), 2), control, 6e-6, (), 6e-6
    )
    missing = judge(estimate, setups, found, readings(truth, places, idle, 2), control, 6e-6, (), 6e-6)
    for other, share, cause in ((wrong, -1.0, "loaded with the wrong sign"), (missing, 0.0, "were not loaded")):
        assert (other.verdict, other.decision, other.loaded) == ("worse", "not conform", False)
        assert other.share == pytest.approx(share, abs=0.1)
        assert cause in said_of(other)
    near = float(np.max(np.abs(good.left)))
    again = judge(estimate, setups, found, readings(truth, places, control, 2), control, 6e-6, (), near)
    assert (again.verdict, again.decision) == ("promised", "neither")


def test_an_instrument_that_does_not_move_decides_nothing(state: State, eight: Places) -> None:
    estimate, _, control = state
    found = readings(true(), eight, idle, 1)
    stuck = tuple(replace(reading, value=0.0) for reading in found)
    judged = judge(estimate, description().setups, found, stuck, control, 30e-6)
    assert judged.verdict == "undecided"
    assert set(judged.still) == {reading.setup for reading in found}
    assert "the instrument does not move" in said_of(judged)


@given(st.lists(st.floats(-1e-5, 1e-5), min_size=1, max_size=9), st.floats(1e-8, 1e-6), st.floats(1e-7, 1e-5))
@example([1.05e-6], 1e-7, 1e-6)
def test_a_tolerance_is_decided_by_the_guard_band(values: list[float], std: float, tolerance: float) -> None:
    deviations, stds = np.array(values), np.full(len(values), std)
    decided = decision(deviations, stds, tolerance)
    worst = float(np.max(np.abs(deviations)))
    assert (decided == "conform") == (worst + GUARD * std <= tolerance)
    assert (decided == "not conform") == (worst - GUARD * std > tolerance)
    assert decision(-deviations, stds, tolerance) == decided
    assert decision(deviations, stds, tolerance * 1e3) == "conform"


def test_readings_of_other_places_are_refused(state: State, eight: Places) -> None:
    estimate, _, control = state
    truth, setups = true(), description().setups
    found = readings(truth, eight, idle, 1)
    with pytest.raises(ReadingError, match="8 as-found and 7 as-left"):
        judge(estimate, setups, found, found[:-1], control, 1e-6)
    with pytest.raises(ReadingError, match="not read at the same place"):
        judge(estimate, setups, found, found[::-1], control, 1e-6)
    level = tuple(replace(reading, setup="level") for reading in found)
    with pytest.raises(ReadingError, match='"level" reads no displacement'):
        judge(estimate, setups, level, level, control, 1e-6)
    with pytest.raises(ReadingError, match="cannot tell the machine from the set-up"):
        judge(estimate, setups, found[:1], found[:1], control, 1e-6)


@pytest.mark.parametrize(
    ("target", "allowed"), [({"worst": 9e-6}, 9e-6), ({"rms": 4e-6}, None), ({"expanded": 7e-6}, None)]
)
def test_only_a_largest_deviation_is_a_tolerance(target: dict[str, Any], allowed: float | None) -> None:
    none = replace(description().target, rms=None, worst=None, expanded=None)
    assert tolerance_of(replace(none, **target), None) == allowed
    assert tolerance_of(replace(none, **target), "3 um") == pytest.approx(3e-6)
