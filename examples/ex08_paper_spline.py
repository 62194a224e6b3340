"""The paper's single spline.

Seven control points on 0 to 10, readings of variance 0.01, each taken where J, the variance along the whole spline,
falls most (B&H eq. 26, 27). Drawn is a spline after seven.
"""

import numpy as np
from numpy.typing import NDArray

import axiscal as ac

MM = 1e-3  # what the paper calls 1
BEFORE = ac.Curve(["0 mm", "10 mm"], std="1 mm")


def chosen(count: int) -> tuple[list[float], list[float]]:
    """Return where so many readings are taken, and J before and after each; no value changes either."""
    curve, at, J = BEFORE, list[float](), [10 * (BEFORE.rms / MM) ** 2]
    for _ in range(count):
        at.append(curve.next(noise="0.1 mm"))
        curve = curve.read(at[-1], 0.0, noise="0.1 mm")
        J.append(10 * (curve.rms / MM) ** 2)
    return at, J


def read(truth: NDArray[np.float64], at: list[float], rng: np.random.Generator) -> ac.Normal:
    """Return what readings make known of a spline.  truth : (7,) control values, m"""
    rows = BEFORE.spline.rows(np.array(at))
    noise = np.full(len(at), 0.1 * MM)
    return BEFORE.known.read(rows, rows @ truth + noise * rng.standard_normal(len(at)), noise**2)


def main() -> dict[str, object]:
    """Return J, and the mean squared error of 500 splines after seven readings."""
    (at, J), t, rng = chosen(10), np.linspace(0, 10 * MM, 201), np.random.default_rng(2)
    truths, rows = rng.standard_normal((500, 7)) @ BEFORE.known.factor.T, BEFORE.spline.rows(t)
    missed = np.array([read(truth, at[:7], rng).mean - truth for truth in truths])
    squared = np.sum((missed @ BEFORE.spline.gram()) * missed, axis=1) / MM**3
    known, values = read(truths[0], at[:7], rng).through(rows), BEFORE.spline.rows(np.array(at[:7])) @ truths[0]
    mean, std, axis = known.mean / MM, known.std / MM, t / MM
    lines = {"estimate": (axis, mean), "truth": (axis, rows @ truths[0] / MM)}
    points = {"where it was read": (np.array(at[:7]) / MM, values / MM)}
    picture = {"x": "t", "y": "S(t)", "lines": lines, "band": (axis, mean - std, mean + std), "points": points}
    found = {"J before": J[0], "J after 7": J[7], "J after 10": J[10], "squared error after 7": float(squared.mean())}
    return {**found, "picture": picture}


if __name__ == "__main__":
    print({name: value for name, value in main().items() if name != "picture"})
