"""The picture of what is being measured: the readings of a set-up with what was and is expected of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from axiscal.campaign.campaign import Campaign
from axiscal.guide.expectation import Expectation, expectations
from axiscal.machine.axis import Axis
from axiscal.measurement.place import Place
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.record.events import Asked

_POSITIONS = 41
"""Points of the band; a matter of taste."""


@dataclass(frozen=True, eq=False, slots=True)
class Dot:
    """One reading in the picture.

    number : of the reading; at : coordinate of the axis, or place in the order
    values : (k,) m or rad; expected : what was expected before it was taken
    doubted : whether it is not believed; same_side : whether it was taken from the side that is asked for now
    """

    number: int
    at: float
    values: Array
    expected: Expectation
    doubted: bool
    same_side: bool


@dataclass(frozen=True, eq=False, slots=True)
class Picture:
    """The readings of one set-up.

    axis : the only one that moves, None where there are several: the readings are then shown in their order
    at : (n,) coordinates of the band, empty without an axis; band : (n,) what a reading there is expected to show
    next : coordinate or place in the order of the reading asked for
    """

    setup: Setup
    axis: Axis | None
    at: Array
    band: tuple[Expectation, ...]
    dots: tuple[Dot, ...]
    next: float


def picture(campaign: Campaign, asked: Asked) -> Picture:
    """Return the picture of the set-up in which a reading is asked for."""
    setup, axes = campaign.description.setup(asked.place.setup), campaign.description.machine.axes
    index = _line(setup)
    dots = _dots(campaign, asked, index)
    if index is None:
        return Picture(setup, None, np.zeros(0), (), dots, float(len(dots) + 1))
    at = np.linspace(*_reach(setup, axes[index], index), _POSITIONS)
    band = expectations(campaign.known(), [_moved(asked.place, index, each) for each in at])
    return Picture(setup, axes[index], at, band, dots, asked.place.pose[index])


def _line(setup: Setup) -> int | None:
    """Return the axis along which a set-up is read; None where it is no line of one axis."""
    return setup.moves[0] if len(setup.moves) == 1 and setup.chart is None else None


def _reach(setup: Setup, axis: Axis, index: int) -> tuple[float, float]:
    """Return the coordinates between which the set-up can be read."""
    return axis.travel if setup.reach is None else setup.reach[index]


def _moved(place: Place, index: int, coordinate: float) -> Place:
    pose = tuple(float(coordinate) if k == index else value for k, value in enumerate(place.pose))
    return Place(place.setup, pose, place.approach)


def _dots(campaign: Campaign, asked: Asked, index: int | None) -> tuple[Dot, ...]:
    known = campaign.known()
    doubted = {doubt.reading for doubt in known.outliers}
    taken = [n for n, reading in enumerate(known.readings) if reading.setup == asked.place.setup]
    return tuple(
        _dot(campaign, asked, n, float(order) if index is None else known.readings[n].pose[index], n in doubted)
        for order, n in enumerate(taken, 1)
    )


def _dot(campaign: Campaign, asked: Asked, n: int, at: float, doubted: bool) -> Dot:
    reading, surprise = campaign.known().readings[n], campaign.known().innovations[n]
    values = np.array(reading.values)
    expected = Expectation(values - np.atleast_1d(surprise.value), np.atleast_1d(surprise.std))
    return Dot(reading.numbered(n), at, values, expected, doubted, reading.approach == asked.place.approach)
