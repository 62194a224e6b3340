"""What a set-up says of readings that are not normal: read, refused, simulated, estimated."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.measurement.simulation import Simulator
from tests.generators.campaigns import on
from tests.generators.one_axis import observed
from tests.generators.texts import machine_text, setup_text


def test_a_bound_counts_with_its_variance_and_is_an_interval() -> None:
    (setup,) = observed('noise = "1 um"\nbound = "6 um"').setups
    assert setup.noise == pytest.approx(np.sqrt(1 + 12.0) * 1e-6)
    assert (setup.interval, setup.scatter, setup.noise_alone) == pytest.approx((12e-6, 1e-6, 1e-6))
    (fine,) = observed('noise = "0.1 um"\nbound = "6 um"\nresolution = "1 um"').setups
    assert fine.scatter == pytest.approx(0.6e-6)
    assert fine.noise_alone == pytest.approx(0.1e-6)


def test_a_simulated_bound_is_kept() -> None:
    observation = observed('noise = "0.1 um"\nbound = "5 um"\nunknowns = {}')
    machine, rng = Simulator(observation.machine, observation.setups).drawn(1), np.random.default_rng(0)
    read = np.array([machine.read_all(observation.setups[0], (0.5,), (1,), rng)[0] for _ in range(400)])
    assert np.ptp(read) == pytest.approx(10e-6, rel=0.1)


def test_a_dead_band_along_the_way_is_a_lag_by_the_side_of_approach() -> None:
    observation = observed('dead_band = "3 um"\napproach = "both"\nunknowns = {}')
    (setup,) = observation.setups
    assert [(u.name, u.std) for u in setup.unknowns] == [("lag", 3e-6)]
    poses = np.array([[0.2], [0.2], [0.2]])
    rows = observation.rows(0, poses, np.array([[1.0], [-1.0], [0.0]]))
    assert rows.rows[:, observation.errors.size] == pytest.approx([1.0, -1.0, 0.0])
    assert rows.variances[2] - rows.variances[0] == pytest.approx(9e-12)
    point = np.zeros(observation.size)
    point[-1] = 2e-6
    shown = observation.shown(0, poses, np.array([[1.0], [-1.0], [0.0]]), point)
    assert shown[:, 0] == pytest.approx([2e-6, -2e-6, 0.0], abs=1e-15)


def test_a_dead_band_where_two_axes_move_is_a_bound() -> None:
    machine = machine_text("w-b-X-Y-t", {"X": (0, 300), "Y": (0, 300)}, {"EXX EYX": "5 um"})
    (both,) = on(machine, setup_text("it", "indicator", direction="x", moves=["X", "Y"], dead_band="3 um")).setups
    assert (both.bound, both.lag) == (3e-6, 0.0)


def test_a_dead_band_across_a_way_that_a_table_has_turned_is_a_bound() -> None:
    dial = setup_text("it", "indicator", direction="x", moves=["X"], dead_band="3 um", park={"C": "90 deg"})
    machine = machine_text("w-C'-b-X-Y-t", {"X": (0, 300), "Y": (0, 300), "C": (0, 180)}, {"EXX EYX": "5 um"})
    (across,) = on(machine, dial).setups
    assert (across.bound, across.lag) == (3e-6, 0.0)
