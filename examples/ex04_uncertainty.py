"""Uncertainty, before and after.

What is believed of the control values is a normal distribution, which says by how much each reading surprises, and
which it sharpens. The last reading here is 20 um off.
"""

import numpy as np

import axiscal as ac
from axiscal_core.splines import matern


def main() -> dict[str, object]:
    """Return the band between readings, and what a bad reading looks like."""
    spline = ac.NaturalSpline(np.linspace(0, 0.6, 13))
    distance = np.abs(spline.knots[:, None] - spline.knots) / 0.15  # in correlation lengths
    prior = ac.Normal(np.zeros(13), 8e-6**2 * matern(distance))
    where, read = np.array([0.05, 0.2, 0.35, 0.55]), 1e-6 * np.array([3.0, 9.0, 4.0, -6.0])
    rows, noise = spline.rows(where), 0.5e-6
    known, spread = (
        prior.read(rows, read, np.full(4, noise**2)),
        rows @ prior.covariance @ rows.T + noise**2 * np.eye(4),
    )
    expected = known.through(spline.rows(0.3))
    t = np.linspace(0, 0.6, 241)
    found = known.through(spline.rows(t))
    mean, std = found.mean, found.std
    return {
        "before, um": float(prior.through(spline.rows(0.45)).std[0]) * 1e6,
        "after, at a reading, um": float(known.through(spline.rows(0.35)).std[0]) * 1e6,
        "after, between readings, um": float(known.through(spline.rows(0.45)).std[0]) * 1e6,
        "surprise of the four, chi-square": float(read @ np.linalg.solve(spread, read)),
        "surprise of a bad one, standard deviations": float(
            (26e-6 - expected.mean[0]) / np.hypot(expected.std[0], noise)
        ),
        "picture": {
            "x": "position, mm",
            "y": "error, µm",
            "band": (t * 1e3, (mean - 1.96 * std) * 1e6, (mean + 1.96 * std) * 1e6),
            "lines": {"estimate, 95 %": (t * 1e3, mean * 1e6)},
            "points": {"readings": (where * 1e3, read * 1e6)},
        },
    }


if __name__ == "__main__":
    print({name: value for name, value in main().items() if name != "picture"})
