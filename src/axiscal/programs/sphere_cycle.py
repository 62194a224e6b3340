"""The sphere cycle of a program that touches by itself: which sides, over what ways, in the numbers of the program."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from decimal import Decimal

import numpy as np

from axiscal.document import shown
from axiscal.exceptions import ProgramError, TravelError
from axiscal.measurement.reading import Place
from axiscal.measurement.setup import Setup
from axiscal.measurement.touched import SideTouch, cycle_of, touches
from axiscal.numerics import Array
from axiscal.programs.scale import Decimals, ReadingTarget, exact
from axiscal.programs.steps import Group, ProgramAxes, Step, Touched
from axiscal.units import to_unit
from axiscal_core.machine import Machine

_TRAVEL = 600
"""mm/min beside a sphere: gentle on any probe."""


class SphereCycle:
    """Touches the spheres of one set-up by moves of the linear axes, which must be one group called X, Y and Z."""

    def __init__(self, machine: Machine, setup: Setup, axes: ProgramAxes) -> None:
        self._machine, self._setup, self._scales = machine, setup, axes.scales
        self._cycle = cycle_of(machine, setup)
        self._group = next((group for group in axes.groups if set(group.names) == set("XYZ")), None)

    def steps(self, target: ReadingTarget, place: Place) -> Iterator[Step]:
        """Yield the touches of a reading, from where the tool is drawn back and back to there."""
        group = self._group
        if group is None:
            what = "X, Y and Z touch the spheres of {setup} and are not one group of moves"
            remedy = "Name the linear axes X, Y and Z, and let them move together in --order"
            raise ProgramError(what, remedy, setup=shown(self._setup.name))
        standing, axes = target.position, ProgramAxes(self._scales, (group,))
        for number, touch in enumerate(touches(self._machine, np.array(place.pose), self._cycle), start=1):
            stops = [self._written(pose, target) for pose in (*touch.way, touch.beside)]
            for stop in stops:
                yield from axes.moves(standing, stop)
                standing = stop
            yield self._touched(target, number, touch, standing, group)
            for stop in stops[-2::-1]:
                yield from axes.moves(standing, stop)
                standing = stop
        yield from axes.moves(standing, target.position)

    def _written(self, pose: Array, target: ReadingTarget) -> Decimals:
        """Return a pose in the numbers of the program, the rotary axes as they stand; raises TravelError."""
        numbers = []
        for k, (scale, value) in enumerate(zip(self._scales, pose.tolist(), strict=True)):
            number = target.position[k] if scale.axis.rotary else scale.nearest(value)
            if number is None:
                what = "reading {number} of {setup}: touching leaves the travel of {axis}"
                remedy, setup = "Put the sphere nearer to the middle of the travels", shown(self._setup.name)
                raise TravelError(what, remedy, number=target.number, setup=setup, axis=scale.axis.name)
            numbers.append(number)
        return tuple(numbers)

    def _touched(self, target: ReadingTarget, number: int, touch: SideTouch, beside: Decimals, group: Group) -> Touched:
        def texts(values: Sequence[Decimal]) -> tuple[str, ...]:
            return tuple(f"{values[k] + 0:f}" for k in group.axes)

        steps = [exact(to_unit(each, "mm")).quantize(s.step) for each, s in zip(touch.back, self._scales, strict=True)]
        fast, slow = (math.floor(to_unit(speed, "mm/min")) for speed in (self._cycle.fast, self._cycle.slow))
        travel = min(_TRAVEL, group.feed(None))
        way = to_unit(self._cycle.clear, "mm") / fast + to_unit(self._cycle.back, "mm") * (1 / fast + 1 / slow)
        seconds = 60 * (way + to_unit(self._cycle.clear, "mm") / travel)
        into = texts(self._written(touch.into, target))
        return Touched(
            target.number, number, group.names, into, texts(steps), texts(beside), fast, slow, travel, seconds
        )
