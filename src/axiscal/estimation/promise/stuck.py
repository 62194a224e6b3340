"""An instrument that shows again what it showed before: it is stuck, or a probe repeats its last height.

Of n readings of a set-up s show the same value as the one before. If the machine made these values, they have the
density p(yₛ | others), each over a step q of the display; if the instrument is stuck they are certain. So the odds are

    log PRIOR − log places − log p(y) + log p(y without these) − Σ log q,    p with the sizes integrated out

One run of equal values has n²/2 places, equal values anywhere (n + 1) binomial(n, s). The step of a display that never
showed two values is that of its noise, √12 σ. Sizes as stated tell first whether anything is to be weighed.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise
from math import lgamma
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.estimation.promise.agreement import NAMED, PRIOR, SEVERAL, Explained, Tried, tail_of
from axiscal.estimation.promise.problem import Problem
from axiscal.estimation.promise.spaces import Given
from axiscal.estimation.promise.unknowns import space_of
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal_core.draws import Weighed, sized

_OF_NOISE = float(np.sqrt(12.0))
"""Steps of a display whose rounding alone has the noise's standard deviation."""
_FINEST = 0.01
"""Noises: what differs by less differs by the arithmetic of a program."""


class Repeats(NamedTuple):
    """Readings that show what the one before in their set-up shows.

    setups : whose; readings : (s,) their indices; step : of the display, m or rad, by set-up
    log_places : logarithm of the number of other patterns, one as likely as the other
    """

    setups: tuple[int, ...]
    readings: NDArray[np.intp]
    step: dict[int, float | None]
    log_places: float


def repeats(setups: Sequence[Setup], readings: Sequence[Reading]) -> Iterator[Repeats]:
    """Yield what may be stuck: the longest run of each set-up, all that each repeats, and all that all repeat."""
    every = list[tuple[int, NDArray[np.intp], int]]()
    steps = {index: _step(setup, setups, readings) for index, setup in enumerate(setups)}
    for index, setup in enumerate(setups):
        mine = [k for k, reading in enumerate(readings) if reading.setup == setup.name]
        again = np.array(
            [readings[b].values == readings[a].values and not readings[b].accepted for a, b in pairwise(mine)]
        )
        if not again.any():
            continue
        places = np.array(mine[1:], dtype=np.intp)
        longest = max(_runs(again), key=len)
        if SEVERAL - 1 <= len(longest) < again.sum():
            yield Repeats((index,), places[longest], steps, 2 * float(np.log(len(mine))) - float(np.log(2.0)))
        every.append((index, places[again], len(again)))
    for found in [[each] for each in every] + ([every] if len(every) > 1 else []):
        count, many = sum(len(each) for _, each, _ in found), sum(possible for _, _, possible in found)
        if count >= SEVERAL - 1:
            indices = tuple(index for index, _, _ in found)
            yield Repeats(indices, np.concatenate([each for _, each, _ in found]), steps, _log_patterns(many, count))


def _repeats(before: Reading, here: Reading) -> bool:
    return here.values == before.values and not here.accepted


def stuck(problem: Problem, found: Weighed[Given], repeated: Iterable[Repeats]) -> Iterator[Tried]:
    """Yield the readings that an instrument was stuck at, where sizes as stated and as learnt both say so."""
    for each in repeated:
        again = np.isin(problem.reading, each.readings)
        if not again.any() or again.all():
            continue
        noise = problem.noise[again]
        steps = np.array([each.step[int(index)] or np.inf for index in problem.setup[again]]) / noise
        steps = np.maximum(np.where(np.isfinite(steps), steps, _OF_NOISE), _FINEST)
        prior = float(np.log(PRIOR) - each.log_places - np.sum(np.log(steps)))
        if prior - _log_density_as_stated(problem, found, again) <= np.log(NAMED):
            continue
        others = sized(space_of(problem.only(~again)))
        density = found.log_evidence - others.log_evidence - 0.5 * float(again.sum()) * np.log(2 * np.pi)
        first = int(each.readings.min())
        yield Tried(Explained("stuck", prior - density, each.setups, first), tail_of(problem.only(~again), others))


def _log_density_as_stated(problem: Problem, found: Weighed[Given], some: NDArray[np.bool_]) -> float:
    """Return log p(yₛ | others) at the sizes as stated: Λ = (K⁻¹)ₛₛ is the precision of yₛ, given the others."""
    given = found.drawn.stated
    weighted = given.judged(np.column_stack([np.eye(len(some))[:, some], problem.values]))[some]
    precision, pulled = weighted[:, :-1], weighted[:, -1]
    square = float(pulled @ np.linalg.solve(precision, pulled))
    return 0.5 * float(np.linalg.slogdet(precision / (2 * np.pi))[1] - square)


def _step(setup: Setup, setups: Sequence[Setup], readings: Sequence[Reading]) -> float | None:
    """Return the smallest difference of two values that an instrument showed, m or rad; None where it showed one."""
    alike = {each.name for each in setups if each.instrument == setup.instrument}
    shown = np.unique([value for reading in readings if reading.setup in alike for value in reading.values])
    return float(np.diff(shown).min()) if len(shown) > 1 else None


def _runs(again: NDArray[np.bool_]) -> list[NDArray[np.intp]]:
    """Return the indices of each run of true values."""
    where = np.flatnonzero(again)
    return np.split(where, np.flatnonzero(np.diff(where) > 1) + 1)


def _log_patterns(count: int, some: int) -> float:
    """Return log of (n + 1) binomial(n, s): any share of readings may repeat."""
    return float(np.log1p(count)) + lgamma(count + 1) - lgamma(some + 1) - lgamma(count - some + 1)
