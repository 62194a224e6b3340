"""A bed read with errors of two axes: the belief against plain conditioning on all control values, cells and zero."""

from __future__ import annotations

import numpy as np

from axiscal.errors.model import ErrorModel
from axiscal.estimation.knowledge import Knowledge
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from tests.generators.planes import bed, centred, dense_rows, matern, natural, poses_of, probe

NOISE = 1e-6
X, Y = natural(0.0, 0.3, 6), natural(-0.05, 0.15, 5)
CURVE_X, CURVE_Y = natural(0.0, 0.3, 7), natural(-0.05, 0.15, 5)


def _cells(poses: Array) -> tuple[Array, Array]:
    """Return the cell of each pose along X for its curve, and in the plane, counted a second time."""
    x, y = poses[:, 2], poses[:, 0]
    of_curve = np.minimum(np.floor(x / 0.3 * 48), 47)
    of_plane = 100 * np.minimum(np.floor(x / 0.3 * 40), 39) + np.minimum(np.floor((y + 0.05) / 0.2 * 32), 31)
    return of_curve, of_plane


def _covariance(one: Array, other: Array) -> Array:
    """Return the prior covariance of the height of the tool between poses: X and Y and what they do together."""
    plane = 40e-6**2 * np.kron(centred(matern(X.knots, 0.07)), centred(matern(Y.knots, 0.04)))
    parts = 60e-6**2 * CURVE_X.rows(one[:, 2]) @ matern(CURVE_X.knots, 0.1) @ CURVE_X.rows(other[:, 2]).T
    parts += 50e-6**2 * CURVE_Y.rows(one[:, 0]) @ matern(CURVE_Y.knots, 0.1) @ CURVE_Y.rows(other[:, 0]).T
    parts += dense_rows(X, Y, one[:, 2], one[:, 0]) @ plane @ dense_rows(X, Y, other[:, 2], other[:, 0]).T
    return parts


def _rests(one: Array, other: Array) -> Array:
    (curve, plane), (curves, planes) = _cells(one), _cells(other)
    shared: Array = 3e-6**2 * (curve[:, None] == curves) + 2e-6**2 * (plane[:, None] == planes)
    return shared


def test_a_bed_is_estimated_as_by_plain_conditioning() -> None:
    machine = bed()
    setup = probe(machine, noise=NOISE)
    poses = poses_of(machine, 30, 3)
    poses[5] = poses[4]  # the same cells twice: the rest does not average away
    values = np.random.default_rng(4).normal(0, 5e-5, 30)
    readings = [
        Reading("probe", tuple(pose), (1, 1, 1), float(value)) for pose, value in zip(poses, values, strict=True)
    ]
    known = Knowledge.before(Observation(ErrorModel(machine), (setup,))).read(readings)
    wanted = poses_of(machine, 12, 9)
    own = known.observation.rows(0, wanted, np.ones_like(wanted)).rows
    own[:, known.observation.errors.size :] = 0.0  # the height itself: no zero, no rest
    found = known.belief.predict(own)
    noisy = _covariance(poses, poses) + _rests(poses, poses) + 1e-3**2 + NOISE**2 * np.eye(30)
    across = _covariance(wanted, poses)
    mean = across @ np.linalg.solve(noisy, values)
    left = _covariance(wanted, wanted) - across @ np.linalg.solve(noisy, across.T)
    np.testing.assert_allclose(found.mean, mean, atol=1e-9 * np.abs(mean).max() + 1e-13)
    np.testing.assert_allclose(found.std, np.sqrt(np.diagonal(left)), rtol=1e-7)
