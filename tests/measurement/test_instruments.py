"""Ball bar, R-test, tracker and tracer in whole estimates, and the set-ups that are refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.cli.app import run
from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.description.placed_readings import placed_readings
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.judged import judged
from axiscal.exceptions import ReadingError
from axiscal.machine import load_machine
from axiscal.machine.kinematics import frames
from axiscal.measurement.readers.files import read_any
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import seen
from axiscal.measurement.simulation import Simulator, VirtualMachine
from tests.commands import Command

STATION = 'station = ["300 mm", "-800 mm", "-300 mm"]'


def _description(*setups: str) -> CampaignDescription:
    tables = "".join(f'[[setups]]\nname = "{i}"\n{setup}\n' for i, setup in enumerate(setups))
    text = f'machine = "three-axis-mill"\n[target]\nreadings = 1\n{tables}'
    return campaign_from_texts(text, "campaign.toml", load_machine("three-axis-mill").text, "three-axis-mill")


def _fed(description: CampaignDescription, seed: int, count: int) -> tuple[Estimation, VirtualMachine]:
    """Return what so many readings of a virtual machine make known, in each set-up in turn."""
    machine, rng = Simulator(description.machine, description.setups).drawn(seed), np.random.default_rng(seed)
    readings = list[Reading]()
    low, high = np.array([axis.travel for axis in description.machine.axes]).T
    for number in range(count):
        setup = description.setups[number % len(description.setups)]
        pose = tuple(map(float, rng.uniform(low, high)))
        value, *others = machine.read_all(setup, pose, (1, 1, 1), rng)
        readings.append(Reading(setup.name, pose, (1, 1, 1), value, others=tuple(others)))
    return concluded(Case(description), readings), machine


@pytest.mark.parametrize(
    "instrument", ["tracer", *(pytest.param(kind, marks=pytest.mark.long) for kind in ("ballbar", "tracker"))]
)
def test_the_place_of_a_station_is_found_within_its_sigma(instrument: str) -> None:
    estimation, machine = _fed(_description(f'instrument = "{instrument}"\n{STATION}'), 5, 40)
    columns = estimation.case.observation.unknowns_of(0)
    found, std = (
        estimation.knowledge.belief.mean[columns],
        np.sqrt(np.diagonal(estimation.knowledge.belief.covariance)[columns]),
    )
    hidden = [machine.offsets["0"][unknown.name] for unknown in estimation.case.description.setups[0].unknowns]
    assert np.all(np.abs(found - hidden) < 4 * std)
    assert len(estimation.outliers) <= 1  # of forty, at 1 % before any reading


@pytest.mark.long
def test_a_tracer_that_stands_millimetres_off_is_no_less_consistent() -> None:
    """Linearised once, 5 mm beside a line of 1 m is an error of 12 um; where it stands, the noise is left."""
    estimation, _ = _fed(_description(f'instrument = "tracer"\n{STATION}'), 7, 60)
    numbers = seen(estimation.knowledge.observation, estimation.readings)
    left = numbers.values - numbers.rows @ estimation.knowledge.belief.mean
    assert np.sqrt(np.mean(np.square(left))) < 2 * 0.3e-6


@pytest.mark.long
def test_several_instruments_see_one_machine() -> None:
    kinds = ('instrument = "rtest"', f'instrument = "tracker"\n{STATION}', 'instrument = "level"\ndirection = "y"')
    estimation, machine = _fed(_description(*kinds), 3, 60)
    poses = np.array([[0.1, 0.1, -0.1], [0.3, 0.2, -0.2], [0.5, 0.3, -0.3]])
    errors, rng = estimation.case.errors, np.ones((3, 3))
    rows, size = errors.rows(poses, rng), errors.size
    left = np.diff(machine.deviation(poses, rng) - rows @ estimation.knowledge.belief.mean[:size], axis=0)
    spread = np.linalg.norm(np.diff(rows, axis=0) @ estimation.knowledge.belief.factor[:size], axis=2)
    assert np.all(np.abs(left) < 4 * spread + 2e-6)


def test_three_values_come_from_a_file(tmp_path: Path) -> None:
    path = tmp_path / "readings.csv"
    path.write_text("setup,X_mm,Y_mm,Z_mm,value_x_um,value_y_um,value_z_um\n0,100,200,50,1,-2,3\n")
    (reading,) = placed_readings(read_any(path), _description('instrument = "rtest"'), path)
    assert reading.values == pytest.approx((1e-6, -2e-6, 3e-6))
    with pytest.raises(ReadingError, match="gives 1 values a reading"):
        placed_readings(read_any(path), _description('instrument = "probe"\ndirection = "x"'), path)


def test_two_of_three_values_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "readings.csv"
    path.write_text("setup,X_mm,Y_mm,Z_mm,value_x_um,value_y_um,value_z_um\n0,100,200,50,1,,3\n")
    with pytest.raises(ReadingError, match="line 2: the line has no value value_y"):
        read_any(path)


def test_three_values_are_recorded_and_kept(tmp_path: Path, command: Command) -> None:
    record = tmp_path / "mill.axiscal"
    Campaign.create(record, _description('instrument = "rtest"')).close()
    place = ["--at", "X=100 mm Y=200 mm Z=50 mm", "--setup", "0"]
    assert "is 2 values, and the instrument gives 3" in command("record", record, "1 um, 2 um", *place).refusal
    assert run(["record", str(record), "1 um, 2 um, -3 um", *place]) == 0
    with Campaign.open(record) as campaign:
        assert campaign.state.readings[-1].values == pytest.approx((1e-6, 2e-6, -3e-6))


def _thermal(text: str) -> CampaignDescription:
    return _description(f'instrument = "interferometer"\ndirection = "x"\nmoves = ["X"]\n{text}')


def test_lengths_are_brought_to_twenty_degrees_with_their_uncertainty() -> None:
    """3 K at 11.7 um/m/K over 300 mm from the middle are 10.53 um; 0.5 K and 1 um/m/K leave 2 um of it open there."""
    text = 'temperature = "23 degC"\nexpansion = "11.7 um/m/K"\ntemperature_std = "0.5 K"\nexpansion_std = "1 um/m/K"'
    warm, cold = Case(_thermal(text)).observation, Case(_thermal("")).observation
    reading = Reading("0", (0.6, 0.0, 0.0), (1, 0, 0), 20e-6)
    assert seen(warm, [reading]).values - seen(cold, [reading]).values == pytest.approx(-10.53e-6)
    (growth,) = [u for u in warm.setups[0].unknowns if u.name == "growth"]
    assert growth.std == pytest.approx(np.hypot(11.7e-6 * 0.5, 3 * 1e-6))


@pytest.mark.parametrize(
    "setup",
    [
        f'instrument = "tracker"\n{STATION}',
        f'instrument = "tracer"\n{STATION}',
        'instrument = "interferometer"\ndirection = [0.6, 0.8, 0.0]\nmoves = ["X", "Y"]',
    ],
)
def test_a_warm_machine_takes_the_tool_farther_from_the_middle(setup: str) -> None:
    """What is read of a machine at 23 degC that is right is 35.1 um/m of the way from the middle of all travels."""
    warm, cold = (Case(_description(f"{setup}\n{text}")).observation for text in ('temperature = "23 degC"', ""))
    places = np.array([[0.55, 0.35, 0.1], [0.1, 0.05, 0.3], [0.3, 0.2, 0.2]])
    if "interferometer" in setup:
        places[:, 2] = 0.2
    count = 3 if "tracker" in setup else 1
    readings = [Reading("0", tuple(each), (1, 1, 1), 0.0, others=(0.0,) * (count - 1)) for each in places.tolist()]
    taken_off = (seen(cold, readings).values - seen(warm, readings).values).reshape(3, count)
    grown = 35.1e-6 * (places - [0.3, 0.2, 0.2])
    away = frames(warm.machine, places).tcp - [0.3, -0.8, -0.3]
    by_hand = {
        "tracker": grown,
        "tracer": (np.linalg.norm(away + grown, axis=1) - np.linalg.norm(away, axis=1))[:, None],
        "interferometer": (grown @ [0.6, 0.8, 0.0])[:, None],
    }
    assert taken_off == pytest.approx(by_hand[warm.setups[0].instrument], abs=1e-12)


@pytest.mark.parametrize("kind", ["tracer", "ballbar", "tracker", "rtest", "level"])
def test_a_machine_three_times_worse_than_its_prior_gives_no_implausible_reading(kind: str) -> None:
    extra = {"level": 'direction = "y"', "rtest": ""}.get(kind, STATION)
    stated = _description(f'instrument = "{kind}"\n{extra}')
    errors = tuple(replace(entry, std=3 * entry.std) for entry in stated.machine.errors)
    worse = replace(stated, machine=replace(stated.machine, errors=errors))
    readings = _fed(worse, 0, 25)[0].readings
    case = Case(stated)
    assert not judged(case, readings)
