"""The mathematics of one campaign: the belief that follows its readings, what it is worth, and what to read next."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import ceil

import numpy as np

from axiscal.accuracy.yardstick import Accuracy
from axiscal.belief import Belief, Innovations
from axiscal.estimate.case import Case
from axiscal.estimate.knowledge import Block, Knowledge
from axiscal.estimate.machine_estimate import Estimate
from axiscal.estimate.map_grid import map_grid
from axiscal.estimate.updating import absorbed, widened
from axiscal.inference.fit import Fit, fit
from axiscal.inference.implausible import Plausibility, nearest_first, objection
from axiscal.inference.outliers import FEWEST, NOTHING, Doubt, Verdict, verdict
from axiscal.measurement.instrument import INSTRUMENTS
from axiscal.measurement.observation import Observation
from axiscal.measurement.place import Place
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import Seen, seen, visited_by
from axiscal.numerics.threads import one_thread

_GROWTH = 1.34
_ROUNDS = 12
_LEARNABLE = 4.0
"""So many times larger than stated an error may be where its std is to be learnt."""
_TRIMMED = 0.1
_MANY = 16
"""Fewer readings are taken one by one: as fast, and a campaign that is measured goes on where it was."""
_AHEAD = 64
"""So many are taken before it is looked whether one of them surprises."""
_SURPRISING = 2.0
"""Standard deviations from which a new reading makes all be looked at: one in twenty does by chance."""


class Calibration:
    """The belief of one campaign, fed its readings in their order.

    stated : the problem as described; whole : so many readings are all there will be
    Scales that are to be learnt are learnt anew as readings grow in number by a third, and from the last one. What is
    believed is worked out when it is asked for.
    """

    def __init__(self, stated: Case, whole: int | None = None) -> None:
        self.stated, self._whole = stated, whole
        self._readings: list[Reading] = []
        self._seconds = 0.0
        self._learnt_from = 0
        self._trusted, self._hindsight = Verdict((), ()), False
        self._fit: Fit | None = None
        self._plausibility, self._implausible = self._fresh_plausibility(), dict[int, Doubt]()
        self._start(stated)

    @property
    def problem(self) -> Case:
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
        """The readings that are not believed: first the implausible ones, then those that the others contradict."""
        settled = self._settled()
        return (*settled._implausible.values(), *settled._trusted.doubts)

    @property
    def fit(self) -> Fit | None:
        """The scales as learnt, None where none were."""
        return self._settled()._fit

    @property
    def readings(self) -> tuple[Reading, ...]:
        """The readings absorbed, in their order, each with its time."""
        return tuple(self._readings)

    @property
    def seconds(self) -> float:
        """The seconds that the readings take in this order: mounting, travel, settling, reading."""
        return self._seconds

    def absorb(self, reading: Reading) -> None:
        """Take a reading into the belief; its innovation is kept.

        Where no clock was looked at it was taken when the plan has it.
        """
        before = self._readings[-1] if self._readings else None
        self._seconds += self.stated.seconds_of(before, reading)
        self._readings.append(reading if reading.time is not None else replace(reading, time=self._seconds))

    def concluded(self) -> Calibration:
        """Return the calibration if no reading is to follow: bad readings found, scales learnt from all."""
        if self._whole == len(self._readings):
            return self
        return self._with(self._readings)

    def replay(self) -> Calibration:
        """Return a calibration before its first reading that is to be fed the same readings again, one after the other.

        It knows from the beginning which readings are bad; scales it learns as they come.
        """
        settled = self._settled()
        moved = settled._problem.description.setups != self.stated.description.setups
        again = Calibration(self.stated, len(self._readings) if moved or self.stated.variable else None)
        again._trusted, again._implausible, again._hindsight = settled._trusted, dict(settled._implausible), True
        return again

    def undisturbed(self, most: int) -> int:
        """Return how many of so many readings to come would be taken with the scales as they are."""
        count = len(self._readings)
        return next((n for n in range(most) if self._due(count + n + 1) != self._learnt_from), most)

    @one_thread()
    def known_after_each(self) -> list[Accuracy]:
        """Return what is known after each reading that this replay has absorbed since; none disturbs its scales."""
        known = list[Accuracy]()
        for case, part in self._parts(len(self._readings)):
            known += part.accuracies(case.yardstick)
            self._keep(case, part)
        return known

    def _with(self, readings: Sequence[Reading]) -> Calibration:
        whole = Calibration(self.stated, len(readings))
        for reading in readings:
            whole.absorb(reading)
        return whole

    def _start(self, problem: Case) -> None:
        self._problem, self._observation, self._belief = problem, problem.observation, problem.prior
        self._innovations: list[Innovations] = []
        self._accuracy: Accuracy | None = None

    def _fresh_plausibility(self) -> Plausibility:
        stated = self.stated
        mean = np.zeros(stated.errors.size) if stated.inherited is None else stated.inherited.mean
        slack = _LEARNABLE if stated.description.scales_estimated else 1.0
        return Plausibility(stated.observation, stated.errors.prior_covariance(), mean, slack)

    @one_thread()
    def _settled(self) -> Calibration:
        due = self._due(len(self._readings))
        if due != self._learnt_from:
            self._learnt_from = due
            self._learn(self._readings[:due])
            self._locate()
        self._take_all()
        return self

    def _take_all(self) -> None:
        self._judge()
        count = len(self._readings)
        looked_at = count if self._hindsight else self._learnt_from
        while (start := len(self._innovations)) < count:
            ahead = start + (_AHEAD if count - start >= _MANY else 1)
            self._take_up_to(looked_at if start < looked_at else min(ahead, count))
            self._review(max(start, looked_at))

    def _take_up_to(self, stop: int) -> None:
        """Take readings up to one of them, many of them together."""
        if stop - len(self._innovations) >= _MANY:
            for case, part in self._parts(stop):
                self._keep(case, part)
        while (index := len(self._innovations)) < stop:
            self._take(index)

    def _parts(self, stop: int) -> Iterator[tuple[Case, Block]]:
        start = len(self._innovations)
        weights = [self._weight(index) for index in range(start, stop)]
        return absorbed(self._problem, Knowledge(self._observation, self._belief), self._readings[start:stop], weights)

    def _keep(self, case: Case, part: Block) -> None:
        self._problem, self._observation, self._belief = case, part.after.observation, part.after.belief
        self._innovations += part.innovations
        self._accuracy = None

    def _review(self, start: int) -> None:
        """Look for bad readings where one of those taken since surprises: it may be bad, or show another.

        start : the first ones have been looked at; those that come after one that changes a verdict are taken anew
        """
        for count in range(start + 1, len(self._innovations) + 1):
            if np.sqrt(self._innovations[count - 1].chi_square) < _SURPRISING:
                continue
            found = self._verdict(self._problem, self._readings[:count])
            if found.fates != self._trusted.fates:
                self._trusted = found
                self._start(self._problem)
                self._take_up_to(count)
                return

    def _judge(self) -> None:
        """Find the implausible among new readings: as they come, or, if they are all there, the nearest first."""
        if self._hindsight:
            return
        judged, start = self._plausibility, len(self._plausibility.sizes)
        if self._whole == len(self._readings) and start == 0:
            order = nearest_first(self._readings)
            sizes, limit = judged.take([self._readings[index] for index in order]), judged.limit
            self._note({i: size for i, size in sorted(zip(order, sizes, strict=True)) if size > limit})
        for index in range(len(judged.sizes), len(self._readings)):
            (size,) = judged.take([self._readings[index]])
            self._note({index: size} if size > judged.limit else {})

    def _note(self, sizes: dict[int, float]) -> None:
        for index, size in sizes.items():
            if not self._readings[index].accepted:
                self._implausible[index] = Doubt(index, size, NOTHING, True)

    def _due(self, count: int) -> int:
        """Return how many of the first readings the scales are to be learnt from."""
        due = 0
        if self._whole == count:
            return count
        while self.stated.variable and (following := max(FEWEST, ceil(due * _GROWTH))) <= count:
            due = following
        return due

    def _learn(self, readings: Sequence[Reading]) -> None:
        """Find bad readings and scales, and begin anew with them; scales first, for what stands out depends on them."""
        self._start(self.stated)
        if self._whole == len(self._readings) and not self._hindsight:  # all together, the nearest first
            self._plausibility, self._implausible = self._fresh_plausibility(), {}
        self._judge()
        problem, found = self.stated, self._verdict(self.stated, readings)
        doubtful = {*self._implausible, *(doubt.reading for doubt in found.doubts)}
        trusted = [reading for index, reading in enumerate(readings) if index not in doubtful]
        if problem.variable and len(readings) - len(self._implausible) >= FEWEST:
            self._fit = fit(problem.observation, trusted, problem.variable, problem.inherited)
            problem = problem.rescaled(self._fit.scales)
            found = self._verdict(problem, readings)
        self._trusted = found
        self._start(problem)

    def _verdict(self, problem: Case, readings: Sequence[Reading]) -> Verdict:
        """Return how much each of the first readings counts, implausible ones apart."""
        kept = [index for index in range(len(readings)) if index not in self._implausible]
        found, weights = verdict(problem.observation, [readings[index] for index in kept], problem.inherited)
        of_all = np.ones(len(readings))
        of_all[kept] = weights
        return Verdict(tuple(doubt._replace(reading=kept[doubt.reading]) for doubt in found), tuple(of_all.tolist()))

    def _locate(self) -> None:
        """Take all readings, and again about the places of stations that they show, until these stay."""
        for _ in range(_ROUNDS):
            problem = self._problem
            self._take_all()
            located = problem.located(self._belief.mean)
            if located is None:
                return
            self._start(located)

    def _take(self, index: int) -> None:
        reading, weight = self._readings[index], self._weight(index)
        wider = visited_by(self._observation, [reading])
        belief = self._belief.extended(self._observation.rest_variances(wider))
        self._observation, self._accuracy = wider, None
        numbers = seen(self._observation, [reading])
        expected = belief.predict(numbers.rows)
        surprise = Innovations(numbers.values - expected.mean, np.hypot(expected.std, np.sqrt(numbers.variances)))
        self._innovations.append(surprise)  # at its full weight: that it surprised is to be seen
        self._belief = belief.update(numbers.rows, numbers.values, numbers.variances / weight) if weight else belief
        self._problem = widened(self._problem, reading)

    def _weight(self, index: int) -> float:
        """Return how much a reading counts: nothing if it is implausible, for such a value may be of any size."""
        weights = self._trusted.weights
        return 0.0 if index in self._implausible else weights[index] if index < len(weights) else 1.0

    def misfit(self) -> float:
        """Return how many times as much as the model says the readings scatter about their predictions.

        The root mean square of the standardised innovations without the largest tenth; implausible readings apart.
        """
        settled = self._settled()
        believed = [each for i, each in enumerate(settled._innovations) if i not in settled._implausible]
        if len(believed) < FEWEST:
            return 1.0
        sizes = np.sort([np.sqrt(each.chi_square / each.degrees) for each in believed])
        return float(np.sqrt(np.mean(sizes[: len(sizes) - ceil(_TRIMMED * len(sizes))] ** 2)))

    def objection(self) -> str | None:
        """Return why the last reading cannot be, in words; None where it can."""
        doubt = self._settled()._implausible.get(len(self._readings) - 1)
        return None if doubt is None else self.objection_to(doubt)

    def implausible(self, readings: Sequence[Reading]) -> tuple[Doubt, ...]:
        """Return those of readings that are all there are which cannot be."""
        whole = self._with(readings)
        whole._judge()
        return tuple(whole._implausible.values())

    def objection_to(self, doubt: Doubt) -> str:
        """Return in words what an implausible reading is."""
        reading = self._readings[doubt.reading]
        return objection(doubt, reading, self.stated.description.setup(reading.setup))

    @one_thread()
    def rows_of(self, readings: Sequence[Reading]) -> Seen:
        """Return what readings see, their variances and values."""
        return seen(self._settled()._observation, readings)

    @one_thread()
    def accuracy(self) -> Accuracy:
        """Return how well the machine is known now."""
        settled = self._settled()
        if settled._accuracy is None:
            settled._accuracy = settled._problem.yardstick.measure(settled._belief)
        return settled._accuracy

    def promised(self, places: Sequence[Place]) -> Accuracy:
        """Return how well the machine would be known after readings at these places, whatever they showed."""
        values = {setup.name: INSTRUMENTS[setup.instrument].values for setup in self.stated.description.setups}
        readings = [Reading(p.setup, p.pose, p.approach, 0.0, others=(0.0,) * (values[p.setup] - 1)) for p in places]
        after = Knowledge(self.observation, self.belief).read(readings)
        return self.problem.yardstick.measure(after.belief)

    def estimate(self) -> Estimate:
        """Return what tables are made of: the belief about the machine, over the volume of the target."""
        settled = self._settled()
        problem = settled._problem
        grid = map_grid(problem.errors.machine, problem.description.setups, self._readings)
        return Estimate(problem.errors, settled._belief, problem.description.target.volume, grid)

    @property
    def learnt_from(self) -> int:
        """The number of readings that scales were learnt from."""
        return self._settled()._learnt_from

    def elapsed(self, places: Sequence[Place]) -> float:
        """Return the seconds that readings at these places take in this order: mounting, travel, settling, reading."""
        total, known = 0.0, 0
        before: Place | Reading | None = None
        if self._readings and self._begins_with_readings(places):
            total, before, known = self._seconds, self._readings[-1], len(self._readings)
        for place in places[known:]:
            total += self.stated.seconds_of(before, place)
            before = place
        return total

    def _begins_with_readings(self, places: Sequence[Place]) -> bool:
        count = len(self._readings)
        pairs = zip(places, self._readings, strict=False)
        return len(places) >= count and all(v.setup == r.setup and v.pose == r.pose for v, r in pairs)
