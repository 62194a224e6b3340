"""A short independent check of a machine after its tables were loaded: where to look, and what the readings decide.

Points are new ones, half of them where the estimate expects the machine to be worst, half where it expects it to be
best. As-left readings are judged against a tolerance with a guard band (after ISO 14253-1): pass when every deviation
with its expanded uncertainty lies inside, fail when one lies outside with all of it, undecided between.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from axiscal.compensation.effect import Control, left_by
from axiscal.compensation.estimate import Estimate
from axiscal.exceptions import ReadingError
from axiscal.measurement.instrument import INSTRUMENTS
from axiscal.measurement.instruments.displacement import Displacement
from axiscal.measurement.instruments.model import Place
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array

GUARD = 1.645
"""Expanded uncertainty in standard deviations: one side, 95 %."""
_CHECKING = tuple(sorted(name for name, kind in INSTRUMENTS.items() if isinstance(kind.model, Displacement)))
"""Instruments that read a displacement along one direction: the ones a check is made with."""
_FRESH, _APART = 0.05, 0.15
_PER_SETUP = 4
_UNLIKELY = 0.01
_SAME = 1e-7

Verdict = Literal["pass", "fail", "undecided"]


@dataclass(frozen=True, eq=False, slots=True)
class Places:
    """Where readings could be, or shall be, taken.

    setups : (m,) indices; poses : (m, q) m or rad; approaches : (m, q) of +1, -1, 0
    """

    setups: NDArray[np.intp]
    poses: Array
    approaches: Array

    def of(self, chosen: Sequence[int]) -> Places:
        """Return some of them."""
        at = np.array(chosen, dtype=int)
        return Places(self.setups[at], self.poses[at], self.approaches[at])


@dataclass(frozen=True, eq=False, slots=True)
class Judgement:
    """What as-found and as-left readings say; m.

    found, left : (m,) deviations, the set-ups' own unknowns taken off; std : (m,) of each from the instrument
    agrees : probability that as-left readings lie this far from what the estimate expects, if it is right
    """

    verdict: Verdict
    tolerance: float
    found: Array
    left: Array
    std: Array
    agrees: float

    @property
    def believed(self) -> bool:
        """Whether the readings agree with the estimate and its uncertainty."""
        return self.agrees >= _UNLIKELY


def expected(
    estimate: Estimate, setups: Sequence[Setup], places: Places, control: Control | None
) -> tuple[Array, Array]:
    """Return the deviation along each reading that is expected under a control, (m,), and its factor (m, n), m."""
    directions = np.array([setups[s].direction for s in places.setups])
    if control is None:
        tips = estimate.deviation(places.poses, places.approaches)
    else:
        tips = left_by(estimate.machine, estimate.deviation, control, places.poses, places.approaches)
    rows = np.einsum("mcn,mc->mn", estimate.model.rows(places.poses, places.approaches), directions)
    levers = np.einsum("fmc,mc->mf", estimate.model.levers(places.poses), directions)
    rests = levers * np.array([function.rest for function in estimate.model.functions])
    loose = np.diag(np.sqrt(np.sum(rests**2, axis=1)))
    return np.sum(tips * directions, axis=1), np.hstack([rows @ estimate.factor, loose])


def plan_check(
    estimate: Estimate,
    setups: Sequence[Setup],
    candidates: Places,
    used: Sequence[Reading],
    control: Control,
    count: int,
) -> Places:
    """Return `count` of the candidates that were not read before: half of them the worst, half the best.

    They share the few set-ups that promise most, four places or more each. Raises ReadingError when there are not as
    many.
    """
    mean, factor = without_zeros(setups, candidates, *expected(estimate, setups, candidates, control))
    score = np.hypot(mean, np.sqrt(np.sum(factor**2, axis=1)))
    lengths = np.array([axis.length for axis in estimate.machine.axes])
    fresh = _fresh(setups, candidates, used, lengths)
    indices = np.unique(candidates.setups[fresh])
    promising = sorted(indices, key=lambda s: -np.max(score[fresh & (candidates.setups == s)]))
    shares = [part.size for part in np.array_split(np.arange(count), max(1, min(len(indices), count // _PER_SETUP)))]
    chosen: list[int] = []
    for setup, share in zip(promising, shares, strict=False):
        mine = np.flatnonzero(fresh & (candidates.setups == setup))
        worst = _spread(mine[np.argsort(-score[mine], kind="stable")], candidates, lengths, (share + 1) // 2, [])
        best = _spread(mine[np.argsort(score[mine], kind="stable")], candidates, lengths, share // 2, worst)
        chosen += [*worst, *best]
    if len(chosen) < count:
        raise ReadingError(f"only {len(chosen)} places of {count} are new", "Ask for fewer --points")
    return candidates.of(sorted(chosen, key=lambda i: (candidates.setups[i], *candidates.poses[i])))


def without_zeros(setups: Sequence[Setup], places: Places, mean: Array, factor: Array) -> tuple[Array, Array]:
    """Return expectation and factor with the mean of each set-up that has an unknown zero taken off."""
    mean, factor = mean.copy(), factor.copy()
    for index in np.unique(places.setups):
        mine = places.setups == index
        if any(unknown.name == "zero" for unknown in setups[index].unknowns):
            mean[mine] -= mean[mine].mean()
            factor[mine] -= factor[mine].mean(axis=0)
    return mean, factor


def with_displacements(setups: Sequence[Setup], candidates: Places) -> Places:
    """Return the candidates of set-ups that read a displacement; raises ReadingError when there are none."""
    kept = [i for i, s in enumerate(candidates.setups) if setups[s].instrument in _CHECKING]
    if not kept:
        known = ", ".join(_CHECKING)
        raise ReadingError("no set-up of this campaign reads a displacement", f"A check is made with: {known}")
    return candidates.of(kept)


def judge(
    estimate: Estimate,
    setups: Sequence[Setup],
    found: Sequence[Reading],
    left: Sequence[Reading],
    control: Control,
    tolerance: float,
) -> Judgement:
    """Return what readings without and with the tables say; raises ReadingError when they are not of the same places.

    What a set-up brings itself, its zero and its slope, is taken off each set of readings.
    """
    _refuse_different(found, left)
    names = [setup.name for setup in setups]
    _refuse_others([setups[names.index(reading.setup)] for reading in left])
    indices = np.array([names.index(reading.setup) for reading in left])
    places = Places(
        indices,
        np.array([r.pose for r in left], dtype=float),
        np.array([r.approach for r in left], dtype=float),
    )
    free = _free_of_setups(estimate, setups, places)
    noise = np.array([r.std or setups[s].noise for r, s in zip(left, indices, strict=True)])
    before, after = (free @ _deviations(estimate, setups, places, readings) for readings in (found, left))
    std = np.sqrt(np.diag(free @ np.diag(noise**2) @ free.T))
    mean, factor = expected(estimate, setups, places, control)
    agrees = _likelihood(after - free @ mean, free @ (factor @ factor.T + np.diag(noise**2)) @ free.T)
    return Judgement(verdict(after, std, tolerance), tolerance, before, after, std, agrees)


def verdict(deviations: Array, std: Array, tolerance: float) -> Verdict:
    """Return what deviations with their standard deviations say of a tolerance (ISO 14253-1)."""
    sizes = np.abs(deviations)
    if np.all(sizes + GUARD * std <= tolerance):
        return "pass"
    return "fail" if np.any(sizes - GUARD * std > tolerance) else "undecided"


def _deviations(estimate: Estimate, setups: Sequence[Setup], places: Places, readings: Sequence[Reading]) -> Array:
    """Return what was read (m,), less what is known of the instruments, such as their growth by temperature, m."""
    values = np.array([reading.value for reading in readings])
    for index in np.unique(places.setups):
        mine, setup = places.setups == index, setups[index]
        place = Place(estimate.machine, places.poses[mine], setup.moves)
        values[mine] -= INSTRUMENTS[setup.instrument].model.beyond(setup, place)
    return values


def _free_of_setups(estimate: Estimate, setups: Sequence[Setup], places: Places) -> Array:
    """Return the projection (m, m) that takes the own unknowns of every set-up off its readings."""
    free = np.eye(len(places.setups))
    for index in np.unique(places.setups):
        mine = np.flatnonzero(places.setups == index)
        own = _own_rows(estimate, setups[index], places.poses[mine])
        if len(mine) <= own.shape[1]:
            what = f'{len(mine)} reading(s) with "{setups[index].name}" cannot tell the machine from the set-up'
            raise ReadingError(what, f"Take {own.shape[1] + 1} or more with it, or leave it out")
        free[np.ix_(mine, mine)] -= own @ np.linalg.pinv(own)
    return free


def _own_rows(estimate: Estimate, setup: Setup, poses: Array) -> Array:
    """Return how the unknowns of a set-up show in its readings, (m, unknowns)."""
    model, place = INSTRUMENTS[setup.instrument].model, Place(estimate.machine, poses, setup.moves)
    direction = np.array(setup.direction)
    columns = [model.own(setup, unknown.name, direction, place) for unknown in setup.unknowns]
    return np.array(columns).reshape(len(columns), len(poses)).T


def _likelihood(values: Array, covariance: Array) -> float:
    """Return the probability of values at least this large from a singular normal."""
    from scipy.special import chdtrc

    scale, vectors = np.linalg.eigh(covariance)
    kept = scale > 1e-9 * scale[-1]
    parts = vectors[:, kept].T @ values
    return float(chdtrc(int(kept.sum()), float(np.sum(parts**2 / scale[kept]))))


def _refuse_others(used: Sequence[Setup]) -> None:
    for setup in used:
        if setup.instrument not in _CHECKING:
            known = ", ".join(_CHECKING)
            raise ReadingError(
                f'"{setup.name}" reads no displacement ({setup.instrument})', f"Check with one of {known}"
            )


def _refuse_different(found: Sequence[Reading], left: Sequence[Reading]) -> None:
    if len(found) != len(left) or not left:
        what = f"there are {len(found)} as-found and {len(left)} as-left readings"
        raise ReadingError(what, "Take both at the same places, in the same order")
    for before, after in zip(found, left, strict=True):
        apart = np.max(np.abs(np.subtract(before.pose, after.pose)))
        if before.setup != after.setup or apart > _SAME or before.approach != after.approach:
            what = "as found and as left were not read at the same place from the same side"
            raise ReadingError(what, "Take both at the same places, in the same order", line=after.line)


def _fresh(setups: Sequence[Setup], candidates: Places, used: Sequence[Reading], lengths: Array) -> NDArray[np.bool_]:
    fresh = np.ones(len(candidates.setups), dtype=bool)
    for reading in used:
        same = np.array([setups[s].name == reading.setup for s in candidates.setups])
        near = np.max(np.abs(candidates.poses - np.array(reading.pose)) / lengths, axis=1) < _FRESH
        fresh &= ~(same & near)
    return fresh


def _spread(
    ranked: NDArray[np.intp], candidates: Places, lengths: Array, count: int, taken: Sequence[int]
) -> list[int]:
    """Return the first of the ranked candidates that keep apart from each other and from those taken."""
    chosen: list[int] = []
    for i in ranked.tolist():
        if len(chosen) == count:
            break
        others = [j for j in (*chosen, *taken) if candidates.setups[j] == candidates.setups[i]]
        apart = np.abs(candidates.poses[others] - candidates.poses[i]) / lengths if others else np.ones((1, 1))
        if np.all(np.max(apart, axis=1) >= _APART):
            chosen.append(i)
    return chosen
