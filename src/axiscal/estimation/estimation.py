"""The estimate of a machine from its readings: the last stage, and the questions that it answers."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from axiscal.estimation.accuracy.expanded import Expanded, expanded, reach
from axiscal.estimation.accuracy.yardstick import Accuracy
from axiscal.estimation.case import Case, Knowledge, Timed
from axiscal.estimation.functionals.asked import AskedRow, rows_served
from axiscal.estimation.history import History
from axiscal.estimation.judged import Doubt, objection
from axiscal.estimation.machine_estimate import Estimate, LeftUnknown, map_grid, rest_means, where_read
from axiscal.estimation.promise.agreement import NOTHING_READ, Agreement, CheckReading, Checks
from axiscal.estimation.promise.posterior import Posterior
from axiscal.estimation.stations import GAUSSIAN, MOST, indices
from axiscal.measurement.reading import Reading, drawn, reading_text
from axiscal.numerics.remembered import remembered
from axiscal_core.eigen import root_of
from axiscal_core.normal import Normal
from axiscal_core.threads import one_thread


@dataclass(frozen=True, eq=False)
class Estimation:
    """stated : the case as described; timed : the readings with their times

    implausible, bad : readings that cannot be, and those that others contradict, by index
    history : what is known after each reading at the sizes as learnt, of readings as they were shown
    posterior : of errors, set-ups and sizes; None before the first reading
    """

    stated: Case
    timed: Timed
    implausible: Mapping[int, Doubt]
    bad: Mapping[int, Doubt]
    history: History
    posterior: Posterior | None = None

    @property
    def case(self) -> Case:
        """The case with scales as learnt, and stations and sides as found."""
        return self.history.case

    @property
    def readings(self) -> tuple[Reading, ...]:
        """The readings, each with its time."""
        return self.timed.readings

    @property
    def outliers(self) -> tuple[Doubt, ...]:
        """The readings that are not believed, first those that cannot be, then those that others contradict."""
        return (*self.implausible.values(), *self.bad.values())

    @cached_property
    def knowledge(self) -> Knowledge:
        """What is known at the sizes as learnt, with normal readings in the place of those that are far from it."""
        known = self.history
        return known.knowledge if known.normal is known.readings else replace(known, readings=known.normal).knowledge

    @cached_property
    def printed(self) -> Knowledge:
        """Knowledge with the bands that are printed: sizes averaged over, variances as much larger as checks say."""
        found = self.posterior
        if found is None:
            return self.knowledge
        spread = self.widening * (found.covariance + found.covariance.T) / 2
        return Knowledge(self.case.observation, Normal.of_factor(found.mean, root_of(spread), found.degrees))

    @property
    def widening(self) -> float:
        """By what all variances grow: the larger of what checks and all readings say."""
        return max(self.agreement.inflation, (self.checks.s or 0.0) ** 2)

    @cached_property
    def of_readings(self) -> Normal:
        """What readings alone leave open: causes of type B, which none improves, are apart."""
        whole, found = self.printed.belief, self.posterior
        if found is None:
            return whole
        return Normal.of_factor(whole.mean, root_of(whole.covariance - self.widening * found.shared), whole.degrees)

    @cached_property
    @one_thread()
    def without_readings(self) -> Normal:
        """What would be known without the readings, at the sizes that they leave possible."""
        found, stated = self.posterior, self.case.prior
        if found is None:
            return stated
        covariance = self.widening * sum(drawn.without_readings() for drawn in found.draws)
        return Normal.of_factor(np.zeros(len(found.mean)), root_of(np.asarray(covariance)), found.degrees)

    @cached_property
    def accuracy(self) -> Accuracy:
        """How well the machine is known, with the bands that are printed."""
        return self.case.yardstick.measure(self.printed.belief)

    @property
    def left_out(self) -> frozenset[int]:
        """The indices of the readings that are not used."""
        return self.history.left_out

    @property
    def agreement(self) -> Agreement:
        """Whether the readings agree with each other."""
        return NOTHING_READ if self.posterior is None else self.posterior.agreement

    @cached_property
    def checks(self) -> Checks:
        """The check readings beside what all other readings promise of them.

        One bad check is a slip; two of a few (0.1 % of 5) are what the model lacks.
        """
        left = {} if self.posterior is None else self.posterior.left_out
        drawn = {i for i, reading in enumerate(self.readings) if reading.check}
        slip = len(drawn & {*self.bad}) == 1
        found = {i: CheckReading(i, each.z) for i, each in left.items()}
        found |= {i: CheckReading(i, each.surprise, False, slip) for i, each in self.bad.items()}
        found |= {i: CheckReading(i, each.surprise, False, True) for i, each in self.implausible.items()}
        return Checks(tuple(found[i] for i in sorted(drawn & {*found})))

    @remembered
    def estimate(self) -> Estimate:
        """Return what tables are made of: the belief about the machine, over the volume of the target."""
        description, errors, volume = self.case.description, self.case.errors, self.case.yardstick.volume
        grid = map_grid(description.machine, description.setups, self.readings)
        found = self.posterior
        rests = rest_means(errors, {} if found is None else found.cells)
        place = description.target.volume, grid, rests, volume.sample, volume.alignment, volume.counted
        used = [each for index, each in enumerate(self.readings) if index not in self.left_out]
        mounted = [(description.setup(each.setup), each.pose) for each in used]
        mounted += [(setup, setup.start) for setup, _ in mounted if setup.start is not None]
        read = where_read(description.machine, [(setup.moves, pose) for setup, pose in mounted])
        rows = rows_served(description, used)
        told = [pair for each in rows for pair in each.pairs(description.machine) if self._tells(each)]
        open_yet = self.of_readings.factor[: errors.size]
        limit = description.target.expanded or math.inf
        unknown = LeftUnknown(self.accuracy.rms, expanded_uncertainty(self).space, limit)
        told_by = read, frozenset(told), description.target.of_volume, open_yet, unknown
        return Estimate(errors, self.printed.belief, *place, *told_by)

    def _tells(self, asked: AskedRow) -> bool:
        """Return whether what is found of a row is more than readings leave open, 95 %, RMS over its places."""
        errors, belief = self.case.errors, self.of_readings
        if asked.map is None:
            return False
        found = asked.map.rows(errors) @ belief.mean[: errors.size]
        size = float(np.sqrt(np.mean(np.sum(found.reshape(-1, asked.map.dimensions) ** 2, axis=1))))
        return size > reach(asked.map.spectra(errors, belief.factor), belief.degrees)

    def objection_to(self, doubt: Doubt) -> str:
        """Return in words what is wrong with a reading that is not used."""
        reading, described = self.readings[doubt.reading], self.stated.description
        return objection(doubt, reading, described.setup(reading.setup), described.machine.axes)

    def name_of(self, index: int) -> str:
        """Return which reading it is that has this index among the readings: its number, set-up and place."""
        reading, described = self.readings[index], self.stated.description
        return reading_text(described.machine.axes, described.setup(reading.setup), reading, index)


@one_thread()
def expanded_uncertainty(known: Estimation) -> Expanded:
    """Return the expanded uncertainties of what readings made known: sizes averaged over."""
    return expanded(known.case.yardstick, known.printed.belief)


class Moment(NamedTuple):
    """The accuracy after a reading and its time in seconds.

    surprise : what its first number showed beyond what was foreseen, and the standard deviation of that; None before it
    """

    accuracy: Accuracy
    seconds: float
    surprise: tuple[float, float] | None = None


@one_thread()
def path(final: Estimation) -> list[Moment]:
    """Return what was known before the first reading, as stated, and after each, with the sizes known at the end.

    final : a concluded one. Its last figures are those of the posterior, with the sizes averaged over.
    """
    known, before = final.history, Moment(final.stated.yardstick.measure(final.stated.prior), 0.0)
    if not final.readings:
        return [before]
    found = [*known.accuracies(final.case.yardstick)[:-1], final.accuracy]
    firsts = np.searchsorted(known.problem.reading, np.arange(len(found)))
    surprises = ((away, std) for away, std in known.surprises[firsts].tolist())
    return [before, *(Moment(*each) for each in zip(found, final.timed.ends, surprises, strict=True))]


_ROUNDING = 1e-9
"""Of the noise: what is less is rounding."""


class Linearity(NamedTuple):
    """largest : the largest ν of a reading; reading : its number, None where nothing was read"""

    largest: float
    reading: int | None

    @property
    def gaussian(self) -> bool:
        """Whether the belief is the posterior to the digits printed."""
        return self.largest <= GAUSSIAN


@one_thread()
def linearity(estimation: Estimation) -> Linearity:
    """Return how linear the readings are, of many those of some."""
    some = drawn(estimation.readings, MOST)
    if not some:
        return Linearity(0.0, None)
    found = indices(estimation.history.knowledge, some)
    worst, largest = some[int(np.argmax(found))], float(found.max())
    return Linearity(largest if largest > _ROUNDING else 0.0, worst.numbered(estimation.readings.index(worst)))
