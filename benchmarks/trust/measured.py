"""What the program makes of measured curves from a few readings of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple, dataclass

import numpy as np
from scipy.interpolate import RBFInterpolator

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation
from axiscal.measurement.reading import Places, Reading
from axiscal.numerics import Array
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import proposed
from axiscal.units import to_unit
from benchmarks.trust.curves import IsoTest, Measured

BAND, ENOUGH = 1.96, 0.9
_DRAWS = 3
_CANDIDATES = 1000


@dataclass(frozen=True)
class Outcome:
    """share : of the truth in the 95 % band; rms, std : what was missed, and what the band says

    withheld : share of the estimates whose U is withheld, since the readings contradict each other
    """

    share: float
    rms: float
    std: float
    withheld: float


@dataclass(frozen=True)
class Outcomes:
    """What as many readings make of a case at each kind of places.

    spline : what a thin-plate spline through the even readings misses
    """

    planned: Outcome
    even: Outcome
    random: Outcome
    spline: float


def outcomes(case: Measured) -> Outcomes:
    """Return what readings of a case make of it, in its unit."""
    described = campaign_from_texts(case.campaign, "campaign.toml", case.machine, "measured")
    problem = Case(described)
    low, high = _travel(problem)
    evenly = at_even_places(case, problem)
    draws = [_judged(case, problem, _read(case, _random(case, low, high, seed))) for seed in range(_DRAWS)]
    mean = Outcome(*(float(np.mean(column)) for column in zip(*map(astuple, draws), strict=True)))
    planned, even = _judged(case, problem, _planned(case, problem)), _judged(case, problem, evenly)
    return Outcomes(planned, even, mean, _by_spline(case, evenly))


def at_even_places(case: Measured, problem: Case) -> list[Reading]:
    """Return as many readings of a case as it asks for, evenly spaced."""
    return _read(case, _nearest(case, _even(case, *_travel(problem))))


def _travel(problem: Case) -> tuple[Array, Array]:
    low, high = np.array([axis.travel for axis in problem.description.machine.axes]).T
    return low, high


def _judged(case: Measured, problem: Case, readings: Sequence[Reading]) -> Outcome:
    known = concluded(problem, readings)
    mean, std = predicted(known, case.places, np.zeros_like(case.places))
    missed = case.truth - mean
    share = float(np.mean(np.abs(missed) <= BAND * std))
    rms, spread = (to_unit(float(np.sqrt(np.mean(v**2))), case.unit) for v in (missed, std))
    return Outcome(share, rms, spread, float(known.agreement.withheld))


def _by_spline(case: Measured, readings: Sequence[Reading]) -> float:
    """Return what a thin-plate spline misses, RMS; a natural cubic one along a line."""
    first = {each.pose: each.value for each in readings}
    spline = RBFInterpolator(
        np.array(list(first), dtype=float),
        np.array(list(first.values()), dtype=float),
        kernel="cubic" if case.places.shape[1] == 1 else "thin_plate_spline",
    )
    missed = case.truth - np.asarray(spline(case.places))
    return to_unit(float(np.sqrt(np.mean(missed**2))), case.unit)


def predicted(estimation: Estimation, poses: Array, approaches: Array) -> tuple[Array, Array]:
    """Return what the only set-up would read without noise, and its standard deviation, rests included: (m,)."""
    plain = estimation.case.observation
    seen = plain.numbers(Places.of_setup(0, poses, approaches))
    loose = plain.variances(seen) - plain.setups[0].noise ** 2
    known = estimation.printed.belief.factor[: plain.size]
    mean: Array = seen.rows @ estimation.printed.belief.mean[: plain.size]
    return mean, np.sqrt(np.sum((seen.rows @ known) ** 2, axis=1) + loose)


def _planned(case: Measured, problem: Case) -> list[Reading]:
    """Return the readings of a plan that is made before the first of them."""
    places = proposed(problem, Limits(case.readings), _CANDIDATES).places
    poses = np.array(places.poses)
    poses = _nearest(case, poses) if case.places.shape[1] > 1 else poses
    sides = places.approaches.astype(int).tolist()
    each = zip(poses.tolist(), sides, strict=True)
    return [Reading("gauge", tuple(pose), tuple(side), case.read(tuple(pose))) for pose, side in each]


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


def iso_outcome(test: IsoTest) -> Outcome:
    """Return what the ISO 230-2 test says of the dense passes, one offset per pass taken off."""
    described: CampaignDescription = campaign_from_texts(test.campaign, "campaign.toml", test.machine, "measured")
    known = concluded(Case(described), test.readings)
    parts = [_pass(known, *test.passes[key], np.sign(key)) for key in test.passes]
    missed, std = np.concatenate([p[0] for p in parts]), np.concatenate([p[1] for p in parts])
    rms, spread = (to_unit(float(np.sqrt(np.mean(v**2))), "um") for v in (missed, std))
    share = float(np.mean(np.abs(missed) <= BAND * std))
    return Outcome(share, rms, spread, float(known.agreement.withheld))


def _pass(estimation: Estimation, x: Array, y: Array, direction: float) -> tuple[Array, Array]:
    mean, std = predicted(estimation, x[:, None], np.full((len(x), 1), direction))
    missed: Array = y - mean
    return missed - missed.mean(), std
