"""Means over the working volume against brute quadrature of H itself and against sampled poses."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from axiscal.errors.volume import EVERY_WAY, Box, Counted, VolumeMoments, volume_moments, whole_travel
from axiscal.machine.axis import iso_axis
from axiscal_core.errors import Error
from axiscal_core.machine import Machine
from tests.generators.machines import every_error, random_machine
from tests.generators.planes import bed, table

_NO_LEVER = 1e-20
"""A mean square lever below that of a tenth of a nanometre per unit is rounding."""


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


def _apart(found: VolumeMoments, expected: VolumeMoments) -> float:
    scale = np.sqrt(np.diagonal(expected.gram))
    scale = np.maximum(scale, 1e-6 * scale.max())
    return float(
        max(
            np.max(np.abs(found.gram - expected.gram) / scale[:, None] / scale),
            np.max(np.abs(found.mean - expected.mean) / scale),
            np.max(np.abs(found.squares - expected.squares) / np.maximum(expected.squares, _NO_LEVER)),
        )
    )


def _small(machine: Machine) -> Machine:
    """Return the machine with few knots, so that a tensor grid is affordable."""
    return replace(machine, errors=tuple(replace(e, knots=4) if e.knots else e for e in machine.stated))


def _rotary(length: float, primed: bool) -> Machine:
    """Return a machine whose rotary axis turns by so much."""
    turn = iso_axis("B", primed, (0.3, 0.3 + length), origin=(0.1, 0.0, -0.2))
    carriage = iso_axis("X", False, (-0.1, 0.4))
    rng = np.random.default_rng(1)
    return Machine((turn, carriage), tuple(every_error(turn, rng) + every_error(carriage, rng)), 0.1, name="m")


_TURN = iso_axis("C", True, (0.0, 2 * np.pi), origin=(0.1, 0.2, 0.0))
_FULL_TURN = Machine((_TURN,), (Error("ECC", 1.0, knots=7), Error("X0C", 1.0)), 0.1, name="m")
_WHOLE = (0.0, 1.0)
CASES = {
    **{f"random {seed}": (random_machine(seed, count=1 + seed % 2), _WHOLE, 9, 1e-11) for seed in range(4)},
    "bed": (bed(), _WHOLE, 5, 1e-8),
    "table": (table(), _WHOLE, 9, 1e-8),
    **{f"three axes {seed}": (_small(random_machine(seed, count=3)), _WHOLE, 5, 1e-6) for seed in (1, 2)},
    **{f"turns by {far}{' primed' * primed}": (_rotary(far, primed), _WHOLE, 9, 1e-11)
       for far in (0.02, 0.99, 1.0, 1.01, 3.0) for primed in (False, True)},
    **{f"from {part}": (random_machine(5, count=2), part, 9, 1e-11)
       for part in ((0.0, 0.5), (0.31, 0.32), (0.25, 0.75), (0.9, 1.0))},
    **{f"a full turn from {part}": (_FULL_TURN, part, 9, 1e-11) for part in ((0.08, 0.32), _WHOLE, (0.8, 1.0))},
}  # fmt: skip
"""By name: the machine, which share of each travel is its box, points of the quadrature, and how near both have to be.

Rotary travels are on both sides of where the number of nodes changes.
"""


_DEAR = {"table", "three axes 2"}
"""Whose grids take seconds, and are of the kinds of others."""


@pytest.mark.parametrize(
    "case", [pytest.param(name, marks=pytest.mark.long if name in _DEAR else ()) for name in CASES]
)
def test_moments_agree_with_brute_quadrature(case: str) -> None:
    machine, (low, high), points, near = CASES[case]
    model = machine
    box = tuple((a + low * (b - a), a + high * (b - a)) for a, b in whole_travel(model))
    assert _apart(volume_moments(model, box), _brute(model, box, points)) < near


@pytest.mark.parametrize("counted", [(False, False, True), (True, False, True)])
def test_directions_that_do_not_count_are_left_out(counted: Counted) -> None:
    model = random_machine(3, count=2)
    box = whole_travel(model)
    found, every = volume_moments(model, box, counted), volume_moments(model, box)
    expected = _brute(model, box, counted=counted)
    np.testing.assert_allclose(found.gram, expected.gram, rtol=0, atol=1e-12 * np.abs(every.gram).max())
    np.testing.assert_allclose(found.squares, expected.squares, rtol=1e-10)
    np.testing.assert_array_equal(found.mean, every.mean)
    assert np.trace(found.gram) < np.trace(every.gram)
