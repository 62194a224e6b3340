"""Values that are not what the machine makes: of another sign, unit or place, of another set-up, or of no machine.

- sign: all of a set-up. swapped: two set-ups with as many numbers exchange theirs.
- unit: f times too large from some reading on, at the sizes as stated. Of all that are f times too small, a noise f
  times below what is stated is a rival, as probable as any mistake.
- shifted: each value belongs to the place behind or before, as if a line was missed. The one that is left is anywhere
  among the others. A reading that seems bad may be one of these, so it counts.
- still: a set-up shows one digit, anywhere within w, or d neighbouring ones, each as likely. So its n readings have,
  over the step q of the display, p = d^−n q^(1−n)/w. Zeros alone are such readings.
- stuck: it shows again what it showed before. Of these s of n values the machine makes each one of all within a step q
  of the display; where it is stuck they are certain. One run of equal values has n²/2 places, equal values anywhere
  (n + 1) binomial(n, s). Values that are no multiples of their smallest difference show the step by their last digits.
  So does a display that showed one value alone: a step of √(2π) σ of its noise at most.
- noise: P(θ < log 0.1 | y), θ its logarithm over what is stated, against as much before any reading.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import combinations, pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.estimation.promise.mistake import (
    CONTRADICTS,
    INCH,
    PRIOR,
    SEVERAL,
    Explained,
    Sought,
    Suspect,
    Tried,
    numbers_of_one,
)
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal_core.draws import Weighed
from axiscal_core.from_scipy import chi_square_tail, normal_share
from axiscal_core.problem import Problem
from axiscal_core.spaces import sums_of

FEWEST = 4
"""Readings of a set-up: three are still, or in another order, by chance."""
_ANYWHERE = 1e3
"""Noises: where a display may stand, as wide as zeros are as a rule."""
_DIGITS = 3.5
"""A last digit that flickers shows its neighbours, and nothing else."""
_UNITS = 1000.0, INCH
"""By definition: mm for um, and inches for mm."""
_QUIET = math.log(0.1)
"""Of a stated noise, its logarithm: nobody states one ten times too large, and another unit is farther off."""
_ALIKE = 1e-5
"""Steps by which a multiple may be off: beyond the rounding of a float, and seldom met by another value."""
_OF_NOISE = math.sqrt(2 * math.pi)
"""Noises: the step at which equal values of a machine without errors would be certain."""
_FINEST = 0.01
"""Noises: what differs by less differs by the arithmetic of a program."""


def signs(sought: Sought) -> Iterator[Suspect]:
    """Yield each set-up with the other sign."""
    for setup, mine in sought.of_setups():
        values = np.where(mine, -1, 1) * sought.problem.values
        yield sought.with_values(Explained("sign", 0.0, (setup,), factor=-1.0), 0.0, values)


def exchanges(sought: Sought) -> Iterator[Suspect]:
    """Yield each two set-ups with as many numbers that may be swapped."""
    problem = sought.problem
    for (first, one), (second, other) in combinations(sought.of_setups(), 2):
        if np.count_nonzero(one) == np.count_nonzero(other):
            values = problem.values * problem.noise
            values[one], values[other] = values[other], values[one]
            yield sought.with_values(Explained("swapped", 0.0, (first, second)), 0.0, values / problem.noise)


def larger_units(problem: Problem, found: Weighed) -> Iterator[Tried]:
    """Yield the likeliest reading of each set-up from which on values are too large, where sizes as stated fit then.

    Sizes that are learnt fit any machine that is far worse than stated.
    """
    given = found.drawn.stated
    for setup in np.unique(problem.setup).tolist():
        mine = problem.setup == setup
        readings = np.unique(problem.reading[mine])
        starts = np.searchsorted(problem.reading, readings)
        since = np.count_nonzero(mine) - np.searchsorted(np.flatnonzero(mine), starts)
        (sums,) = sums_of([given], (mine * problem.values)[None], starts)
        fisher, pulled = (each.ravel() for each in sums.to_the_end())
        # All of them may be in another unit as well as those from any later reading on.
        places = np.where(readings == readings[0], 1, max(len(readings) - 1, 1))
        for factor in (1000.0, 1 / 1000.0, INCH, 1 / INCH):
            over = 1 - 1 / factor
            squares = given.misfit - 2 * over * pulled + over**2 * fisher
            gains = (given.misfit - squares) / 2 - since * math.log(factor) - np.log(places)
            best = int(np.argmax(gains))
            tail = chi_square_tail(len(problem.values), float(squares[best]))
            odds, first = math.log(PRIOR) + found.log_stated + float(gains[best]), int(readings[best]) if best else -1
            # Divided by enough all readings agree, and then by far too well.
            if 2 * (p := min(tail, 1 - tail)) >= CONTRADICTS:
                yield Tried(Explained("unit", odds, (setup,), first, factor), p)


def smaller_unit(sought: Sought, setup: int) -> Iterator[Suspect]:
    """Yield a set-up all of whose values are as much too small as another unit makes them."""
    problem, mine = sought.problem, sought.problem.setup == setup
    for factor in _UNITS if np.ptp(problem.values[mine]) > _ALIKE else ():
        scale, wrong = np.where(mine, factor, 1.0), Explained("unit", 0.0, (setup,), factor=1 / factor)
        found = sought.with_values(wrong, int(mine.sum()) * math.log(factor), scale * problem.values)
        rows, type_b = scale[:, None] * problem.rows, scale[:, None] * problem.type_b
        yield found._replace(rival=partial(replace, found.make(), rows=rows, type_b=type_b))


def shifted(sought: Sought, setup: int) -> Iterator[Suspect]:
    """Yield that each value of a set-up belongs to the place behind, or to that before."""
    problem, mine = sought.problem, np.flatnonzero(sought.problem.setup == setup)
    values, count = problem.values * problem.noise, numbers_of_one(problem.reading[mine])
    wide = max(1.0, float(np.std(problem.values[mine])))
    for step, left in ((1, mine[:count]), (-1, mine[-count:])):
        moved = values.copy()
        moved[mine] = np.roll(values[mine], step * count)
        free = wide * (left[:, None] == np.arange(len(values)))
        wrong = Explained("shifted", 0.0, (setup,), factor=float(step))
        yield sought.with_values(wrong, 0.0, moved / problem.noise, free)


def still(sought: Sought, setup: int) -> Suspect:
    """Return that a set-up shows the same everywhere."""
    problem, mine = sought.problem, sought.problem.setup == setup
    log_rest = flickering(problem.values[mine], numbers_of_one(problem.reading[mine]))
    return sought.without(Explained("still", 0.0, (setup,)), log_rest, mine)


def of_setup(sought: Sought, setup: int) -> Iterator[Suspect]:
    """Yield what is sick of a set-up but for a shift."""
    if len(np.unique(sought.problem.reading[sought.problem.setup == setup])) >= FEWEST:
        yield from (still(sought, setup), *smaller_unit(sought, setup))


def quiet(problem: Problem, found: Weighed) -> Iterator[Tried]:
    """Yield the set-ups whose noise is below a tenth of what is stated."""
    for setup in np.unique(problem.setup).tolist():
        mine = problem.setup == setup
        several = len(np.unique(problem.reading[mine])) >= FEWEST
        for group in np.unique(problem.groups[mine & (problem.groups >= 0)]).tolist() if several else ():
            below = float(normal_share(np.array(_QUIET / (problem.sizes.share * problem.sizes.of[group].spread))))
            share = float(found.weights @ (found.thetas[:, group] < _QUIET))
            # draws tell no probability that is less than that of half of one
            odds = share / max(1 - share, 0.5 / len(found.every)) * (1 - below) / below
            if share > 0:
                factor = math.exp(float(found.weights @ found.thetas[:, group]))
                yield Tried(Explained("noise", math.log(PRIOR * odds), (setup,), factor=factor), 1.0)


def flickering(values: NDArray[np.float64], count: int = 1) -> float:
    """Return log p of values if a display shows neighbouring digits alone, up to (2π)^(−m/2); −∞ for many.

    values : (m,) over the noise; count : numbers of a reading
    """
    total = 0.0
    for each in values.reshape(-1, count).T:
        shown = _ALIKE * np.unique(np.round(each / _ALIKE))
        step = float(np.diff(shown).min()) if len(shown) > 1 else _FINEST
        if (digits := 1 + float(np.ptp(shown)) / step) > _DIGITS:
            return -math.inf
        total += (len(each) - 1) * math.log(_OF_NOISE / step) - len(each) * math.log(digits) - math.log(_ANYWHERE)
    return total


class Repeats(NamedTuple):
    """Readings that show what the one before in their set-up shows.

    setups : whose; readings : (s,) their indices; log_places : logarithm of the number of patterns as likely as theirs
    steps : of what a set-up shows, m or rad
    """

    setups: tuple[int, ...]
    readings: NDArray[np.intp]
    log_places: float
    steps: Mapping[int, float]


def repeats(setups: Sequence[Setup], readings: Sequence[Reading]) -> Iterator[Repeats]:
    """Yield what may be stuck: the longest run of each set-up, all that each repeats, and all that all repeat."""
    numbers, mine = {setup.name: number for number, setup in enumerate(setups)}, defaultdict[int, list[int]](list)
    for index, reading in enumerate(readings):
        mine[numbers[reading.setup]].append(index)
    again, steps = dict[int, NDArray[np.intp]](), dict[int, float]()
    for number, every in mine.items():
        same = [i for last, i in pairwise(every) if readings[i].values == readings[last].values]
        if shown_again := [i for i in same if not readings[i].accepted]:  # what nobody vouches for
            again[number] = np.array(shown_again)
            values = np.unique([value for index in every for value in readings[index].values])
            steps[number] = step_shown(values, _OF_NOISE * setups[number].noise)
    for number, each in again.items():
        count, at = len(mine[number]), np.searchsorted(mine[number], each)
        run = max(np.split(each, np.flatnonzero(np.diff(at) > 1) + 1), key=len)
        of_run, of_all = math.log(count**2 / 2), _log_patterns(count - 1, len(each))
        if len(run) < len(each):
            yield Repeats((number,), run, of_run, steps)
        yield Repeats((number,), each, of_all if len(run) < len(each) else min(of_run, of_all), steps)
    if len(again) > 1:
        whole, possible = np.concatenate([*again.values()]), sum(len(mine[number]) - 1 for number in again)
        yield Repeats((*again,), whole, _log_patterns(possible, len(whole)), steps)


def _log_patterns(count: int, some: int) -> float:
    """Return log of (n + 1) binomial(n, s): any share of readings may repeat."""
    return math.log((count + 1) * math.comb(count, some))


def step_shown(values: NDArray[np.float64], most: float) -> float:
    """Return the step of a display, by the values (v,) that it showed, ascending.  most : where it showed one value

    The smallest difference, if the others are multiples of it but for their last digits; else that of these digits.
    """
    decimals = (digit * 10.0**-place for place in range(3, 12) for digit in (5, 2, 1))
    digits = next((each for each in decimals if _multiples(values, each, _ALIKE)), 0.0)
    if len(values) == 1:
        return min(digits, most)
    apart = np.diff(values)
    smallest = float(apart.min())
    return smallest if _multiples(apart, smallest, 2 * digits / smallest + _ALIKE) else digits


def _multiples(values: NDArray[np.float64], step: float, off: float) -> bool:
    return bool(np.all(np.abs(values / step - np.round(values / step)) < off))


def stuck(sought: Sought, repeated: Iterable[Repeats]) -> Iterator[Suspect]:
    """Yield the readings that an instrument was stuck at."""
    problem = sought.problem
    for each in repeated:
        again = np.isin(problem.reading, each.readings)
        if len(each.readings) < SEVERAL - 1 or not again.any() or again.all():
            continue
        pairs = zip(problem.setup[again].tolist(), problem.noise[again].tolist(), strict=True)
        steps = sum(math.log(max(each.steps[setup] / noise, _FINEST)) for setup, noise in pairs)
        log_rest = 0.5 * int(again.sum()) * math.log(2 * math.pi) - each.log_places - steps
        yield sought.without(Explained("stuck", 0.0, each.setups, int(each.readings.min())), log_rest, again)
