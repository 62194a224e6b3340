"""What readings make known one after the other, at sizes that do not vary: B&H eq. 21-23 for all of them at once.

It is one linear problem of unknowns z ~ N(0, 1). Some hundred readings at a time condition them (`condition`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.estimation.accuracy.yardstick import Accuracy, Yardstick
from axiscal.estimation.case import Case, Knowledge
from axiscal.estimation.intervals import sited
from axiscal.estimation.promise.problem import problem
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import times_of
from axiscal.numerics import Array
from axiscal_core.normal import Normal, condition
from axiscal_core.problem import Problem, by_blocks
from axiscal_core.spaces import turned
from axiscal_core.theta import Sizes
from axiscal_core.threads import one_thread

AT_ONCE = 400
"""Products of matrices cost the least for some hundreds of readings at a time."""
_STATED = np.zeros(0)
"""θ of no size that varies."""


class Block(NamedTuple):
    """Readings that were taken together.

    surprise : (m, 2) what each number shows beyond what was foreseen, and the standard deviation of that, m or rad
    factor : F (errors, r) of what was known of the errors before them
    losses : (m, errors) what each number takes off the covariance, d dᵀ; ends : numbers up to the end of each reading
    """

    surprise: Array
    factor: Array
    losses: Array
    ends: NDArray[np.intp]


class Drift(NamedTuple):
    """The way of one zero: at times (k,) s its distance from where it stood at the first reading, m or rad.

    mean, std : (k,) after the readings; prior : (k,) the standard deviation before them
    """

    times: Array
    mean: Array
    std: Array
    prior: Array


@dataclass(frozen=True, eq=False)
class History:
    """Readings as a case has them linear, and what is known after each at its sizes, found once somebody asks.

    case : with the set-ups that were read from other sides than they say
    left_out : indices of readings that are foreseen and do not count
    """

    case: Case
    readings: Sequence[Reading]
    left_out: frozenset[int] = frozenset()

    @cached_property
    def normal(self) -> Sequence[Reading]:
        """The readings with normal ones in the place of those that are far from normal; themselves if none is."""
        if not any(setup.coarse for setup in self.case.observation.setups):
            return self.readings
        return sited(self.problem, self.rows, self.case.observation.setups, self.readings, self.left_out)

    @cached_property
    def problem(self) -> Problem:
        """All readings, those left out as well."""
        return problem(self.case.observation, self.readings, Sizes(()), self.case.inherited, usual=False)

    @cached_property
    def rows(self) -> Array:
        """The rows of all numbers over unknowns of variance one, (m, p), over the noise."""
        return turned(self.problem, self.problem.rows, _STATED, [each.roots(_STATED) for each in self.problem.curves])

    @cached_property
    @one_thread()
    def _conditioned(self) -> tuple[tuple[Block, ...], Array, Array]:
        """All readings, and root R (p, p) and mean (p,) of the unknowns after them."""
        posed, found = self.problem, list[Block]()
        root, mean = np.eye(posed.rows.shape[1]), np.zeros(posed.rows.shape[1])
        errors, counts = self.case.errors.size, ~np.isin(posed.reading, [*self.left_out])
        for start in range(0, len(self.readings), AT_ONCE):
            first, stop = np.searchsorted(posed.reading, [start, start + AT_ONCE])
            part, reading = slice(first, stop), posed.reading[first:stop]
            # numbers of one reading are foreseen from what was known before the first of them
            earlier = np.append(0, np.cumsum(counts[part]))[np.searchsorted(reading, reading)]
            noise = np.where(counts[part], 1.0, np.inf)
            done = condition(root, mean, self.rows[part], posed.values[part], noise, earlier)
            away = np.stack([posed.values[part] - done.expected, np.sqrt(done.variance + 1.0)], axis=1)
            own = self._raw(root)[:errors], self._raw(done.losses.T)[:errors].T.copy()
            ends = np.searchsorted(reading, np.arange(start, reading[-1] + 1), side="right")
            found.append(Block(away * posed.noise[part, None], *own, ends))
            root, mean = done.root, done.mean
        return tuple(found), root, mean

    def _raw(self, whitened: Array) -> Array:
        """Return errors and set-ups' unknowns of unknowns of variance one, (answered, ...) m and rad."""
        roots = [each.roots(_STATED) for each in self.problem.curves]
        return self.problem.raw(whitened[self.problem.first :], _STATED, roots)

    @property
    def root(self) -> Array:
        """R (p, p) with R Rᵀ the covariance of the unknowns of variance one after all readings."""
        return self._conditioned[1]

    @cached_property
    def surprises(self) -> Array:
        """What all numbers show beyond what was foreseen, and the standard deviation of that, (m, 2) m or rad."""
        return np.concatenate([np.zeros((0, 2)), *(block.surprise for block in self._conditioned[0])])

    def surprise(self, reading: int) -> float:
        """Return how far a reading is from what those before it say, RMS of its numbers, in standard deviations."""
        away, std = self.surprises[self.problem.reading == reading].T
        return float(np.sqrt(np.mean((away / std) ** 2)))

    def accuracies(self, yardstick: Yardstick) -> list[Accuracy]:
        """Return how well the machine was known after each reading."""
        each = (yardstick.accuracies(block.factor, block.losses, block.ends) for block in self._conditioned[0])
        return [accuracy for block in each for accuracy in block]

    @cached_property
    def knowledge(self) -> Knowledge:
        """What is known after the readings of errors, set-ups' unknowns and rests of visited cells."""
        posed, (_, root, mean), observation = self.problem, self._conditioned, self.case.observation
        cells = slice(posed.first_cell, posed.first_cell + len(posed.cells))
        both = np.column_stack([mean, root])
        own, rests = self._raw(both), by_blocks(both[cells].T, [each.T for each in posed.cell_roots]).T
        own[:, 0] += posed.mean
        whole = np.vstack([own, rests])
        opened = [(observation.with_rest.index(term), cell) for term, cell in posed.cells]
        return Knowledge(observation, Normal.of_factor(whole[:, 0], whole[:, 1:]), opened)

    def drifts(self, name: str) -> list[Drift]:
        """Return the way of each zero of a set-up at the times of its readings; none where no drift is stated."""
        setups, posed, (_, root, mean) = self.case.observation.setups, self.problem, self._conditioned
        index, found, count = next(i for i, s in enumerate(setups) if s.name == name), list[Drift](), len(posed.passing)
        mine, times = np.flatnonzero(posed.setup == index), times_of(self.readings)[posed.reading]
        part = mine - np.searchsorted(posed.reading, posed.reading[mine])
        for number in np.unique(part) if setups[index].drift > 0 else ():
            at, first = np.unique(times[mine[part == number]], return_index=True)
            zero = mine[part == number][first]
            rows = posed.rows[zero, :count] * posed.noise[zero, None]
            std, prior = (np.linalg.norm(each, axis=1) for each in (rows @ root[:count], rows))
            found.append(Drift(at, rows @ mean[:count], std, prior))
        return found
