"""A cyclic spline with tilt and precession.

A table turns while a dial reads its face at some radius. A tilt of the face shows once a turn, a precession twice.
With a file of your own (columns: angle in degrees, reading in um): `python examples/ex02_rotary_joint.py readings.csv`.
"""

import sys

import numpy as np
from numpy.typing import NDArray

import axiscal as ac


def simulated() -> NDArray[np.float64]:
    """Return ten turns of a table: tilt 5 um, precession 0.8 um, noise 0.25 um; columns angle (deg), reading (um)."""
    angle = np.arange(0, 3600, 3.6)
    turn = np.radians(angle)
    noise = 0.25 * np.random.default_rng(1).standard_normal(len(angle))
    return np.column_stack([angle, 5 * np.sin(turn + 0.6) + 0.8 * np.sin(2 * turn) + noise])


def main(table: NDArray[np.float64] | None = None) -> dict[str, object]:
    """Return how well half of the readings foretell the others.  table : (m, 2), deg and um."""
    angle, reading = (simulated() if table is None else table).T
    turn, half = np.radians(angle) % (2 * np.pi), len(angle) // 2
    spline = ac.CyclicSpline(np.linspace(0, 2 * np.pi, 9))  # eight control points: tilt, precession, and more
    prior = ac.Normal(np.full(8, reading[:half].mean()), 10.0**2 * np.eye(8) + 100.0**2)
    known = prior.read(spline.rows(turn[:half]), reading[:half], np.full(half, 0.25**2))
    left = reading[half:] - known.through(spline.rows(turn[half:])).mean
    t = np.linspace(0, 2 * np.pi, 241)
    waves = np.fft.rfft(spline.rows(t[:-1]) @ known.mean) / 120
    return {
        "tilt, um": float(abs(waves[1])),
        "precession, um": float(abs(waves[2])),
        "RMS of what the other half differs, um": float(np.sqrt(np.mean(left**2))),
        "picture": {
            "x": "angle, °",
            "y": "reading, µm",
            "lines": {"estimate": (np.degrees(t), spline.rows(t) @ known.mean)},
            "points": {"readings not used": (np.degrees(turn[half::4]), reading[half::4])},
        },
    }


if __name__ == "__main__":
    own = np.loadtxt(sys.argv[1], delimiter=",", comments="#") if len(sys.argv) > 1 else None
    print({name: value for name, value in main(own).items() if name != "picture"})
