"""The way through readings in touch: the tool point stays at its ball, or on the circle of its bar.

Where rotary axes turn the control itself must hold the tool point: then places are those of the workpiece, and rotary
axes are at zero when that begins, with the tool drawn back from the ball. Where none turns the slides go together.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from axiscal.gcode.gliding import Driver
from axiscal.gcode.steps import Arrival, Halt, Remark, Step, dwells
from axiscal.gcode.targets import ReadingTarget
from axiscal.gcode.touching_ways import Ways
from axiscal.measurement.charts.arrivals import begun
from axiscal.measurement.place import Place
from axiscal.measurement.setup import Setup
from axiscal.measurement.travel import sides_of
from axiscal.numerics import Array


class InTouch:
    """Goes through the readings of one set-up; raises ProgramError for what the machine cannot do in one piece."""

    def __init__(self, setup: Setup, ways: Ways, driver: Driver) -> None:
        self._setup, self._ways, self._driver = setup, ways, driver

    def run_through(self, readings: Sequence[tuple[int, Place]], reading: float | None) -> Iterator[Step]:
        """Yield the way through numbered readings; reading : s, None stops the program at each."""
        poses, approaches = (np.array([getattr(place, key) for _, place in readings]) for key in ("pose", "approach"))
        there = self._ways.chart.places(poses)
        sides = sides_of(self._ways.chart, there, approaches)
        standing = begun(self._ways.chart, there[:1], sides[:1])[0]
        yield from self._start(standing)
        for (number, place), at, side in zip(readings, there, sides, strict=True):
            for stop in self._stops(standing, at, side):
                yield from self._way(standing, stop)
                standing = stop
            yield Remark(f"READING {number}")
            position = self._driver.written(np.array(place.pose))
            yield Arrival(ReadingTarget(number, position, position, place.approach))
            yield from dwells(self._setup.settle)
            yield from [self._halt()] if reading is None else dwells(reading)
        yield from self._apart(standing)
        yield from self._driver.cleared()

    def _start(self, start: Array) -> Iterator[Step]:
        yield from (Remark("PRESS START WHEN THE WAY TO THE START IS CLEAR"), Halt())
        yield from self._together(start)
        yield from (Remark("MOUNT AND ZERO THE INSTRUMENT THEN PRESS START"), self._halt())

    def _halt(self) -> Halt:
        return Halt(self._driver.holding)

    def _stops(self, standing: Array, there: Array, side: Array) -> list[Array]:
        """Return over which places u a place is come to from its side."""
        straight = self._ways.legs(standing, there)
        if straight is not None and len(straight) == 2 and self._ways.comes_right(standing, there, side):
            return [there]
        return [begun(self._ways.chart, there[None], side[None])[0], there]

    def _way(self, here: Array, there: Array) -> Iterator[Step]:
        """Yield a way in touch; where there is none the tool goes off, and comes back."""
        legs = self._ways.legs(here, there)
        if legs is not None:
            for start, stop in pairwise(legs):
                yield from self._driver.along(self._ways.poses_along(start, stop))
            return
        bar = self._setup.length is not None
        yield from (Remark("TAKE THE BAR OFF THEN PRESS START"), self._halt()) if bar else ()
        yield from self._apart(here)
        yield from self._together(there)
        yield from (Remark("PUT THE BAR ON THEN PRESS START"), self._halt()) if bar else ()

    def _together(self, place: Array) -> Iterator[Step]:
        """Yield the way from anywhere to a place u: to the gate, then with the tool held to the place drawn back."""
        gate, drawn, pose = self._ways.entrance(place)
        yield from self._driver.begin(gate[0])
        yield from self._driver.along(gate)
        yield from self._driver.along(np.stack([drawn, pose]), gently=True)

    def _apart(self, place: Array) -> Iterator[Step]:
        gate, drawn, pose = self._ways.entrance(place)
        yield from self._driver.along(np.stack([pose, drawn]), gently=True)
        yield from self._driver.along(gate[::-1])
        yield from self._driver.end()
