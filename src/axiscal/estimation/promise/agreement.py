"""Agreement of the readings with each other, and the mistake that explains a contradiction.

Each reading is left out and expected from the others: z² per number has mean 1, c² is its mean. With Q = yᵀK⁻¹y,
readings agree no better with probability p = Σ w P(χ²_m ≥ Q_θ). Bonferroni gives another p for the largest |z|. The
result prints twice the smaller of both. It is at most the binomial probability of as many bad ones, if more than a
fifth of the readings is left out, and 0 if all are. Below 0.001 the readings contradict.

Checks are readings at places drawn at random. A plan chooses its places, so that what these hide its own readings
cannot show; a random place hides nothing. With s² the mean z² of the checks, variances grow by max(1, s²).

The answer names a mistake with odds above 20 : 1, its prior of 1 % over all its places included. Exceptions: another
one is 20 times as likely, or the readings do not agree with it either. A jump is named where the readings agree, too: a
person may know of it. Where backlash explains it as well it is named unless backlash is 20 times as likely. p is at
most that of no mistake which is named.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from axiscal.estimation.promise.change_point import at_turns
from axiscal.estimation.promise.mistake import (
    ASKED,
    CONTRADICTS,
    DESCRIBED,
    LOG_BAD,
    LOG_NAMED,
    SEVERAL,
    Explained,
    Sought,
    Tried,
    explained,
    tail_of,
    weigh,
)
from axiscal.estimation.promise.slip import (
    FEWEST,
    Repeats,
    exchanges,
    larger_units,
    of_setup,
    quiet,
    shifted,
    signs,
    stuck,
)
from axiscal.numerics import Array
from axiscal_core.draws import Weighed
from axiscal_core.from_scipy import binomial_tail, chi_square_tail
from axiscal_core.left_out import BAD_SHARE, MOST_BAD
from axiscal_core.problem import Problem

AGREES = 3.0
"""Standard deviations within which a reading agrees with the others."""
Another = tuple[Explained, Problem]
"""A mistake, and the readings as a problem without it."""


@dataclass(frozen=True)
class Agreement:
    """count : readings that were compared; agreeing : those within three standard deviations of what others say

    c2 : c²; p : probability of readings that agree no better; explained : mistakes that are named, likeliest first
    described : what is described wrongly, where nothing explains the readings as well: nobody can accept it
    """

    count: int
    agreeing: int
    c2: float
    p: float
    explained: tuple[Explained, ...] = ()
    described: Explained | None = None

    @property
    def contradicts(self) -> bool:
        """Whether the readings contradict each other."""
        return self.p < CONTRADICTS

    @property
    def withheld(self) -> bool:
        """Whether no uncertainty may be printed: the readings contradict and no mistake explains it."""
        return self.contradicts and not self.explained

    @property
    def inflation(self) -> float:
        """c² where it is larger than chance allows, by which all variances grow; else 1."""
        return self.c2 if self.count and np.sqrt(self.c2) > 1 + 2 / np.sqrt(2 * self.count) else 1.0


NOTHING_READ = Agreement(0, 0, 1.0, 1.0)
"""Before the first reading nothing disagrees."""


class CheckReading(NamedTuple):
    """A check: its index, and how far it is from what is promised, in standard deviations.

    used : whether the estimate takes it; slip : it does not and s leaves it out
    """

    reading: int
    z: float
    used: bool = True
    slip: bool = False


@dataclass(frozen=True)
class Checks:
    """Checks beside what is promised of them, in the order of their readings."""

    each: tuple[CheckReading, ...] = ()

    @property
    def as_promised(self) -> int:
        """How many are used and within three standard deviations."""
        return sum(each.used and each.z <= AGREES for each in self.each)

    @property
    def s(self) -> float | None:
        """Root of the mean z² of those that are no slips; None of none."""
        squares = [each.z**2 for each in self.each if not each.slip]
        return float(np.sqrt(np.mean(squares))) if squares else None


def agreement(
    problem: Problem,
    found: Weighed,
    z: Array,
    left_out: int = 0,
    every: tuple[Problem, Weighed] | None = None,
    told: Iterable[Tried] = (),
    framed: Iterable[Another] = (),
    turned: Iterable[Another] = (),
) -> Agreement:
    """Return how readings agree.

    problem : of the readings that count; z : (r,) of each of them, left out; left_out : how many others do not count
    every : with the readings that are left out, where these are several
    told : mistakes that are weighed, whether the readings agree or not
    framed : with values of a set-up in the machine's frame; turned : if some axes count the other way; both made only
    where they may explain something
    """
    if not len(z):
        return Agreement(0, 0, 1.0, 0.0) if left_out else NOTHING_READ
    numbers, count = len(problem.values) / len(z), len(z)
    largest = count * chi_square_tail(numbers, float(np.max(z**2)) * numbers)
    p = min(1.0, 2 * min(tail_of(problem, found), largest))
    if left_out >= SEVERAL and left_out > MOST_BAD * (count + left_out):
        p = min(p, binomial_tail(left_out, count + left_out, BAD_SHARE))
    whole, weighed = every or (problem, found)
    stated, tried = chi_square_tail(len(whole.values), weighed.drawn.stated.misfit), [*told]
    mine = Sought.of(problem, found.drawn.stated)
    if stated < CONTRADICTS:  # sizes that are learnt hide another unit, and another frame
        tried += larger_units(whole, weighed)
        tried += weigh((mine.as_another(*each) for each in framed), found.log_evidence)
    if min(p, stated) < CONTRADICTS:  # the same of a sign: a square out by a sign is a large squareness
        tried += weigh(signs(mine), found.log_evidence)
    if p < CONTRADICTS:
        others = (mine.as_another(*each) for each in turned)
        tried += weigh([*exchanges(mine), *others], found.log_evidence)
    named = explained(tried)
    p = min([p, *(1 / (1 + each.odds) for each in named)])
    named = named if p < CONTRADICTS else [each for each in named if each.mistake in ASKED]
    described = named[0] if named and named[0].mistake in DESCRIBED else None
    others_named = () if described else tuple(each for each in named if each.mistake not in DESCRIBED)
    return Agreement(count, int(np.sum(z <= AGREES)), float(np.mean(z**2)), p, others_named, described)


def always_told(
    problem: Problem, found: Weighed, whole: Problem, repeated: Iterable[Repeats], turns: Collection[int] | None
) -> Iterator[Tried]:
    """Yield the mistakes that readings may tell although they agree.

    whole : with those that seem bad; repeated : what may be stuck; turns : readings before which a step is backlash,
    None where jumps are told already
    """
    right, sought = found.log_evidence, Sought.of(problem, found.drawn.stated)
    yield from weigh(() if turns is None else at_turns(sought, turns), right)
    yield from weigh(stuck(sought, repeated), right, LOG_NAMED)
    yield from weigh((each for setup, _ in sought.of_setups() for each in of_setup(sought, setup)), right)
    yield from quiet(problem, found)
    for setup, mine in sought.of_setups():
        among = whole.only((whole.setup == setup) | np.isin(whole.reading, problem.reading))
        bad = len(np.unique(among.reading)) - len(np.unique(problem.reading))
        if len(np.unique(problem.reading[mine])) >= FEWEST:
            yield from weigh(shifted(Sought.of(among) if bad else sought, setup), right + bad * LOG_BAD)
