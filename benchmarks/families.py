"""`python -m benchmarks.families`: the table of docs/shapes.md on curves of unknown smoothness, in some minutes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from axiscal.description.campaign import campaign_from_texts
from axiscal.error_model.prior import matern
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.numerics.threads import one_thread
from benchmarks.shapes import PAGE

_MICRO, _MACHINES, _NOISE, _LENGTH = 1e6, 20, 0.3e-6, 0.2
_MACHINE = """chain = "w-b-X-t"
[axes.X]
travel = ["0 mm", "1000 mm"]
[errors]
EXX = {{ std = "10 um", length = "200 mm", smoothness = {0}, rest = "estimate" }}
"""
_CAMPAIGN = """machine = "m"
scales = "estimate"
[target]
readings = 30
[[setups]]
name = "it"
instrument = "interferometer"
direction = "x"
noise = "0.3 um"
drift = "0"
unknowns = {}
"""
STATED = ("2.5", "1.5", '"estimate"')
TRUE = (2.5, 1.5, 0.5)
_DENSE = np.linspace(0.0, 1.0, 401)


class Found(NamedTuple):
    """missed : RMS, m; held : share of the dense places in the 95 % band; smooth : weight of the true smoothness."""

    missed: float
    held: float
    weight: float


def truth(smoothness: float, seed: int) -> Array:
    """Return a curve at the dense places, m, drawn without any spline."""
    far = np.abs(_DENSE[:, None] - _DENSE) / _LENGTH
    root = np.linalg.cholesky(matern(far, smoothness) + 1e-8 * np.eye(len(_DENSE)))
    drawn: Array = 10e-6 * root @ np.random.default_rng(seed).standard_normal(len(_DENSE))
    return drawn


def found(smoothness: float, stated: str, count: int, seed: int) -> Found:
    """Return what so many readings at random places make of a curve."""
    rng, curve = np.random.default_rng((seed, count)), truth(smoothness, seed)
    at = np.sort(rng.choice(len(_DENSE), count, replace=False))
    values = curve[at] + rng.normal(0, _NOISE, count)
    case = Case(campaign_from_texts(_CAMPAIGN, "campaign.toml", _MACHINE.format(stated), "m"))
    places = zip(_DENSE[at].tolist(), values.tolist(), strict=True)
    known = concluded(case, [Reading("it", (x,), (1,), value) for x, value in places])
    poses = _DENSE[:, None]
    banded = known.banded.knowledge
    rows = banded.observation.rows(0, poses, np.ones_like(poses))
    left = curve - rows.rows @ banded.belief.mean
    loose = rows.variances - banded.observation.setups[0].noise ** 2
    std = np.sqrt(np.sum((rows.rows @ banded.belief.factor) ** 2, axis=1) + loose)
    weight = known.fit.families.get(smoothness, 0.0) if known.fit else 0.0
    return Found(float(np.sqrt(np.mean(left**2))), float(np.mean(np.abs(left) <= 1.96 * std)), weight)


def rows() -> Iterator[str]:
    """Yield the table."""
    heads = " | ".join(f"`{each}`: missed, um | held | worst" for each in STATED)
    yield f"| readings | true smoothness | {heads} | its weight |"
    yield "|---" * (3 * len(STATED) + 3) + "|"
    for count in (15, 30):
        for smoothness in TRUE:
            cells = []
            for stated in STATED:
                every = [found(smoothness, stated, count, seed) for seed in range(_MACHINES)]
                size = float(np.sqrt(np.mean([each.missed**2 for each in every]))) * _MICRO
                held = [each.held for each in every]
                cells.append(f"{size:.2f} | {100 * np.mean(held):.1f} % | {100 * min(held):.0f} %")
            weight = np.mean([each.weight for each in every])
            yield f"| {count} | {smoothness} | {' | '.join(cells)} | {weight:.2f} |"


if __name__ == "__main__":
    begin, end = "<!-- table: families -->\n", "<!-- end: families -->"
    with one_thread():
        table = "\n".join(rows())
    print(table)
    before, rest = PAGE.read_text().split(begin)
    PAGE.write_text(before + begin + table + "\n" + end + rest.split(end, 1)[1])
