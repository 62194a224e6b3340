"""How many control points?

A guide bends with a wavelength of 80 mm, 5 um up and down. The paper's rule gives the widest spacing at which a spline
can bend that much inside the band (B&H eq. 15). It is a limit, not a recommendation: a quarter of the wave is safe.
"""

import numpy as np

import axiscal as ac
from axiscal_core.splines import spacing_limit


def main() -> dict[str, object]:
    """Return both spacings, and how far a spline through exact points stays from the guide at each."""
    amplitude, wavelength, travel = 5e-6, 0.08, 0.4
    widest = spacing_limit(width=2 * amplitude, curvature=amplitude * (2 * np.pi / wavelength) ** 2)
    safe = wavelength / 4
    t = np.linspace(0, travel, 401)
    found: dict[str, float] = {"widest, mm": widest * 1e3, "safer, mm": safe * 1e3}
    lines = {"guide": (t * 1e3, guide(t, amplitude, wavelength) * 1e6)}
    for name, spacing in (("widest", widest), ("safer", safe)):
        spline = ac.NaturalSpline(np.linspace(0, travel, 1 + round(travel / spacing)))
        curve = spline.rows(t) @ guide(spline.knots, amplitude, wavelength)
        found[f"worst error at the {name} spacing, um"] = (
            float(np.abs(curve - guide(t, amplitude, wavelength)).max()) * 1e6
        )
        lines[f"{name} spacing"] = (t * 1e3, curve * 1e6)
    return {**found, "picture": {"x": "position, mm", "y": "straightness, µm", "lines": lines}}


def guide(t: np.ndarray, amplitude: float, wavelength: float) -> np.ndarray:
    """Return the shape of the guide, m."""
    return amplitude * np.sin(2 * np.pi * t / wavelength + 0.4)


if __name__ == "__main__":
    print({name: value for name, value in main().items() if name != "picture"})
