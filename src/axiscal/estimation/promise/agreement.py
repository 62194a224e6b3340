"""Agreement of the readings with each other, and the mistake that explains a contradiction.

Each reading is left out and expected from the others: z² per number has mean 1, c² is its mean. With Q = yᵀK⁻¹y,
readings agree no better with probability p = Σ w P(χ²_m ≥ Q_θ). Bonferroni gives another p for the largest |z|. The
result prints twice the smaller of both. It is at most the binomial probability of as many bad ones, if more than a
fifth of the readings is left out, and 0 if all are. Below 0.001 the readings contradict. A mistake does one of these:
- It turns y into y' = T y: values with the wrong sign, two set-ups swapped, places shifted by one, another unit from
  some reading on, values along the machine's x, y, z instead of the workpiece's. Sizes that are learnt hide the last
  two, so these are sought at the sizes as stated.
- It turns K into that of a machine with an axis that counts the other way.
- It adds columns: a zero that jumps, as `jumps` finds it.
- It takes rows away: an instrument that is stuck, as `sick` finds it.

    gain = ½ (yᵀK⁻¹y − y'ᵀK⁻¹y') + log |det T|

Checks are readings at places drawn at random. A plan chooses its places, so that what these hide its own readings
cannot show; a random place hides nothing. With s² the mean z² of the checks, variances grow by max(1, s²).

The answer names a mistake with odds above 20 : 1, its prior of 1 % over all its places included. Exceptions: another
one is 20 times as likely, or the readings do not agree with it either. A jump is named where the readings agree, too: a
person may know of it. Where backlash explains it as well it is named unless backlash is 20 times as likely. p is at
most that of no mistake which is named.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.numerics import Array
from axiscal_core.draws import Weighed, sized
from axiscal_core.from_scipy import binomial_tail, chi_square_tail
from axiscal_core.left_out import BAD_SHARE, MOST_BAD
from axiscal_core.problem import Problem
from axiscal_core.spaces import sums_of
from axiscal_core.unknowns import space_of

CONTRADICTS = 0.001
"""Probability below which readings contradict."""
AGREES = 3.0
"""Standard deviations within which a reading agrees with the others."""
NAMED = 20.0
"""Odds from which a mistake is named, and beside the likeliest one left unnamed."""
SEVERAL = 3
"""One or two bad readings are bad readings, of however few."""
PRIOR = 0.01
"""Assumption: one campaign in a hundred has such a mistake."""
_LARGEST = 600.0
"""Logarithm of the largest odds that are said: beyond it floats end."""
INCH = 25.4
"""mm, by definition."""
_FACTORS = (1000.0, 1 / 1000.0, INCH, 1 / INCH)
"""By definition: mm for um, and inches for mm."""

Mistake = Literal[
    "jump",
    "sign",
    "unit",
    "swapped",
    "shifted",
    "stuck",
    "frame",
    "direction",
    "place",
    "sides",
    "mirrored",
    "still",
    "noise",
]
ASKED = ("jump", "stuck", "sign", "sides", "mirrored", "shifted", "still")
"""Mistakes that a person is asked about where the readings agree."""
_DESCRIBED = ("direction", "place", "still", "noise")
"""Mistakes of a file, not of readings."""

Turned = tuple[tuple[str, ...], Problem]
"""Names of axes, and the readings as a problem if these count the other way."""
Framed = tuple[int, Problem]
"""A set-up, and the readings as a problem if its values are along the machine's x, y, z, which do not turn with it."""


class Explained(NamedTuple):
    """A mistake that explains readings that contradict.

    log_odds : beside no mistake; setups : whose readings
    reading : index of the first that is wrong, −1 for all; last : of the last one, −1 for all later ones
    factor : by which values are too large or too small, for a unit; axes : that count the other way
    backlash, detail : explain a jump as well: it is where the axis turned, or over a plane
    """

    mistake: Mistake
    log_odds: float
    setups: tuple[int, ...]
    reading: int = -1
    factor: float = 1.0
    axes: tuple[str, ...] = ()
    backlash: bool = False
    last: int = -1
    detail: bool = False

    @property
    def least(self) -> float:
        """Logarithm of the odds from which it is named."""
        return 0.0 if self.detail else float(-np.log(NAMED) if self.backlash else np.log(NAMED))

    @property
    def odds(self) -> float:
        """Beside no mistake."""
        return float(np.exp(min(self.log_odds, _LARGEST)))


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
    """Checks beside what is promised of them."""

    each: tuple[CheckReading, ...] = ()

    @classmethod
    def sorted_out(cls, *kinds: Iterable[CheckReading]) -> Checks:
        """Return checks by their readings.  kinds : used, bad, implausible

        One bad check is a slip; two of a few (0.1 % of 5) are what the model lacks.
        """
        used, bad, implausible = (list(each) for each in kinds)
        bad = [each._replace(used=False, slip=len(bad) == 1) for each in bad]
        return cls(tuple(sorted([*used, *bad, *(each._replace(used=False, slip=True) for each in implausible)])))

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
    turned: Iterable[Turned] = (),
    framed: Iterable[Framed] = (),
    every: tuple[Problem, Weighed] | None = None,
    told: Sequence[Tried] = (),
) -> Agreement:
    """Return how readings agree.

    problem : of the readings that count; z : (r,) of each of them, left out; left_out : how many others do not count
    turned : the same problem if some axes count the other way; made only where the readings contradict
    framed : the same problem if values of a set-up are in the machine's frame; made only where sizes as stated do
    every : with the readings that are left out, where these are several
    told : jumps that readings tell, and what an instrument was stuck at
    """
    count = len(z)
    if not count:
        return Agreement(0, 0, 1.0, 0.0) if left_out else NOTHING_READ
    numbers = len(problem.values) / count
    largest = count * chi_square_tail(numbers, float(np.max(z**2)) * numbers)
    p = min(1.0, 2 * min(tail_of(problem, found), largest))
    if left_out >= SEVERAL and left_out > MOST_BAD * (count + left_out):
        p = min(p, binomial_tail(left_out, count + left_out, BAD_SHARE))
    whole, weighed = every or (problem, found)
    stated = chi_square_tail(len(whole.values), weighed.drawn.stated.misfit)
    tried = [*told]
    if stated < CONTRADICTS:  # sizes that are learnt hide another unit, and another frame
        tried += [*_units(whole, weighed), *_in_frames(problem, found, framed)]
    if min(p, stated) < CONTRADICTS:  # the same of a sign: a square out by a sign is a large squareness
        tried += _turned(problem, found, every=p < CONTRADICTS)
    if p < CONTRADICTS:
        tried += _against(problem, found, turned)
    named = _explained(tried) if tried else []
    p = min([p, *(1 / (1 + each.odds) for each in named)])
    named = named if p < CONTRADICTS else [each for each in named if each.mistake in ASKED]
    of_file = _DESCRIBED if p < CONTRADICTS else ()
    described = named[0] if named and named[0].mistake in of_file else None
    explained = () if described else tuple(each for each in named if each.mistake not in of_file)
    return Agreement(count, int(np.sum(z <= AGREES)), float(np.mean(z**2)), p, explained, described)


def tail_of(problem: Problem, found: Weighed) -> float:
    """Return how probable readings are that agree no better, Σ w P(χ²_m ≥ Q_θ)."""
    tails = [chi_square_tail(len(problem.values), given.misfit) for given in found.given]
    return float(found.weights @ np.array(tails))


class Tried(NamedTuple):
    """A mistake, with the probability of readings that agree no better with it."""

    mistake: Explained
    p: float

    @classmethod
    def of(cls, mistake: Explained, prior: float, without: Problem) -> Tried:
        """Return a mistake without which readings are as a problem has them, sizes integrated out.

        prior : log odds but for their evidence
        """
        found = sized(without)
        return cls(mistake._replace(log_odds=prior + found.log_evidence), tail_of(without, found))


def _explained(tried: Iterable[Tried]) -> list[Explained]:
    """Return the mistakes with which readings agree, at odds to be named and within 20 : 1 of the best."""
    each = sorted(tried, key=lambda one: -one.mistake.log_odds)
    near = each[0].mistake.log_odds - np.log(NAMED)
    likely = [
        one.mistake for one in each if one.mistake.log_odds > max(one.mistake.least, near) and 2 * one.p >= CONTRADICTS
    ]
    first = {(one.mistake, one.setups): one for one in reversed(likely)}
    return [one for one in likely if first[one.mistake, one.setups] is one]


def _tried(problem: Problem, found: Weighed, gains: Array, squares: Array, mistake: Explained) -> Tried:
    """Return a mistake that is tried at all draws, with its log odds, 1 % before any reading, the sizes integrated out.

    gains, squares : (d,) gain of log L, taken off yᵀK⁻¹y
    """
    weights = found.weights * np.exp(gains - gains.max())
    odds = float(np.log(PRIOR * weights.sum()) + gains.max())
    left = [given.misfit - float(square) for given, square in zip(found.given, squares, strict=True)]
    tails = np.array([chi_square_tail(len(problem.values), square) for square in left])
    return Tried(mistake._replace(log_odds=odds), float(weights @ tails / weights.sum()))


def _units(problem: Problem, found: Weighed) -> Iterator[Tried]:
    """Yield the likeliest reading from which on a set-up has another unit, at the sizes as stated, where that fits."""
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
        for factor in _FACTORS:
            over = 1 - 1 / factor
            squares = given.misfit - 2 * over * pulled + over**2 * fisher
            gains = (given.misfit - squares) / 2 - since * np.log(factor) - np.log(places)
            best = int(np.argmax(gains))
            odds = float(np.log(PRIOR) + found.log_stated + gains[best])
            tail = chi_square_tail(len(problem.values), float(squares[best]))
            # Divided by enough all readings agree, and then by far too well.
            if 2 * (p := min(tail, 1 - tail)) >= CONTRADICTS:
                yield Tried(Explained("unit", odds, (int(setup),), int(readings[best]) if best else -1, factor), p)


def _in_frames(problem: Problem, found: Weighed, framed: Iterable[Framed]) -> Iterator[Tried]:
    """Yield the set-ups whose values are along the machine's x, y, z, at the sizes as stated: |det T| = 1."""
    given = found.drawn.stated
    for setup, other in framed:
        square = float(other.values @ given.precision(other.values[:, None])[:, 0])
        odds = float(np.log(PRIOR) + found.log_stated + (given.square - square) / 2)
        yield Tried(Explained("frame", odds, (setup,)), chi_square_tail(len(other.values), square))


def _turned(problem: Problem, found: Weighed, *, every: bool = True) -> Iterator[Tried]:
    """Yield the mistakes that change the values themselves.  every : also those that nobody is asked about"""
    for mistake, setups, values, factor in _other_values(problem):
        if not every and mistake not in ASKED:
            continue
        squares = np.array([given.misfit - given.misfit_of(values) for given in found.given])
        yield _tried(problem, found, 0.5 * squares, squares, Explained(mistake, 0.0, setups, factor=factor))


def _against(problem: Problem, found: Weighed, turned: Iterable[Turned]) -> Iterator[Tried]:
    """Yield that some axes count the other way than described."""
    for axes, other in turned:
        space, gains, squares = space_of(other), np.full(len(found.given), -np.inf), np.zeros(len(found.given))
        for draw, given in enumerate(found.given):
            if (there := space.given(found.thetas[draw])) is not None:
                gains[draw], squares[draw] = there.density - given.density, given.misfit - there.misfit
        yield _tried(problem, found, gains, squares, Explained("direction", 0.0, (), axes=axes))


def _other_values(problem: Problem) -> Iterator[tuple[Mistake, tuple[int, ...], Array, float]]:
    """Yield what the values were without each mistake, with the factor."""
    setups = np.unique(problem.setup).tolist()
    values = problem.values * problem.noise
    for setup in setups:
        mine = problem.setup == setup
        yield "sign", (setup,), np.where(mine, -values, values) / problem.noise, -1.0
    for first in range(len(setups)):
        for second in range(first + 1, len(setups)):
            one, other = (np.flatnonzero(problem.setup == setups[i]) for i in (first, second))
            if len(one) == len(other):
                swapped = values.copy()
                swapped[one], swapped[other] = values[other], values[one]
                yield "swapped", (setups[first], setups[second]), swapped / problem.noise, 1.0


def numbers_of_one(reading: NDArray[np.intp]) -> int:
    """Return how many numbers a reading of a set-up has."""
    return int(np.sum(reading == reading[0]))
