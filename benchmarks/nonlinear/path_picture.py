"""The way through the shares as a picture: how far a station is off, and its standard deviation, against γ."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

_WIDTH, _HEIGHT, _LEFT, _BOTTOM, _TOP = 640, 300, 70, 50, 20


def path_picture(path: Sequence[tuple[float, float, float]]) -> str:
    """Return an SVG.  path : γ, error and standard deviation of a station after each share, m"""
    gammas = np.log10([max(gamma, 1e-13) for gamma, _, _ in path])
    low, high = np.floor(gammas.min()), 0.0
    sizes = np.log10(np.array([[off, std] for _, off, std in path]) * 1e6)
    top, bottom = np.ceil(sizes.max()), np.floor(sizes.min())

    def at(gamma: float, size: float) -> str:
        x = _LEFT + (gamma - low) / (high - low) * (_WIDTH - _LEFT - 20)
        return f"{x:.1f},{_TOP + (top - size) / (top - bottom) * (_HEIGHT - _TOP - _BOTTOM):.1f}"

    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {_HEIGHT}" font-family="sans-serif" '
        'font-size="12"><rect width="100%" height="100%" fill="white"/>'
    ]
    for power in range(int(bottom), int(top) + 1):
        start, stop = at(low, power), at(high, power)
        (x1, y), (x2, _) = start.split(","), stop.split(",")
        parts.append(f'<line x1="{x1}" y1="{y}" x2="{x2}" y2="{y}" stroke="#ddd"/>')
        parts.append(f'<text x="{_LEFT - 8}" y="{y}" dy="4" text-anchor="end">{_size(power)}</text>')
    for power in range(int(low), 1, 2):
        x = at(power, bottom).split(",")[0]
        parts.append(
            f'<text x="{x}" y="{_HEIGHT - 30}" text-anchor="middle">{"prior" if power == low else f"1e{power}"}</text>'
        )
    for column, color, words in ((0, "#b23", "off by"), (1, "#236", "standard deviation")):
        points = [at(gamma, size) for gamma, size in zip(gammas, sizes[:, column], strict=True)]
        parts.append(f'<polyline points="{" ".join(points)}" fill="none" stroke="{color}" stroke-width="2"/>')
        parts += [f'<circle cx="{p.split(",")[0]}" cy="{p.split(",")[1]}" r="3" fill="{color}"/>' for p in points]
        parts.append(f'<text x="{_WIDTH - 160}" y="{_TOP + 20 + 18 * column}" fill="{color}">{words}</text>')
    parts.append(
        f'<text x="{_WIDTH / 2}" y="{_HEIGHT - 10}" text-anchor="middle">exponent γ of the likelihood</text></svg>'
    )
    return "\n".join(parts) + "\n"


def _size(power: int) -> str:
    """Return a power of ten of micrometres as people say it."""
    if power < 3:
        return f"{10.0**power:g} um"
    return f"{10.0 ** (power - 3):g} mm" if power < 6 else f"{10.0 ** (power - 6):g} m"
