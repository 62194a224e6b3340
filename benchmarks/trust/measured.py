"""What the program makes of measured curves from a few readings of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded, estimated
from axiscal.estimation.estimation import Estimation
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.planning.planner import next_places
from axiscal.report.findings import findings
from axiscal.units import to_unit
from benchmarks.trust.curves import IsoTest, Measured

BAND, ENOUGH = 1.96, 0.9
_DRAWS = 3


@dataclass(frozen=True)
class Outcome:
    """share : of the truth in the 95 % band; rms, std : what was missed, and what the band says; flags : codes said

    withheld : share of the estimates whose U is withheld, since the readings contradict each other
    """

    design: str
    share: float
    rms: float
    std: float
    flags: tuple[str, ...]
    withheld: float


def outcomes(case: Measured) -> list[Outcome]:
    """Return what planned, evenly spaced and random readings of a case, as many of each, make of it."""
    described = campaign_from_texts(case.campaign, "campaign.toml", case.machine, "measured")
    problem = Case(described)
    low, high = np.array([axis.travel for axis in described.machine.axes]).T
    even = _judged("evenly spaced", case, problem, _nearest(case, _even(case, low, high)))
    draws = [_judged("random", case, problem, _random(case, low, high, seed)) for seed in range(_DRAWS)]
    figures = zip(*((d.share, d.rms, d.std, d.withheld) for d in draws), strict=True)
    share, rms, std, withheld = (float(np.mean(column)) for column in figures)
    flags = tuple(sorted({each for d in draws for each in d.flags}))
    mean = Outcome("random", share, rms, std, flags, withheld)
    return [_judged("planned", case, problem, None), even, mean]


def _judged(design: str, case: Measured, problem: Case, poses: Array | None) -> Outcome:
    known = concluded(problem, _planned(case, problem) if poses is None else _read(case, poses))
    mean, std = predicted(known, case.places, np.zeros_like(case.places))
    missed = case.truth - mean
    share = float(np.mean(np.abs(missed) <= BAND * std))
    flags = tuple(sorted({finding.code for finding in findings(known)}))
    rms, spread = (to_unit(float(np.sqrt(np.mean(v**2))), case.unit) for v in (missed, std))
    return Outcome(design, share, rms, spread, flags, float(known.agreement.withheld))


def predicted(estimation: Estimation, poses: Array, approaches: Array) -> tuple[Array, Array]:
    """Return what the only set-up would read without noise, and its standard deviation, rests included: (m,)."""
    wide = estimation.banded
    plain = wide.case.observation
    seen = plain.rows(0, poses, approaches)
    loose = seen.variances - plain.setups[0].noise ** 2
    known = wide.knowledge.belief.factor[: plain.size]
    mean: Array = seen.rows @ wide.knowledge.belief.mean[: plain.size]
    return mean, np.sqrt(np.sum((seen.rows @ known) ** 2, axis=1) + loose)


def _planned(case: Measured, problem: Case) -> list[Reading]:
    taken, known = list[Reading](), estimated(problem, ())
    while len(taken) < case.readings:
        place = next_places(known.case, known.knowledge, known.readings, known.outliers)[0]
        pose = tuple(_nearest(case, np.array([place.pose]))[0]) if case.places.shape[1] > 1 else place.pose
        taken.append(Reading("gauge", pose, place.approach, case.read(pose)))
        known = estimated(problem, taken, known)
    return taken


def _read(case: Measured, poses: Array) -> list[Reading]:
    places = [tuple(map(float, pose)) for pose in poses]
    return [Reading("gauge", at, tuple(0 for _ in at), case.read(at)) for at in places]


def _even(case: Measured, low: Array, high: Array) -> Array:
    if len(low) == 1:
        return np.linspace(low, high, case.readings)
    across = max(2, round(float(np.sqrt(case.readings * (high[0] - low[0]) / (high[1] - low[1])))))
    along = max(2, case.readings // across)
    x, y = np.meshgrid(np.linspace(low[0], high[0], across), np.linspace(low[1], high[1], along))
    return np.column_stack([x.ravel(), y.ravel()])


def _random(case: Measured, low: Array, high: Array, seed: int) -> Array:
    rng = np.random.default_rng(seed)
    if len(low) == 1:
        uniform: Array = np.sort(rng.uniform(low, high, (case.readings, 1)), axis=0)
        return uniform
    chosen: Array = case.places[rng.choice(len(case.places), case.readings, replace=False)]
    return chosen


def _nearest(case: Measured, poses: Array) -> Array:
    """Move poses of a map onto places where the truth is known, each once."""
    if case.places.shape[1] == 1:
        return poses
    return np.array([case.places[int(np.argmin(np.sum((case.places - pose) ** 2, axis=1)))] for pose in poses])


def iso_outcome(test: IsoTest) -> tuple[Outcome, int]:
    """Return what the ISO 230-2 test says of the dense passes, one offset per pass taken off, and how many passes."""
    described: CampaignDescription = campaign_from_texts(test.campaign, "campaign.toml", test.machine, "measured")
    known = concluded(Case(described), test.readings)
    parts = [_pass(known, *test.passes[key], np.sign(key)) for key in test.passes]
    missed, std = np.concatenate([p[0] for p in parts]), np.concatenate([p[1] for p in parts])
    flags = tuple(sorted({finding.code for finding in findings(known)}))
    rms, spread = (to_unit(float(np.sqrt(np.mean(v**2))), "um") for v in (missed, std))
    share = float(np.mean(np.abs(missed) <= BAND * std))
    return Outcome("as measured", share, rms, spread, flags, float(known.agreement.withheld)), len(parts)


def _pass(estimation: Estimation, x: Array, y: Array, direction: float) -> tuple[Array, Array]:
    mean, std = predicted(estimation, x[:, None], np.full((len(x), 1), direction))
    missed: Array = y - mean
    return missed - missed.mean(), std


def table(cases: Sequence[Callable[[], Measured]]) -> list[tuple[Measured, list[Outcome]]]:
    """Return the outcomes of every case."""
    return [(case, outcomes(case)) for case in (make() for make in cases)]
