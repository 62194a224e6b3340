"""One spline.

The straightness error of a slide: seven control points, and a natural cubic spline through them. All of it is
linear in the control values.
"""

import numpy as np

import axiscal as ac


def main() -> dict[str, object]:
    """Return what the spline says, and its picture."""
    spline = ac.NaturalSpline(np.linspace(0, 0.6, 7))  # knots, m
    control = 1e-6 * np.array([0.0, 2.0, 3.5, 1.0, -2.0, -1.0, 0.5])  # values at the knots, m
    t = np.linspace(0, 0.6, 241)
    value = spline.rows(t) @ control
    return {
        "value at 250 mm, um": float(spline.rows(0.25)[0] @ control) * 1e6,
        "slope at 250 mm, urad": float(spline.rows(0.25, derivative=1)[0] @ control) * 1e6,
        "RMS over the travel, um": float(np.sqrt(control @ spline.gram() @ control / 0.6)) * 1e6,
        "picture": {
            "x": "position, mm",
            "y": "straightness, µm",
            "lines": {
                "spline": (t * 1e3, value * 1e6),
                "third control value alone": (t * 1e3, 3.5 * spline.rows(t)[:, 2]),
            },
            "points": {"control points": (spline.knots * 1e3, control * 1e6)},
        },
    }


if __name__ == "__main__":
    print({name: value for name, value in main().items() if name != "picture"})
