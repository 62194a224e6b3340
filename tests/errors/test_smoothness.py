"""`smoothness = 1.5`: the slopes of the likelihood against differences."""

import numpy as np
import pytest

from axiscal.estimation.promise.problem import problem
from axiscal.machine import machine_from_text
from axiscal.measurement.instruments.displacement import Probe
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal_core.machine import Machine
from axiscal_core.spaces import Given
from axiscal_core.unknowns import space_of
from axiscal_core.usual import sizes_of
from tests.generators.texts import machine_text

_HEAD = machine_text("w-X'-Y'-b-Z-t", {"X": (0, 500), "Y": (0, 400), "Z": (0, 300)}, {}, name="two axes")


def _machine(entries: str) -> Machine:
    return machine_from_text(_HEAD + entries, "m.toml")


def test_the_likelihood_of_rough_curves_and_planes_has_the_slope_that_it_says() -> None:
    """Against differences of the likelihood in the logarithm of every scale."""
    machine = _machine(
        'EZX = { std = "10 um", length = "150 mm", smoothness = 1.5 }\n'
        'EZXY = { std = "8 um", knots = [5, 5], length = ["150 mm", "150 mm"], smoothness = 1.5, rest = "1 um" }\n'
    )
    model, rng = machine, np.random.default_rng(1)
    setup = Probe("p", machine, (0.0, 0.0, 1.0), (0, 1), (0.0,) * 3, 1e-6, (), 0.0, 0.0, 1.0, (0.0,) * 3, "+")
    poses = np.column_stack([rng.uniform(0, 0.5, 25), rng.uniform(0, 0.4, 25), np.zeros(25)])
    readings = [Reading("p", tuple(pose), (1, 1, 0), float(1e-5 * rng.standard_normal())) for pose in poses.tolist()]
    sizes = sizes_of(machine, [setup.name], "roughly", usual=True)
    assert {"std", "length", "together", "rest"} < {size.kind for size in sizes.of}
    assert sizes.index("length", "EZXY") != sizes.index("length", "EZX")
    space = space_of(problem(Observation(model, (setup,)), readings, sizes))

    def log_likelihood(theta: Array) -> Given:
        found = space.given(theta)
        assert found is not None
        return found

    at = 0.3 * rng.standard_normal(len(sizes))
    slope = log_likelihood(at).slope().gradient
    for i in range(len(at)):
        step = 1e-4 * np.eye(len(at))[i]
        difference = (log_likelihood(at + step).value - log_likelihood(at - step).value) / 2e-4
        assert slope[i] == pytest.approx(difference, rel=1e-4, abs=1e-4)
