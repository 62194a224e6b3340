"""Third stage: the posterior of errors, set-ups' unknowns and sizes, and the readings that are bad."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations

from axiscal.estimation.case import Case
from axiscal.estimation.judged import Doubt
from axiscal.estimation.promise.agreement import Turned
from axiscal.estimation.promise.posterior import Posterior, Sorted, sorted_out
from axiscal.estimation.promise.problem import problem
from axiscal.measurement.reading import Reading


@dataclass(frozen=True, eq=False, slots=True)
class Learnt:
    """case : with the sizes as learnt; doubts : the readings that others contradict, by index

    found : the posterior; None before the first reading
    """

    case: Case
    doubts: Mapping[int, Doubt] = field(default_factory=dict)
    found: Posterior | None = None

    @classmethod
    def of(cls, case: Case, kept: Sorted) -> Learnt:
        """Return what readings teach, their posterior still to come.  case : as stated"""
        return cls(case.rescaled(kept.sizes), {index: Doubt(index, each.z) for index, each in kept.bad.items()})


def posterior_of(case: Case, readings: Sequence[Reading], implausible: Collection[int]) -> Posterior:
    """Return the posterior of readings where a case has them linear.  case : with the sizes as stated"""
    return without_bad(case, readings, implausible).posterior(turned(case, readings))


def without_bad(case: Case, readings: Sequence[Reading], implausible: Collection[int]) -> Sorted:
    """Return the readings without the bad ones, where a case has them linear.  case : with the sizes as stated"""
    posed = problem(case.observation, readings, case.sizes, case.inherited, case.description.usual)
    return sorted_out(posed, implausible, [index for index, reading in enumerate(readings) if reading.accepted])


def turned(case: Case, readings: Sequence[Reading]) -> Iterator[Turned]:
    """Yield the readings as a problem for each choice of rotary axes that count the other way than described."""
    axes = [axis.name for axis in case.description.machine.axes if axis.rotary]
    for count in range(1, len(axes) + 1):
        for chosen in combinations(axes, count):
            there = case.turned(chosen)
            yield chosen, problem(there.observation, readings, case.sizes, case.inherited, case.description.usual)
