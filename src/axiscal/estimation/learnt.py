"""Readings as a problem, as they were read and as they would be if they were read otherwise than said."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations

from axiscal.estimation.case import Case
from axiscal.estimation.promise.agreement import Framed, Turned
from axiscal.estimation.promise.causes import at_feed
from axiscal.estimation.promise.mistaken import with_feed
from axiscal.estimation.promise.problem import problem
from axiscal.measurement.instruments.distance import Nest
from axiscal.measurement.reading import Reading
from axiscal.record.accepted import in_workpiece
from axiscal_core.problem import Problem


def posed(case: Case, readings: Sequence[Reading]) -> Problem:
    """Return readings as a problem, linear where a case has them so.  case : with the sizes as stated"""
    plain = problem(case.observation, readings, case.sizes, case.inherited, case.description.usual)
    circles = [*at_feed(case.observation, readings)] if case.description.usual else []
    return with_feed(plain, circles) if circles else plain


def framed(case: Case, readings: Sequence[Reading]) -> Iterator[Framed]:
    """Yield the readings as a problem for each set-up whose three values may be along the machine's own x, y, z.

    They are other values only where its workpiece turns from reading to reading.
    """
    machine = case.description.machine
    for index, setup in enumerate(case.description.setups):
        mine = [reading for reading in readings if reading.setup == setup.name]
        turns = any(machine.axes[k].rotary and machine.axes[k].workpiece_side for k in setup.moves)
        if mine and turns and isinstance(setup, Nest):
            yield index, posed(case, in_workpiece(machine, readings, setup.name))


def turned(case: Case, readings: Sequence[Reading]) -> Iterator[Turned]:
    """Yield the readings as a problem for each choice of rotary axes that count the other way than described."""
    axes = [axis.name for axis in case.description.machine.axes if axis.rotary]
    for count in range(1, len(axes) + 1):
        for chosen in combinations(axes, count):
            yield chosen, posed(case.turned(chosen), readings)
