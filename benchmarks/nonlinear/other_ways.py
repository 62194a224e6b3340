"""The ways that damped steps are compared with: an unscented update, and Gauss-Newton without damping."""

from __future__ import annotations

import numpy as np

from axiscal.estimation.belief import Belief
from axiscal.estimation.stations import BentReadings
from axiscal.measurement.reading_rows import shown_by_each

_ROUNDS = 3


def sigma_points(problem: BentReadings) -> Belief:
    """Return the belief after one update with all readings by sigma points under the prior, ±√n F₀ eᵢ of equal weight.

    Those of the unscented transform with κ = 0 (the cubature rule): mean and covariance of what is shown, and what it
    has in common with the unknowns, are moments over these points (Julier and Uhlmann 1997; Arasaratnam 2009).
    """
    count = problem.root.shape[1]
    aside = np.sqrt(count) * np.hstack([np.eye(count), -np.eye(count)])
    observation, readings = problem.case.observation, problem.readings
    shown = shown_by_each(observation, readings, (problem.start[:, None] + problem.root @ aside).T)
    mean = shown.mean(axis=0)
    spread, common = (shown - mean) / np.sqrt(2 * count), aside.T / np.sqrt(2 * count)
    innovation = spread.T @ spread + np.diag(problem.variances)
    gain = np.linalg.solve(innovation, spread.T @ common).T
    z = gain @ (problem.values - mean)
    return _believed(problem, z, np.eye(count) - gain @ spread.T @ common)


def gauss_newton(problem: BentReadings) -> Belief:
    """Return the belief after three rounds from the prior mean, each a whole step."""
    z = np.zeros(problem.root.shape[1])
    normal = np.eye(len(z))
    for _ in range(_ROUNDS):
        point = problem.start + problem.root @ z
        slopes = (problem.linearised(point).rows @ problem.root) / np.sqrt(problem.variances)[:, None]
        normal = np.eye(len(z)) + slopes.T @ slopes
        z = z + np.linalg.solve(normal, slopes.T @ problem.left(point) - z)
    return _believed(problem, z, np.linalg.inv(normal))


def _believed(problem: BentReadings, z: np.ndarray, covariance: np.ndarray) -> Belief:
    whole = problem.root @ covariance @ problem.root.T
    return Belief(problem.start + problem.root @ z, (whole + whole.T) / 2)
