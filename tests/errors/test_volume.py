"""Means over the working volume against quadrature of H itself."""

from itertools import product

import numpy as np
import pytest

from axiscal.errors.volume import EVERY_WAY, Box, Counted, Volume, VolumeMoments, even_poses, whole_travel
from axiscal_core.machine import Machine
from tests.generators.machines import random_machine


def _brute(model: Machine, box: Box, points: int = 9, counted: Counted = EVERY_WAY) -> VolumeMoments:
    """Tensor Gauss-Legendre between all knots of every axis; both directions of approach of every axis."""
    x, w = np.polynomial.legendre.leggauss(points)
    lines = []
    for k, (start, stop) in enumerate(box):
        knots = np.concatenate([[start, stop], *model.knots_along(k)])
        edges = np.unique(np.clip(knots, start, stop))
        half = np.diff(edges)[:, None] / 2
        lines.append(((edges[:-1, None] + half * (1 + x)).ravel(), (half * w).ravel() / (stop - start)))
    poses = np.stack([g.ravel() for g in np.meshgrid(*(t for t, _ in lines), indexing="ij")], axis=1)
    weights = np.prod(np.stack([g.ravel() for g in np.meshgrid(*(w for _, w in lines), indexing="ij")]), axis=0)
    mean, weight = np.zeros((3, model.size)), np.zeros((model.size, model.size))
    reversing = {f.axis for f in model.curves if f.kind == "reversal"}
    every = [*product(*([1.0, -1.0] if axis in reversing else [1.0] for axis in range(len(box))))]
    sides = len(every)
    for signs in every:
        rows = model.rows_at(poses, np.tile(signs, (len(poses), 1)))
        mean += np.einsum("m,mcn->cn", weights, rows) / sides
        flat = (np.sqrt(weights)[:, None, None] * rows[:, list(counted)]).reshape(-1, model.size)
        weight += flat.T @ flat / sides
    squares = np.sum(model.levers(poses)[:, :, list(counted)] ** 2, axis=2)
    return VolumeMoments(mean, weight, squares @ weights)


@pytest.mark.parametrize("counted", [EVERY_WAY, (False, False, True)])
@pytest.mark.parametrize("seed", range(3))
def test_moments_agree_with_brute_quadrature(seed: int, counted: Counted) -> None:
    model = random_machine(seed, count=1 + seed % 2)
    box = tuple((0.7 * low + 0.3 * high, high) for low, high in whole_travel(model))
    found, expected = Volume(model, even_poses(box, 20_000), counted).moments, _brute(model, box, counted=counted)
    scale = np.sqrt(np.maximum(np.diagonal(expected.gram), 1e-6 * np.diagonal(expected.gram).max()))
    assert np.abs(found.gram - expected.gram).max() < 0.01 * (np.outer(scale, scale)).max()
    assert np.abs((found.gram - expected.gram) / np.outer(scale, scale)).max() < 0.02
    np.testing.assert_allclose(found.squares, expected.squares, rtol=0.01, atol=1e-20)
    np.testing.assert_allclose(found.mean, expected.mean, atol=0.01 * np.abs(expected.mean).max())
