"""Fourth stage: where the stations stand that distances are read to, and about which machine readings are linear."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from axiscal.estimation.case import Case
from axiscal.estimation.intervals import sited
from axiscal.estimation.knowledge import Block, Knowledge, taken
from axiscal.estimation.promise.posterior import Sorted
from axiscal.estimation.promise.problem import problem
from axiscal.estimation.stations import GAUSSIAN, MOST, BentReadings, Optimum, indices, mirrored, polished
from axiscal.exceptions import AmbiguityError
from axiscal.language.spoken import said
from axiscal.measurement.cells import Cell
from axiscal.measurement.observation import About
from axiscal.measurement.reading import Reading, drawn, place_text
from axiscal.measurement.reading_rows import linear_values, places_of, seen
from axiscal.numerics import Array
from axiscal.units import to_unit
from axiscal_core.draws import as_stated
from axiscal_core.left_out import surprises
from axiscal_core.spaces import variances_of
from axiscal_core.theta import Sizes
from axiscal_core.threads import one_thread
from axiscal_core.unknowns import space_of


@dataclass(frozen=True, eq=False)
class Absorbed:
    """Readings as a case has them linear; what they make known is found once somebody asks.

    case : with the set-ups that were read from other sides than they say; left_out : readings that do not count
    among : cells whose rests are unknowns, None for all
    """

    case: Case
    readings: Sequence[Reading]
    left_out: frozenset[int]
    among: Collection[Cell] | None

    @cached_property
    @one_thread()
    def _taken(self) -> tuple[tuple[Block, ...], Knowledge]:
        return taken(self.case.knowledge, self.readings, self.left_out, self.among)

    @property
    def blocks(self) -> tuple[Block, ...]:
        """All readings, those left out as well."""
        return self._taken[0]

    @property
    def knowledge(self) -> Knowledge:
        """What is known after them."""
        return self._taken[1]

    @cached_property
    def normal(self) -> Sequence[Reading]:
        """The readings with normal ones in the place of those that are far from normal; themselves if none is."""
        return sited(self.case.observation, self.readings, self.case.inherited, self.left_out)

    @one_thread()
    def surprise(self, reading: int) -> float:
        """Return how far one that counts is from what all others say, its numbers together, in standard deviations."""
        kept = [index for index in range(len(self.readings)) if index not in self.left_out]
        some = [self.readings[index] for index in kept]
        posed = problem(self.case.observation, some, Sizes(()), self.case.inherited, usual=False)
        numbers = np.flatnonzero(posed.reading == kept.index(reading))
        given = as_stated(space_of(posed))
        return float(surprises(given.told(numbers)[0][None], given.blocks(numbers[None]))[0])


def absorbed(
    case: Case, readings: Sequence[Reading], left_out: Iterable[int] = (), among: Collection[Cell] | None = None
) -> Absorbed:
    """Return readings as a case has them linear.

    left_out : indices of those that do not count; among : cells whose rests are unknowns, None for all
    """
    other = {reading.setup for reading in readings if not case.came_as_allowed(reading)}
    widened = replace(case, both=case.both | other) if other else case  # sides that nobody said they allow
    return Absorbed(widened, readings, frozenset(left_out), among)


_ROUNDS = 12
_LINEAR = 1e-2
"""RMS over all directions, in σ, of what the exact machine would change: less is not worth a second round."""


def linear(case: Case, readings: Sequence[Reading], kept: Sorted) -> bool:
    """Return whether the machine that readings show changes none of them by as much as counts.

    It does not where ‖Δe/σ‖/√N, which is never less than what the mean would move by, is less than that.
    case : which does not bend, with the sizes as stated; kept : the readings without the bad ones
    """
    whole, observation, weighed = kept.problem, case.observation, kept.mine.found
    found = weighed.given[int(np.argmax(weighed.weights))]
    places = places_of(observation.setups, readings)
    there = replace(observation, about=About(found.without_causes().mean))
    change = linear_values(observation, places, readings) - linear_values(there, places, readings)
    counts = np.isin(whole.reading, kept.mine.problem.reading)
    squares = (change / whole.noise) ** 2 / variances_of(whole, found.theta)
    return bool(np.sum(squares[counts]) < _LINEAR**2 * whole.answered)


def located(known: Absorbed) -> Absorbed:
    """Return readings linearised about the machine and the stations that they show until these stay.

    A distance is linear about the assumed place of its station, so a better place makes a better estimate. Large errors
    of the machine also separate the exact chain from its rows. A round that asks for more than the one before goes half
    as far, and so do those after it: else the rounds would swing.
    known : with the sizes as learnt
    """
    return _followed(known, turned=False)


def bent(known: Absorbed) -> Absorbed:
    """Return readings with rows taken at the machine as it is believed, where those of the nominal one mislead."""
    about = known.case.about
    if about is None or float(np.max(indices(known.knowledge, known.readings), initial=0.0)) <= GAUSSIAN:
        return known
    return _followed(known, turned=True)


def _followed(known: Absorbed, *, turned: bool) -> Absorbed:
    """Return readings once they are linearised about what they show.  turned : rows are taken there, too"""
    share, last = 1.0, np.inf
    for _ in range(_ROUNDS):
        mean, about = known.knowledge.belief.mean, known.case.about
        asked = moved_by(known, known.case.linear_about(mean, turned))
        share, last = (share / 2 if asked > last else share), asked
        there = about is not None and about.bent == turned
        if asked < (SETTLED if there else 0.0 if turned else _LINEAR):
            better = None if turned else known.case.located(mean)
        else:
            better = known.case.linear_about(_towards(known.case, mean, share), turned)
        if better is None:
            break
        known = absorbed(better, known.readings, known.left_out, known.among)
    return known


def _towards(case: Case, mean: Array, share: float) -> Array:
    """Return a mean that is a share of the way from where readings are linearised now.  mean : (size,)"""
    count = case.errors.size + len(case.observation.unknowns)
    start = np.zeros(count) if case.about is None else case.about.point
    result = mean.copy()
    result[:count] = start + share * (mean[:count] - start)
    return result


def moved_by(known: Absorbed, better: Case) -> float:
    """Return by how much the mean moves when readings are linearised elsewhere, in σ, RMS over all directions.

    known : after readings as they are linearised now
    With S Sᵀ the covariance it is ‖Sᵀ Hᵀ R⁻¹ Δe‖/√N, and never more than ‖Δe/σ‖/√N.
    """
    readings = known.readings
    observation, belief = known.knowledge.observation, known.knowledge.belief
    numbers, there = seen(observation, readings), replace(observation, about=better.about)
    change = numbers.values - linear_values(there, places_of(observation.setups, readings), readings)
    trust = ~np.isin(numbers.reading, [*known.left_out]) / numbers.variances
    if float(np.sqrt(np.sum(trust * change**2) / belief.size)) < SETTLED:
        return 0.0
    pulled = belief.factor.T @ (numbers.rows.T @ (trust * change))
    return float(np.sqrt(np.mean(pulled**2)))


SETTLED = 1e-3
"""RMS of the change over all directions, in σ, at which rounds end."""


_NEAR, _APART = 6.0, 5.0
"""Optima within so much of the best one's log posterior, and so many standard deviations apart, are two."""


def refuse_mirrors(known: Absorbed, implausible: Collection[int]) -> None:
    """Raise AmbiguityError where a station's mirror image fits as well, with the reading that decides."""
    case = known.case
    kept = [reading for index, reading in enumerate(known.readings) if index not in implausible]
    size = case.errors.size + len(case.observation.unknowns)
    for index in filter(case.station_columns, range(len(case.description.setups))):
        images = mirrored(case, kept, known.knowledge.belief.mean[:size], index)
        for number, (columns, image) in enumerate(zip(case.station_columns(index), images, strict=False)):
            here = known.knowledge.belief.mean[list(columns)]
            spread = np.sqrt(np.diagonal(known.knowledge.belief.covariance)[list(columns)])
            if np.all(np.abs(image[list(columns)] - here) < _APART * spread):
                continue
            bent_ones = BentReadings(case, drawn(kept, MOST))
            best, other = (polished(bent_ones, start) for start in (known.knowledge.belief.mean[:size], image))
            apart = np.abs(best.point - other.point)[list(columns)] > _APART * spread
            if other.cost - best.cost < _NEAR and np.any(apart):
                raise _ambiguity(case, index, number, best, other)


def _ambiguity(case: Case, index: int, number: int, best: Optimum, other: Optimum) -> AmbiguityError:
    setup = case.description.setups[index]
    stated, columns = np.array(setup.standing[number]), list(case.station_columns(index)[number])
    spots = (to_unit(stated + each.point[columns], "mm").tolist() for each in (best, other))
    first, second = ("(" + ", ".join(f"{along:.1f}" for along in spot) + ") mm" for spot in spots)
    pose, differ = _decisive(case, index, number, best.point, other.point)
    axes, name = case.description.machine.axes, setup.name
    whose = said("station {number}", number=number + 1) if setup.stations else said("the station")
    what = '{whose} of "{name}" fits its readings as well at {first} as at {second} (x, y, z in the workpiece frame)'
    remedy = (
        'Read "{name}" at {place} as well: there the two differ by {apart:.3g} mm. '
        "Points in one plane cannot tell a station from its mirror image; or state the station nearer"
    )
    place, apart = place_text(axes, pose), to_unit(differ, "mm")
    return AmbiguityError(what, remedy, whose=whose, name=name, first=first, second=second, place=place, apart=apart)


def _decisive(case: Case, index: int, number: int, first: Array, second: Array) -> tuple[list[float], float]:
    """Return the place where the predictions of two optima differ the most, and by how much, m."""
    poses, sides = case.lattice.in_setup(index)
    one, two = (case.observation.shown(index, poses, sides, point)[:, number] for point in (first, second))
    best = int(np.argmax(np.abs(one - two)))
    return poses[best].tolist(), float(abs(one - two)[best])
