"""The marginal likelihood with errors of two axes, against a dense twin, and its gradient against differences."""

from __future__ import annotations

import numpy as np
import pytest
from axiscal.inference.evidence import Evidence
from axiscal.inference.fit import fit
from axiscal.inference.scales import Scales, all_scales
from scipy.stats import multivariate_normal

from axiscal.error_model.model import ErrorModel
from axiscal.machine import Machine, machine_from_text
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from tests.generators.planes import bed, centred, dense_rows, matern, natural, poses_of, probe

FLAT = """
chain = "w-b-X-Y-t"
[axes.X]
travel = ["0 mm", "300 mm"]
[axes.Y]
travel = ["0 mm", "200 mm"]
[errors]
EZXY = { std = "40 um", knots = [6, 5], length = ["70 mm", "40 mm"], rest = "2 um" }
"""


def _read(
    machine: Machine, count: int = 25, noise: float = 1e-5, zero: float = 1e-4
) -> tuple[Observation, list[Reading]]:
    setup = probe(machine, noise=noise, zero=zero)
    rng = np.random.default_rng(2)
    poses = poses_of(machine, count, 5)
    poses[1] = poses[0]
    approach = (1,) * len(machine.axes)
    readings = [Reading("probe", tuple(pose), approach, float(rng.normal(0, 4e-5))) for pose in poses]
    return Observation(ErrorModel(machine), (setup,)), readings


def test_density_and_gradient_are_those_of_a_dense_normal_distribution() -> None:
    """All control values, Kronecker products written out; the gradient as ½ tr((ααᵀ − K⁻¹) ∂K)."""
    observation, readings = _read(machine_from_text(FLAT), noise=1e-5, zero=1e-4)
    poses, values = np.array([r.pose for r in readings]), np.array([r.value for r in readings])
    x, y = natural(0.0, 0.3, 6), natural(0.0, 0.2, 5)
    rows, count = dense_rows(x, y, poses[:, 0], poses[:, 1]), len(poses)
    cell = np.floor(poses / [0.3 / 40, 0.2 / 32])
    same = np.all(cell[:, None] == cell[None], axis=2)

    def parts(size: float, one: float, other: float, rest: float, noise: float) -> dict[str, Array]:
        plane = np.kron(centred(matern(x.knots, 0.07 * one)), centred(matern(y.knots, 0.04 * other)))
        own = (40e-6 * size) ** 2 * rows @ plane @ rows.T
        return {"std": own, "rest": (2e-6 * rest) ** 2 * same, "noise": (1e-5 * noise) ** 2 * np.eye(count)}

    scales = all_scales(observation.machine, observation.setups)
    assert [scale.owner for scale in scales if scale.kind == "length"] == ["EZXY along X", "EZXY along Y"]
    order = [scale.owner if scale.kind == "length" else scale.kind for scale in scales]
    for factors in ((1.0, 1.0, 1.0, 1.0, 1.0), (1.5, 0.7, 1.2, 2.0, 1.3)):
        named = dict(zip(("std", "EZXY along X", "EZXY along Y", "rest", "noise"), factors, strict=True))
        logs = np.log([named[name] for name in order])
        found = Evidence(observation, readings, scales).log_density(logs)
        slopes = {kind: 2 * part for kind, part in parts(*factors).items()}
        for index, name in ((1, "EZXY along X"), (2, "EZXY along Y")):
            step = 1e-4 * np.eye(len(factors))[index]
            wide, narrow = (parts(*(factors * np.exp(sign * step)))["std"] for sign in (1, -1))
            slopes[name] = (wide - narrow) / 2e-4
        whole = np.sum(list(parts(*factors).values()), axis=0) + 1e-4**2
        inverse = np.linalg.inv(whole)
        pull = np.outer(inverse @ values, inverse @ values) - inverse
        assert found[0] == pytest.approx(multivariate_normal(np.zeros(count), whole).logpdf(values), rel=1e-11)
        for name, slope in zip(order, found[1], strict=True):
            twin = 0.5 * float(np.sum(pull * slopes[name]))
            assert slope == pytest.approx(twin, rel=1e-6 if "along" in name else 1e-10, abs=1e-10)


def test_the_gradient_is_that_of_differences() -> None:
    observation, readings = _read(bed())
    scales = all_scales(observation.machine, observation.setups)
    assert [s.kind for s in scales if s.owner.startswith("EZXY")] == ["std", "length", "length", "rest"]
    evidence = Evidence(observation, readings, scales)
    logs = np.random.default_rng(3).normal(0, 0.2, len(scales))
    _, slope = evidence.log_density(logs)
    for index, found in enumerate(slope):
        step = 1e-5 * np.eye(len(scales))[index]
        twin = (evidence.log_density(logs + step)[0] - evidence.log_density(logs - step)[0]) / 2e-5
        assert found == pytest.approx(twin, rel=1e-5, abs=1e-5)


def test_what_was_learnt_is_the_prior_of_the_machine_that_it_makes() -> None:
    observation, readings = _read(bed())
    scales = all_scales(observation.machine, observation.setups)
    factors = np.exp(np.random.default_rng(4).normal(0, 0.3, len(scales)))
    learnt = ErrorModel(Scales(scales, tuple(factors)).machine(observation.machine))
    logs = Evidence(observation, readings, scales).prior(np.log(factors))
    assert learnt.size == observation.errors.size, "a plane's unknowns stay those of the stated lengths"
    np.testing.assert_allclose(learnt.prior_covariance(), logs[: learnt.size, : learnt.size], rtol=1e-9, atol=1e-30)


def test_a_plane_four_times_as_large_as_stated_is_learnt() -> None:
    machine = machine_from_text(FLAT)
    model, poses = ErrorModel(machine), poses_of(machine, 80, 6)
    rng = np.random.default_rng(0)
    truth = 4 * np.linalg.cholesky(model.prior_covariance()) @ rng.standard_normal(model.size)
    values = model.rows(poses, np.ones_like(poses))[:, 2] @ truth + rng.normal(0, 1e-6, 80)
    readings = [Reading("probe", tuple(pose), (1, 1), float(v)) for pose, v in zip(poses, values, strict=True)]
    observation = Observation(model, (probe(machine),))
    found = fit(observation, readings, all_scales(machine, observation.setups)).scales.value("std", "EZXY")
    assert found is not None
    assert 2.0 < found / 40e-6 < 6.5
