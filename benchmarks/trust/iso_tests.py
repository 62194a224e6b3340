"""Real ISO 230-2 tests as readings: what a table made of them leaves at their own targets, and what is promised."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation
from axiscal.evaluation.standards import positioning_test
from axiscal.measurement.readers.files import recognised
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.tables.sampling import axis_tables

GOLDEN = Path(__file__).resolve().parents[2] / "tests" / "golden" / "iso230"
FILES = ("ess_target_x", "ess_muts_x", "ess_muts_y")
LEARNING = ("nothing", "the rest", "all scales")
STATED_STD = 30e-6

_SETUP = 'name = "gauge"\ninstrument = "interferometer"\ndirection = "x"\nnoise = "2 um"\napproach = "both"\n'


@dataclass(frozen=True, eq=False)
class Runs:
    """targets : (n,); up, down : (n, runs) of one file, m"""

    targets: Array
    up: Array
    down: Array

    @classmethod
    def of(cls, name: str) -> Runs:
        """Return a file's runs; all three have both directions."""
        test = positioning_test(recognised(GOLDEN / f"{name}.csv"))
        assert test.up is not None
        assert test.down is not None
        return cls(test.targets, test.up, test.down)

    @property
    def both(self) -> Array:
        """All readings of each target, (n, 2 runs)."""
        return np.hstack([self.up, self.down])

    @property
    def limit(self) -> float:
        """Two standard errors of the mean of a target, s pooled over targets and directions, m."""
        s = np.sqrt(np.mean([self.up.var(axis=1, ddof=1), self.down.var(axis=1, ddof=1)]))
        return float(2 * s / np.sqrt(self.both.shape[1]))

    def readings(self) -> list[Reading]:
        """Return them in the order of the standard's test: up, down, and again."""
        sides = ((1, self.up), (-1, self.down))
        return [
            Reading("gauge", (float(target),), (side,), float(value))
            for run in range(self.up.shape[1])
            for side, runs in sides
            for target, value in zip(self.targets, runs[:, run], strict=True)
        ]


def estimated_from(runs: Runs, learning: str) -> Estimation:
    """Return what the runs say: std 30 um, length two spacings, noise 2 um stated.  learning : one of `LEARNING`"""
    low, high = runs.targets[[0, -1]] * 1e3
    length, rest = 2e3 * (runs.targets[1] - runs.targets[0]), "" if learning == "nothing" else ', rest = "estimate"'
    machine = f'chain = "w-b-X-t"\n[axes.X]\ntravel = ["{low} mm", "{high} mm"]\n[errors]\n'
    machine += f'EXX = {{ std = "30 um", length = "{length} mm"{rest} }}\nEXX_reversal = {{ std = "10 um" }}\n'
    head = "" if learning == "all scales" else 'usual = "off"\nsure = "exactly"\n'
    campaign = f'machine = "m"\n{head}[target]\nreadings = 1\n[[setups]]\n{_SETUP}'
    return concluded(Case(campaign_from_texts(campaign, "campaign.toml", machine, "m")), runs.readings())


def left_at_targets(runs: Runs, known: Estimation) -> float:
    """Return the largest mean reading of a target that the table does not take away, beside their mean, m."""
    left = runs.both.mean(axis=1)
    for table in axis_tables(known.estimate()):  # none where the runs tell nothing
        left = left - np.interp(runs.targets, table.positions, (table.forward + table.reverse) / 2)
    return float(np.max(np.abs(left - left.mean())))


def iso_rows() -> Iterator[str]:
    """Yield the lines of the table."""
    for name in FILES:
        runs = Runs.of(name)
        known = estimated_from(runs, "all scales")
        left, limit, promised = (
            f"{1e6 * v:.2f} µm" for v in (left_at_targets(runs, known), runs.limit, known.accuracy.rms)
        )
        worth = "–" if known.posterior is None else f"{known.posterior.effective:.0f}"
        yield f"| {name} | {left} | {limit} | {promised} | {worth} |"
