"""Many readings taken into a belief at once: the same as one after the other, and what was known after each."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from axiscal.accuracy.yardstick import Accuracy
from axiscal.belief import Belief, Innovations
from axiscal.estimate.case import Case
from axiscal.inference.numbers import seen_together, visited_together
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array

_TOGETHER = 400
"""Products of matrices cost the least for some hundreds of readings at a time."""


@dataclass(frozen=True, eq=False, slots=True)
class Block:
    """Readings that were taken together, and what they made of problem, map and belief.

    before : the belief before them, with their columns; losses : (m, size) what their numbers took off its covariance
    innovations : of each reading
    """

    problem: Case
    observation: Observation
    belief: Belief
    innovations: tuple[Innovations, ...]
    before: Belief
    losses: Array

    def accuracies(self) -> list[Accuracy]:
        """Return how well the machine was known after each reading."""
        ends = np.cumsum([each.degrees for each in self.innovations])
        return self.problem.yardstick.along(self.before, self.losses, ends)


def absorbed(
    problem: Case, observation: Observation, belief: Belief, readings: Sequence[Reading], weights: Sequence[float]
) -> Iterator[Block]:
    """Yield what readings make of a belief, some hundreds at a time.

    weights : how much each counts; 0 is predicted and not used
    """
    for case, start, stop in _parts(problem, readings):
        part = readings[start:stop]
        wider = visited_together(observation, part)
        before = belief.extended(observation.rest_variances(wider))
        block = _told(case, wider, before, part, np.array(weights[start:stop]))
        observation, belief = wider, block.belief
        yield block


def _told(
    problem: Case, observation: Observation, before: Belief, readings: Sequence[Reading], weights: Array
) -> Block:
    seen = seen_together(observation, readings)
    counts = [len(each.values) for each in seen]
    rows, noise, values = (np.concatenate([each[which] for each in seen]) for which in range(3))
    with np.errstate(divide="ignore"):
        used = noise / np.repeat(weights, counts)
    told = before.told(rows, values, noise, used, np.repeat(np.arange(len(seen)), counts))
    cuts = np.cumsum(counts)[:-1]
    pairs = zip(
        *(np.split(part, cuts) for part in (told.belief.innovations.value, told.belief.innovations.std)), strict=True
    )
    surprises = tuple(Innovations(value, std) for value, std in pairs)
    return Block(problem, observation, told.belief, surprises, before, told.losses)


def _parts(problem: Case, readings: Sequence[Reading]) -> Iterator[tuple[Case, int, int]]:
    """Yield the problem as it is after readings, and which, in parts through which it stays.

    It changes where a reading came from a side that its set-up does not allow.
    """
    start = 0
    for index, reading in enumerate(readings):
        after = widened(problem, reading)
        if index > start and (after is not problem or index - start == _TOGETHER):
            yield problem, start, index
            start = index
        problem = after
    if start < len(readings):
        yield problem, start, len(readings)


def widened(problem: Case, reading: Reading) -> Case:
    """Return the problem after a reading: it may have come from a side that nobody said its set-up allows."""
    if reading.setup in problem.both or problem.came_as_allowed(reading):
        return problem
    return replace(problem, both=problem.both | {reading.setup})
