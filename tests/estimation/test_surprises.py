"""How far a reading is from what those before it allow, and readings in another unit, which are refused."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from axiscal.campaign import wrong_unit
from axiscal.campaign.wrong_unit import refuse_implausible
from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import estimated
from axiscal.estimation.judged import bent, surprises
from axiscal.estimation.stations import tips
from axiscal.exceptions import ReadingError
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import seen
from axiscal.measurement.simulation import Simulator
from axiscal_core.causes import wandered
from benchmarks.trust.virtual import described, read_evenly
from tests.generators.campaigns import built_in, drawn, mixed
from tests.generators.foreign_axis import LASER, foreign_case, foreign_readings
from tests.generators.laser_axis import CAMPAIGN, MACHINE, machine, read
from tests.generators.problems import readings_of
from tests.generators.texts import campaign_text, setup_text
from tests.generators.tracers import at_once, tracers


def _dense(
    case: Case, readings: Sequence[Reading], beside: Sequence[float], left_out: Sequence[int] = ()
) -> list[float]:
    """Return the same by the covariance of all numbers: errors scatter from place to place, unknowns do not.

    beside : m², of each reading; left_out : readings that tell nothing of the unknowns
    """
    (numbers, values), size = seen(case.observation, readings), case.errors.size
    prior, unknowns = case.errors.covariance(), range(size, size + len(case.observation.unknowns))
    stds = np.array([unknown.std for unknown in case.observation.unknowns])
    own = numbers.rows[:, list(unknowns)] * stds
    scatter = np.array([row @ prior @ row for row in numbers.rows[:, :size]]) + case.observation.variances(numbers)
    noise, common = scatter + np.array(beside)[numbers.place], own @ own.T
    found = []
    for reading in range(len(readings)):
        mine = np.flatnonzero(numbers.place == reading)
        before = np.flatnonzero((numbers.place < reading) & ~np.isin(numbers.place, left_out))
        inner = common[np.ix_(before, before)] + np.diag(noise[before])
        gain = common[np.ix_(mine, before)] @ np.linalg.inv(inner)
        expected = gain @ values[before]
        spread = np.diag(common[np.ix_(mine, mine)] - gain @ common[np.ix_(before, mine)]) + noise[mine]
        found.append(float(np.max(np.abs(values[mine] - expected) / np.sqrt(spread))))
    return found


def test_of_two_set_ups_it_is_that_of_one_normal_and_what_is_far_off_teaches_nothing() -> None:
    case = mixed()
    readings = [replace(each, time=None) for each in drawn(case, 12)]
    readings[3], readings[6] = (replace(readings[i], value=0.2) for i in (3, 6))
    found = surprises(case.observation, np.zeros(case.errors.size), case.errors.covariance(), readings)
    assert found == pytest.approx(_dense(case, readings, [0.0] * 12, [3, 6]), rel=1e-6)
    vouched = [replace(each, accepted=True) for each in readings]
    found = surprises(case.observation, np.zeros(case.errors.size), case.errors.covariance(), vouched)
    assert found == pytest.approx(_dense(case, readings, [0.0] * 12), rel=1e-6)


def test_a_zero_that_drifts_is_less_sure_the_farther_in_time_from_the_first_one_judged() -> None:
    rate = 6e-6 / 3600
    case = Case(campaign_from_texts(CAMPAIGN.replace('drift = "0 um/h"', 'drift = "6 um/h"'), "c.toml", MACHINE, "m"))
    readings = read(machine(4), 10)[::-1]
    beside = [float(wandered(rate, 540.0 - each.time)) for each in readings if each.time is not None]
    found = surprises(case.observation, np.zeros(case.errors.size), case.errors.covariance(), readings)
    assert found == pytest.approx(_dense(case, readings, beside), rel=1e-6)
    untimed = [replace(each, time=None) for each in readings]
    found = surprises(case.observation, np.zeros(case.errors.size), case.errors.covariance(), untimed)
    assert found == pytest.approx(_dense(case, untimed, [0.0] * 10), rel=1e-6)


OPEN = {"turn_x": "3 mrad", "turn_y": "4 mrad"} | {f"zero_{axis}": "1 mm" for axis in "xyz"}
TRACKER = campaign_text(
    "three-axis-mill",
    setup_text("tracker", "tracker", station=["-2 m", "0.3 m", "0.1 m"], unknowns=OPEN),
    target={"readings": 1},
)


@pytest.mark.parametrize("case", [tracers("300 mm", "100 mm"), at_once("300 mm", "100 mm")], ids=["alone", "at once"])
def test_a_distance_bends_by_the_square_of_what_lies_aside_over_twice_the_distance(case: Case) -> None:
    """Three coordinates of 0.3 m each, half a decimetre away: 0.27 m² / 0.1 m = 2.7 m, whatever else is open."""
    setup = case.description.setups[0]
    reading = Reading(setup.name, (0.1, 0.1, 0.1), (1, 1, 1), 0.0)
    assert bent(case.description.machine, setup, reading) == pytest.approx(2.7**2)


def test_a_tracker_bends_by_half_of_the_square_of_its_turn_at_the_tool() -> None:
    case = Case(built_in(TRACKER))
    (setup,), pose = case.description.setups, (0.1, 0.2, 0.3)
    (place,) = tips(case, [Reading("tracker", pose, (1, 1, 1), 0.0)])
    away = np.linalg.norm(place - np.array([-2.0, 0.3, 0.1]))
    found = bent(case.description.machine, setup, Reading("tracker", pose, (1, 1, 1), 0.0))
    assert found == pytest.approx((25e-6 * away / 2) ** 2, rel=1e-6, abs=0.0)
    known = replace(setup, unknowns=tuple(u for u in setup.unknowns if not u.name.startswith("turn")))
    assert bent(case.description.machine, known, Reading("tracker", pose, (1, 1, 1), 0.0)) == 0.0


def _readings(description: CampaignDescription, wrong: float, seed: int) -> list[Reading]:
    _, true = described("one-axis", wrong, "stated")
    machine = Simulator(true, description.setups).drawn(seed)
    return read_evenly(Case(description), machine, np.random.default_rng((seed, 5)), 15)


def _times(readings: list[Reading], factor: float) -> list[Reading]:
    return [replace(reading, value=factor * reading.value) for reading in readings]


@pytest.mark.parametrize("scales", ["stated", "estimate"])
@pytest.mark.parametrize("factor", [1000.0, 1 / 1000])
def test_readings_a_thousand_times_off_are_refused(scales: str, factor: float) -> None:
    description, _ = described("one-axis", 1.0, scales)
    for seed in range(2):
        with pytest.raises(ReadingError, match="instead of um"):
            refuse_implausible(_times(_readings(description, 1.0, seed), factor), description, "r.csv")


def test_most_of_a_file_has_to_be_implausible(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of fifteen readings, seven slips are slips of a reading each, and eight are those of the file."""
    monkeypatch.setattr(wrong_unit, "_refuse_other_unit", lambda *_: None)
    description, _ = described("one-axis", 1.0, "stated")
    readings = _readings(description, 1.0, 0)
    slips = [replace(each, value=1e-1 * (1 + number)) for number, each in enumerate(readings)]
    refuse_implausible([*slips[:7], *readings[7:]], description, "r.csv")
    with pytest.raises(ReadingError, match="8 of 15 readings are some"):
        refuse_implausible([*slips[:8], *readings[8:]], description, "r.csv")


def test_a_lost_decimal_point_is_that_of_one_reading_and_no_other_unit_of_all() -> None:
    """5.1 um, written as 51 mm."""
    readings, case = foreign_readings(LASER, 48, 1), foreign_case(LASER)
    lost = [replace(each, value=51e-3 if number == 8 else each.value) for number, each in enumerate(readings)]
    refuse_implausible(lost, case.description, "r.csv")
    with pytest.raises(ReadingError, match="instead of um"):
        refuse_implausible(_times(readings, 1e-3), case.description, "r.csv")
    assert [*estimated(case, lost).left_out] == [8]


def test_a_dial_that_shows_the_same_six_times_is_not_taken_for_another_unit() -> None:
    """Its zero takes the figure up, in whichever unit."""
    dial = setup_text("dial", "indicator", direction="z", moves=["X"])
    description = built_in(campaign_text("three-axis-mill", dial, target={"readings": 6}))
    park = description.setups[0].park[1:]
    same = [Reading("dial", (0.1 * (1 + n), *park), (1, 0, 0), 5e-6) for n in range(6)]
    refuse_implausible(same, description, "r.csv")


def test_stations_that_are_decimetres_off_are_no_other_unit() -> None:
    case = at_once("300 mm", "100 mm")
    description, readings = case.description, readings_of(case, 40, 3)
    refuse_implausible(readings, description, "r.csv")
    other = [replace(_times([r], 1000.0)[0], others=tuple(1000 * v for v in r.others)) for r in readings]
    with pytest.raises(ReadingError, match="unit"):
        refuse_implausible(other, description, "r.csv")
