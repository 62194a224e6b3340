"""A display that moves in steps: what it rounds off counts, and a simulated one rounds."""

from __future__ import annotations

import math

import numpy as np
import pytest

from axiscal.exceptions import InputError
from axiscal.measurement.simulation import Simulator
from tests.generators.one_axis import observed


def test_what_a_display_rounds_off_counts_at_once() -> None:
    (setup,) = observed('noise = "1 um"\nresolution = "5 um"').setups
    assert setup.noise == pytest.approx(math.sqrt(1e-12 + 25e-12 / 12))
    assert setup.scatter == pytest.approx(1e-6)
    (bare,) = observed('noise = "1 um"').setups
    assert (bare.noise, bare.scatter, bare.resolution) == (1e-6, 1e-6, 0.0)


def test_a_simulated_display_shows_whole_steps() -> None:
    observation = observed('resolution = "5 um"\nunknowns = {}')
    machine, rng = Simulator(observation.machine, observation.setups).drawn(1), np.random.default_rng(0)
    shown = np.array([machine.read(observation.setups[0], (x,), (1,), rng) for x in np.linspace(0, 1, 20)])
    assert np.ptp(shown) > 5e-6
    assert np.round(shown / 5e-6) * 5e-6 == pytest.approx(shown, abs=1e-15)


@pytest.mark.parametrize("text", ["0 um", "-1 um", "1 s", "fine"])
def test_a_step_that_is_none_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="um"):
        observed(f'resolution = "{text}"')
