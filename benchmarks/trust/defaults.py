"""Default sizes of what usually goes wrong, chosen with one machine left out, and what they are worth on that machine.

A machine's score is the mean logarithm of the density that the estimate gives to the truth, from readings at even
places. Curves of one machine count once.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple
from unittest.mock import patch

import numpy as np

from axiscal.description import usual
from axiscal.description.campaign import campaign_from_texts
from axiscal.description.usual import REST, ROUGH, TOGETHER, Cause
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.numerics import Array
from benchmarks.trust.beds import beds
from benchmarks.trust.curves import CASES, Measured, bed_map
from benchmarks.trust.measured import BAND, at_even_places, predicted

FACTORS = (1 / 3, 1.0, 3.0)
"""Of the default."""
_DEFAULTS = {"ROUGH": ROUGH, "REST": REST, "TOGETHER": TOGETHER}
_READINGS = 25


class Score(NamedTuple):
    """density : mean log density of the truth, per m or rad; share : of the truth in the 95 % band"""

    density: float
    share: float


def cases() -> list[Measured]:
    """Return the measured curves, and every owner's bed."""
    printers = [
        bed_map(f"{bed.kind} {number}", bed.places, bed.heights, _READINGS) for number, bed in enumerate(beds())
    ]
    return [*(make() for make in CASES), *printers]


def scored(case: Measured, name: str, cause: Cause) -> Score:
    """Return how well a case is foretold with another row of the model.  name : of the row"""
    with patch.object(usual, name, cause):
        problem = Case(campaign_from_texts(case.campaign, "campaign.toml", case.machine, "measured"))
        known = concluded(problem, at_even_places(case, problem))
        mean, std = predicted(known, case.places, np.zeros_like(case.places))
    missed = (case.truth - mean) / std
    density = -0.5 * missed**2 - np.log(std)
    return Score(float(density.mean()), float(np.mean(np.abs(missed) <= BAND)))


def choices(scores: Array) -> Array:
    """Return the best default without each machine, an index of FACTORS.  scores : (machines, factors)"""
    others = scores.sum(axis=0) - scores
    best: Array = np.argmax(others, axis=1)
    return best


def default_rows() -> Iterator[str]:
    """Yield a line for each row of the model."""
    every = cases()
    owners = list(dict.fromkeys(case.owner for case in every))
    for name, cause in _DEFAULTS.items():
        rows = [replace(cause, size=factor * cause.size) for factor in FACTORS]
        found = [[scored(case, name, row) for row in rows] for case in every]
        of_machines = [[found[k] for k, case in enumerate(every) if case.owner == owner] for owner in owners]
        yield _line(cause, of_machines)


def _line(cause: Cause, found: Sequence[Sequence[Sequence[Score]]]) -> str:
    densities = np.array([np.mean([[each.density for each in case] for case in cases], axis=0) for cases in found])
    shares = np.array([np.mean([[each.share for each in case] for case in cases], axis=0) for cases in found])
    chosen = choices(densities)
    stated, machines = FACTORS.index(1.0), np.arange(len(found))
    gained = densities[machines, chosen] - densities[:, stated]
    inside = shares[machines, chosen]
    counted = [f"{FACTORS[k] * cause.size:.3g} ({np.sum(chosen == k)})" for k in range(len(FACTORS)) if k in chosen]
    return (
        f"| {cause.name} | {cause.size:g} | {', '.join(counted)} | {gained.mean():+.2f} | {gained.min():+.2f} "
        f"| {inside.mean():.0%} | {inside.min():.0%} | {shares[:, stated].mean():.0%} | {len(found)} |"
    )
