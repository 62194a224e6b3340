"""The mathematics of one campaign: the belief that follows its readings, what it is worth, and what to read next."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil

import numpy as np

from axiscal.belief import Belief, Innovations
from axiscal.campaign.description import CampaignDescription
from axiscal.campaign.engine import Engine, Visit
from axiscal.campaign.events import Gap, Place
from axiscal.design.accuracy import Accuracy, Yardstick
from axiscal.design.cost import visit_seconds
from axiscal.design.lattice import Lattice, spread
from axiscal.error_model.gauge import Hidden, hidden, unseen_factor
from axiscal.error_model.model import ErrorModel
from axiscal.error_model.volume import volume_moments
from axiscal.inference.doubt import FEWEST, Doubt, doubts
from axiscal.inference.fit import Fit, fit
from axiscal.inference.scales import Scale, Scales, all_scales, wanted_rests
from axiscal.measurement.instrument import INSTRUMENTS
from axiscal.measurement.instruments.distance import SHIFTS
from axiscal.measurement.observation import Observation, Seen
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup, Unknown, Vector
from axiscal.numerics import Array

_FEWEST, _MOST, _PER_UNKNOWN = 200, 1500, 4
_STAY = 0.1
_NEAR = 0.01
_GROWTH = 1.34
_ROUNDS = 12
_STAYS = 1e-8


def calibration_of(engine: Engine) -> Calibration:
    """Return the calibration behind a campaign, concluded from all its readings; raises TypeError for a foreign one."""
    if not isinstance(engine, Calibration):
        raise TypeError(f"{type(engine).__name__} is not a Calibration")
    return engine.concluded()


@dataclass(frozen=True, eq=False)
class Problem:
    """What does not change while measuring: the error model, the set-ups, and the yardstick of the volume."""

    description: CampaignDescription

    @cached_property
    def variable(self) -> tuple[Scale, ...]:
        """The scales that the description asks to be learnt."""
        machine, setups = self.description.machine, self.description.setups
        return all_scales(machine, setups) if self.description.scales_estimated else wanted_rests(machine)

    def rescaled(self, scales: Scales) -> Problem:
        """Return the problem with priors and noise as learnt."""
        machine, setups = scales.machine(self.description.machine), scales.setups(self.description.setups)
        return Problem(replace(self.description, machine=machine, setups=setups))

    def located(self, mean: Array) -> Problem | None:
        """Return the problem about the places where the stations of distances are found to be; None if these stay."""
        found = [self._found(index, mean) for index in range(len(self.description.setups))]
        if found == [setup.found for setup in self.description.setups]:
            return None
        pairs = zip(self.description.setups, found, strict=True)
        return Problem(replace(self.description, setups=tuple(replace(s, found=f) for s, f in pairs)))

    def _found(self, index: int, mean: Array) -> Vector | None:
        setup = self.description.setups[index]
        columns = dict(zip((u.name for u in setup.unknowns), mean[self.observation.unknowns_of(index)], strict=True))
        if not set(SHIFTS) & set(columns):
            return setup.found
        x, y, z = (float(columns.get(name, 0.0)) for name in SHIFTS)
        before = setup.found or (0.0, 0.0, 0.0)
        moved = max(abs(new - old) for new, old in zip((x, y, z), before, strict=True))
        return setup.found if moved < _STAYS else (x, y, z)

    @cached_property
    def errors(self) -> ErrorModel:
        """The error model of the machine."""
        return ErrorModel(self.description.machine)

    @cached_property
    def observation(self) -> Observation:
        """The map from all unknowns to readings, before any cell is visited."""
        return Observation(self.errors, self.description.setups)

    @cached_property
    def prior(self) -> Belief:
        """The belief before the first reading."""
        covariance = self.observation.prior_covariance()
        return Belief(np.zeros(len(covariance)), covariance)

    @cached_property
    def lattice(self) -> Lattice:
        """Candidates spread over everything that is allowed."""
        count = int(np.clip(_PER_UNKNOWN * self.observation.size, _FEWEST, _MOST))
        return spread(self.description.machine, self.description.setups, count)

    @cached_property
    def yardstick(self) -> Yardstick:
        """The figures over the target's volume."""
        box = self.description.target.volume
        unseen = unseen_factor(self.prior.factor, self._allowed_rows())[: self.errors.size]
        return Yardstick(self.errors, box, volume_moments(self.errors, box), unseen)

    @cached_property
    def hidden(self) -> tuple[Hidden, ...]:
        """What no allowed reading can see, in words."""
        return hidden(self.errors, self.yardstick.unseen, self.yardstick.moments)

    def unit_of(self, setup: Setup, unknown: Unknown) -> str:
        """Return the unit in which an unknown of a set-up is shown."""
        reads = INSTRUMENTS[setup.instrument].model.unknown_reads[unknown.name]
        return "um" if reads == "length" else "urad"

    def reading_unit(self, setup: Setup) -> str:
        """Return the unit in which readings of a set-up are shown."""
        return "um" if INSTRUMENTS[setup.instrument].reads == "length" else "urad"

    def index(self, setup: str) -> int:
        """Return the index of a set-up by name; raises DescriptionError."""
        return self.description.setups.index(self.description.setup(setup))

    def _allowed_rows(self) -> Array:
        parts = []
        for i in range(len(self.description.setups)):
            seen = self.observation.rows(i, *self.lattice.of(i))
            parts.append(seen.rows / np.sqrt(seen.variances)[:, None])
        return np.concatenate(parts)


class Calibration:
    """The belief of one campaign, fed its readings in their order.

    stated : the problem as described; whole : so many readings are all there will be
    Scales that are to be learnt are learnt anew as readings grow in number by a third, and from the last one. What is
    believed is worked out when it is asked for.
    """

    def __init__(self, stated: Problem, whole: int | None = None) -> None:
        self.stated, self._whole = stated, whole
        self._readings: list[Reading] = []
        self._learnt_from = 0
        self._doubts: tuple[Doubt, ...] = ()
        self._fit: Fit | None = None
        self._start(stated)

    @property
    def problem(self) -> Problem:
        """The problem as far as it has been learnt."""
        return self._settled()._problem

    @property
    def observation(self) -> Observation:
        """The map from all unknowns, those of visited cells included, to readings."""
        return self._settled()._observation

    @property
    def belief(self) -> Belief:
        """The belief after all readings."""
        return self._settled()._belief

    @property
    def innovations(self) -> list[Innovations]:
        """What each reading surprised by."""
        return self._settled()._innovations

    @property
    def doubts(self) -> tuple[Doubt, ...]:
        """The readings that the others do not believe."""
        return self._settled()._doubts

    @property
    def fit(self) -> Fit | None:
        """The scales as learnt, None where none were."""
        return self._settled()._fit

    @property
    def readings(self) -> tuple[Reading, ...]:
        """The readings absorbed, in their order."""
        return tuple(self._readings)

    def absorb(self, reading: Reading) -> None:
        """Take a reading into the belief; its innovation is kept."""
        self._readings.append(reading)

    def concluded(self) -> Calibration:
        """Return the calibration if no reading is to follow: bad readings found, scales learnt from all."""
        if self._whole == len(self._readings):
            return self
        whole = Calibration(self.stated, len(self._readings))
        whole._readings = list(self._readings)
        return whole

    def _start(self, problem: Problem) -> None:
        self._problem, self._observation, self._belief = problem, problem.observation, problem.prior
        self._innovations: list[Innovations] = []
        self._accuracy: Accuracy | None = None

    def _settled(self) -> Calibration:
        due = self._due()
        if due != self._learnt_from:
            self._learnt_from = due
            self._learn(self._readings[:due])
            self._locate()
        for index in range(len(self._innovations), len(self._readings)):
            self._take(index)
        return self

    def _due(self) -> int:
        """Return how many readings the scales are to be learnt from."""
        count, due = len(self._readings), 0
        if self._whole == count:
            return count
        while self.stated.variable and (following := max(FEWEST, ceil(due * _GROWTH))) <= count:
            due = following
        return due

    def _learn(self, readings: Sequence[Reading]) -> None:
        """Find bad readings and scales, and begin anew with them; scales first, for what stands out depends on them."""
        self._doubts, problem = doubts(self.stated.observation, readings), self.stated
        if self.stated.variable and len(readings) >= FEWEST:
            trusted = [r for i, r in enumerate(readings) if i not in {doubt.reading for doubt in self._doubts}]
            self._fit = fit(self.stated.observation, trusted, self.stated.variable)
            problem = self.stated.rescaled(self._fit.scales)
            self._doubts = doubts(problem.observation, readings)
        self._start(problem)

    def _locate(self) -> None:
        """Take all readings, and again about the places of stations that they show, until these stay."""
        for _ in range(_ROUNDS):
            problem = self._problem
            for index in range(len(self._innovations), len(self._readings)):
                self._take(index)
            located = problem.located(self._belief.mean)
            if located is None:
                return
            self._start(located)

    def _take(self, index: int) -> None:
        reading, weight = self._readings[index], 1.0
        for doubt in self._doubts:
            weight = doubt.weight if doubt.reading == index else weight
        wider = self._observation.visited(np.array(reading.pose), self._problem.index(reading.setup))
        belief = self._belief.extended(self._observation.rest_variances(wider))
        self._observation, self._accuracy = wider, None
        seen = self._observation.reading(reading)
        expected = belief.predict(seen.rows)
        surprise = Innovations(seen.values - expected.mean, np.hypot(expected.std, np.sqrt(seen.variances)))
        self._innovations.append(surprise)  # at its full weight: that it surprised is to be seen
        self._belief = belief.update(seen.rows, seen.values, seen.variances / weight)

    def rows_of(self, reading: Reading) -> Seen:
        """Return what a reading sees, its variances and values."""
        return self._settled()._observation.reading(reading)

    def accuracy(self) -> Accuracy:
        """Return how well the machine is known now."""
        settled = self._settled()
        if settled._accuracy is None:
            settled._accuracy = settled._problem.yardstick.measure(settled._belief)
        return settled._accuracy

    def plan(self, gaps: Sequence[Gap], visits: Sequence[Visit]) -> tuple[Place, ...]:
        """Return the readings to come, none of the gaps, in the order of a short way."""
        from axiscal.campaign.planning import planned_places

        return planned_places(self, gaps, visits)

    def elapsed(self, visits: Sequence[Visit]) -> float:
        """Return the seconds that these visits take in this order: mounting, travel, settling, reading."""
        total, before = 0.0, None
        for visit in visits:
            setup = self.problem.description.setup(visit.setup)
            start = np.array(before.pose) if before is not None and before.setup == visit.setup else None
            total += visit_seconds(self.problem.description.machine, setup, start, np.array(visit.pose))
            before = visit
        return total
