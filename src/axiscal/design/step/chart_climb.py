"""Climbing to the best reading on a chart: along one coordinate exactly, along all continuous ones by Newton's step.

Along a coordinate u every axis goes as a + c cos u + s sin u, so that pieces between knots of all of them are smooth;
what lies outside the travels, against a stem, or without room to come from its side is no piece.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from axiscal.design.gains.gain import Scorer
from axiscal.design.step.chart_line import pieces, places_along
from axiscal.design.step.newton_step import ascent, derivatives, stencil
from axiscal.measurement.chart_places import arrivals_of, turned_to
from axiscal.measurement.charts.arrivals import has_room
from axiscal.measurement.charts.chart import Chart
from axiscal.measurement.observation import directions_of
from axiscal.measurement.travel import sides_of
from axiscal.numerics import Array
from axiscal.numerics.exact_step import maximise_along
from axiscal.numerics.ties import TIE, first_best

_NODES, _NODES_OF_MORE = 17, 21
"""A piece is begun with so many; what they do not follow is halved."""
_IMPROVED = 1e-10
"""Rounding of a gain, with room."""
ROUNDS = 30
"""Rounds end where none rises; this only ends what would go round."""
_NEWTON = 12
"""Newton's step ends where it gains nothing; this only ends what would go round."""
_SHORTER: Array = np.array([1.0, 0.5, 0.25, 0.1, 0.03, 0.01])
"""Shares of a step that are tried; any shrinking row will do."""


@dataclass(frozen=True, eq=False, slots=True)
class ChartClimb:
    """One reading on its way up.

    place, sides : (size,) u and +1, −1, from which its coordinates are come to; gain : there
    """

    scorer: Scorer
    setup: int
    chart: Chart
    place: Array
    sides: Array
    gain: float

    @classmethod
    def begun(cls, scorer: Scorer, setup: int, pose: Array, approach: Array) -> ChartClimb | None:
        """Return the climb from a candidate, pose and approach (q,); None where it is read on no chart."""
        observation = scorer.observation
        chart = observation.setups[setup].chart
        if chart is None:
            return None
        place = chart.places(pose[None])
        come = turned_to(observation.machine, observation.setups[setup], approach[None])
        sides = sides_of(chart, place, come)[0]
        climb = cls(scorer, setup, chart, place[0], np.where(sides == 0, 1.0, sides), -np.inf)
        return replace(climb, gain=float(climb._gains(place)[0]))

    @property
    def pose(self) -> Array:
        """Where it stands, (q,)."""
        pose: Array = self.chart.poses(self.place[None])[0]
        return pose

    @property
    def approach(self) -> Array:
        """From where the axes come, (q,)."""
        approach: Array = self._come(self.place[None])[0]
        return approach

    def finished(self, rounds: int = ROUNDS) -> ChartClimb:
        """Return the climb where no coordinate and no side improves it, alone and exactly; or after so many rounds."""
        here = self
        for _ in range(rounds):
            before, here = here.gain, here._uphill()._best_line()._turned()
            if not here.gain > before * (1 + _IMPROVED):
                break
        return here

    @property
    def _continuous(self) -> list[int]:
        return [number for number in range(self.chart.size) if self.chart.bounds(number).step == 0]

    def _come(self, places: Array) -> Array:
        observation = self.scorer.observation
        sides = np.tile(self.sides, (len(places), 1))
        return arrivals_of(observation.machine, observation.setups[self.setup], self.chart, places, sides)

    def _gains(self, places: Array) -> Array:
        """Return the gains at places (m, size); −inf where no reading can be taken."""
        gains = np.full(len(places), -np.inf)
        taken = has_room(self.chart, places, np.tile(self.sides, (len(places), 1)))
        if taken.any():
            gains[taken] = self.scorer.at(self.setup, self.chart.poses(places[taken]), self._come(places[taken]))
        return gains

    def _at_best(self, places: Array) -> ChartClimb:
        """Return the climb at the best of places (m, size), or where it is."""
        gains = self._gains(places) if len(places) else np.array([-np.inf])
        best = first_best(gains, TIE)
        return replace(self, place=places[best], gain=float(gains[best])) if gains[best] > self.gain else self

    def _best_line(self) -> ChartClimb:
        """Return the climb at the best place along any one coordinate."""
        return _first_best([self._along(number) for number in range(self.chart.size)])

    def _along(self, number: int) -> ChartClimb:
        end = self.chart.bounds(number)
        if end.step > 0:
            return self._at_best(places_along(self.place, number, end.values))
        cut = pieces(self.scorer.observation, self.setup, self.chart, number, self.place, self.sides)
        if not len(cut):
            return self

        def forms(positions: Array, _: NDArray[np.intp]) -> tuple[Array, Array]:
            places = places_along(self.place, number, positions.ravel())
            above, below = self.scorer.forms(self.setup, self.chart.poses(places), self._come(places))
            return above.reshape(positions.shape), below.reshape(positions.shape)

        alone = len(directions_of(self.scorer.observation.setups[self.setup])) == 1
        found, value = maximise_along(forms, cut[:, 0], cut[:, 1], _NODES if alone else _NODES_OF_MORE)
        return self._at_best(places_along(self.place, number, found[[first_best(value, TIE)]]))

    def _turned(self) -> ChartClimb:
        """Return the climb from the best of the sides that are allowed."""
        allowed = [float(side) for side in self.scorer.observation.setups[self.setup].sides]
        turned = [replace(self, sides=np.array(sides)) for sides in product(allowed, repeat=self.chart.size)]
        here = self.place[None]
        return _first_best([replace(each, gain=float(each._gains(here)[0])) for each in turned])

    def _uphill(self) -> ChartClimb:
        """Return the climb after Newton's steps in all continuous coordinates at once."""
        numbers, climb = self._continuous, self
        if len(numbers) < 2:
            return self
        low, high = np.array([self.chart.bounds(number)[:2] for number in numbers]).T
        for _ in range(_NEWTON):
            here = climb.place[numbers]
            around = np.tile(climb.place, (len(stencil(len(numbers))), 1))
            around[:, numbers] = here + stencil(len(numbers)) * (high - low)
            values = climb._gains(around)
            if not np.all(np.isfinite(values)):
                return climb
            slope, bend = derivatives(values[None], len(numbers))
            step = ascent(slope, bend, ((here - low) / (high - low))[None])[0] * (high - low)
            tries = np.tile(climb.place, (len(_SHORTER), 1))
            tries[:, numbers] = np.clip(here + _SHORTER[:, None] * step, low, high)
            further = climb._at_best(tries)
            if not further.gain > climb.gain * (1 + _IMPROVED):
                return further
            climb = further
        return climb


def _first_best(climbs: list[ChartClimb]) -> ChartClimb:
    """Return the first of the climbs that stand highest."""
    return climbs[first_best(np.array([climb.gain for climb in climbs]), TIE)]
