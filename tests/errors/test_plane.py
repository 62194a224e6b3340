"""Errors of two axes against a plain twin with all control values, and against brute quadrature."""

import numpy as np
import pytest

from axiscal.machine import machine_from_text
from axiscal.machine.kinematics import small_motions, tool_motion
from axiscal_core.criterion import joint
from axiscal_core.machine import Machine
from axiscal_core.rigid import SmallMotions
from axiscal_core.terms import Term
from tests.generators.planes import bed, centred, dense_rows, matern, natural, poses_of, table


def _plane(machine: Machine, name: str) -> Term:
    return {term.name: term for term in machine.terms}[name]


def test_the_unknowns_have_the_covariance_of_the_centred_kronecker_product() -> None:
    plane = _plane(bed(), "EZXY")
    x, y = natural(0.0, 0.3, 6), natural(-0.05, 0.15, 5)
    dense = 40e-6**2 * np.kron(centred(matern(x.knots, 0.07)), centred(matern(y.knots, 0.04)))
    poses = poses_of(bed(), 40)
    rows = dense_rows(x, y, poses[:, 2], poses[:, 0])
    found = plane.rows(*plane.at(poses))
    assert len(plane.covariance) == 20, "so rough a plane needs all its products"
    np.testing.assert_allclose(found @ plane.covariance @ found.T, rows @ dense @ rows.T, rtol=0, atol=1e-12 * 40e-6**2)
    assert plane.rest == pytest.approx(2e-6, rel=1e-6)


def test_what_is_cut_away_is_counted_as_rest() -> None:
    text = 'chain = "w-b-X-Y-t"\n' + "".join(f'[axes.{a}]\ntravel = ["0 mm", "200 mm"]\n' for a in "XY")
    errors = '[errors]\nEZXY = { std = "10 um", knots = 15, length = "150 mm" }\n'
    plane = _plane(machine_from_text(text + errors), "EZXY")
    spline = natural(0.0, 0.2, 15)
    own = centred(matern(spline.knots, 0.15))
    grid = np.stack([g.ravel() for g in np.meshgrid(spline.knots, spline.knots, indexing="ij")], axis=1)
    rows = plane.rows(*grid.T)
    lost = np.trace(np.kron(own, own)) * 10e-6**2 - np.trace(rows @ plane.covariance @ rows.T)
    assert len(plane.covariance) < 14 * 14
    assert plane.rest**2 == pytest.approx(lost / 15**2, rel=1e-6, abs=0.0)
    assert plane.rest**2 < 1e-4 * 10e-6**2


@pytest.mark.parametrize("machine", [bed(), table()], ids=["bed", "table"])
def test_the_small_motions_are_those_of_the_rows(machine: Machine) -> None:
    """The chain itself, with the plane as a displacement or turn of one frame, against the row times its values."""
    model = machine
    rng, poses = np.random.default_rng(1), poses_of(machine, 30)
    values = 1e-4 * rng.standard_normal(model.size)
    small = small_motions(model, values, poses, np.ones_like(poses))
    still = SmallMotions(*(np.zeros_like(part) for part in small))
    moved = tool_motion(machine, poses, small).translation - tool_motion(machine, poses, still).translation
    expected = model.rows_at(poses, np.ones_like(poses)) @ values
    np.testing.assert_allclose(moved, expected, atol=3e-3 * np.abs(expected).max())


def test_the_paper_s_criterion_is_the_kronecker_product_of_the_gram_matrices() -> None:
    model = bed()
    (plane,) = (plane for plane in model.planes if plane.name == "EZXY")
    x, y = natural(0.0, 0.3, 6), natural(-0.05, 0.15, 5)
    nodes, weights = np.polynomial.legendre.leggauss(4)
    at, share = [], []
    for spline in (x, y):
        half = np.diff(spline.knots)[:, None] / 2
        at.append((spline.knots[:-1, None] + half * (1 + nodes)).ravel())
        share.append((half * weights).ravel())
    grid = np.stack([g.ravel() for g in np.meshgrid(*at, indexing="ij")], axis=1)
    rows = plane.rows(*grid.T)
    integral = rows.T @ (rows * np.outer(*share).ravel()[:, None])
    root = joint(model, model.size).root[:, plane.columns]
    np.testing.assert_allclose(root.T @ root, integral, rtol=0, atol=1e-12 * np.abs(integral).max())


def test_other_lengths_give_the_covariance_of_other_lengths() -> None:
    """A machine stated with these lengths, seen through the basis of the first one."""
    plane, poses = _plane(bed(), "EZXY"), poses_of(bed(), 25)
    x, y = natural(0.0, 0.3, 6), natural(-0.05, 0.15, 5)
    shorter = 30e-6**2 * np.kron(centred(matern(x.knots, 0.07 * 0.8)), centred(matern(y.knots, 0.04 * 0.6)))
    rows, dense = plane.rows(*plane.at(poses)), dense_rows(x, y, poses[:, 2], poses[:, 0])
    found = rows @ plane.prior(30e-6, (0.8, 0.6)) @ rows.T
    np.testing.assert_allclose(found, dense @ shorter @ dense.T, rtol=0, atol=1e-12 * 30e-6**2)
    up, down = np.exp(1e-5), np.exp(-1e-5)
    for index, (more, less) in enumerate((((0.8 * up, 0.6), (0.8 * down, 0.6)), ((0.8, 0.6 * up), (0.8, 0.6 * down)))):
        slope = (plane.prior(30e-6, more) - plane.prior(30e-6, less)) / 2e-5
        found = plane.prior(30e-6, (0.8, 0.6), index)
        np.testing.assert_allclose(found, slope, atol=1e-8 * np.abs(slope).max())
