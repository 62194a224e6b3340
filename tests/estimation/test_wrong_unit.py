"""Readings in another unit are refused, whether or not scales are learnt; a wrong prior is no other unit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from axiscal.description.campaign import CampaignDescription
from axiscal.estimation import wrong_unit
from axiscal.estimation.case import Case
from axiscal.estimation.wrong_unit import refuse_implausible
from axiscal.exceptions import ReadingError
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator
from benchmarks.nonlinear.stations import at_once, tracers
from benchmarks.trust.virtual import described, read_evenly


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
    for seed in range(4):
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


@pytest.mark.parametrize("scales", ["stated", "estimate"])
@pytest.mark.parametrize("wrong", [1 / 3, 1.0, 3.0])
def test_a_prior_that_is_wrong_by_three_is_no_other_unit(scales: str, wrong: float) -> None:
    description, _ = described("one-axis", wrong, scales)
    for seed in range(4):
        refuse_implausible(_readings(description, wrong, seed), description, "r.csv")


def test_readings_of_nothing_at_all_are_not_taken_for_another_unit() -> None:
    description, _ = described("one-axis", 1.0, "stated")
    refuse_implausible(_times(_readings(description, 1.0, 0), 0.0), description, "r.csv")


@pytest.mark.parametrize("make", [tracers, at_once])
def test_stations_that_are_decimetres_off_are_no_other_unit(make: Callable[[str, str], Case]) -> None:
    description = make("300 mm", "100 mm").description
    machine, rng = Simulator(description.machine, description.setups).drawn(3), np.random.default_rng(3)
    low, high = np.array([axis.travel for axis in description.machine.axes]).T
    readings = []
    for number in range(40):
        setup, pose = description.setups[number % len(description.setups)], tuple(rng.uniform(low, high).tolist())
        value, *others = machine.read_all(setup, pose, (1,) * len(low), rng)
        readings.append(Reading(setup.name, pose, (1,) * len(low), value, others=tuple(others)))
    refuse_implausible(readings, description, "r.csv")
    other = [replace(_times([r], 1000.0)[0], others=tuple(1000 * v for v in r.others)) for r in readings]
    with pytest.raises(ReadingError, match="unit"):
        refuse_implausible(other, description, "r.csv")
