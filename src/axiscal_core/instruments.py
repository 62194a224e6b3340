"""Instruments that many shops have: each is a class as a stranger would write it.

>>> laser = Laser("laser", "X", along="x", noise="0.3 um")
>>> laser.own
{'zero': 0.001}
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Unpack

import numpy as np

from axiscal_core.axes import Direction, unit_vector
from axiscal_core.instrument import At, Instrument, Mounting, Unknowns, length
from axiscal_core.refusals import Array
from axiscal_core.rigid import rotation
from axiscal_core.units import METRES, Quantity, quantities

_ZEROS: Mapping[str, Quantity] = {f"zero_{axis}": "1 mm" for axis in "xyz"}
_TURNS: Mapping[str, Quantity] = {f"turn_{axis}": "1 mrad" for axis in "xyz"}
_PLACE: Mapping[str, Quantity] = {f"station_{axis}": "0.1 mm" for axis in "xyz"}
_CARRIED: Mapping[str, Quantity] = {f"tool_{axis}": "0.1 mm" for axis in "xyz"}


class Laser(Instrument):
    """A displacement along a direction: interferometer, dial, probe, straightedge."""

    names, units, noise = ("length",), ("m",), "0.3 um"
    unknowns: Mapping[str, Quantity] = {"zero": "1 mm"}

    def __init__(
        self, name: str, moves: str | Sequence[str], along: Direction = "x", **mounting: Unpack[Mounting]
    ) -> None:
        super().__init__(name, moves, **mounting)
        self.along = unit_vector(along, "Laser", "along")

    def sees(self, at: At, u: Unknowns) -> Sequence[Array]:
        """Return the displacement."""
        return [at.moved @ self.along + u["zero"]]


class Level(Instrument):
    """A turn about a direction: electronic level, autocollimator."""

    names, units, noise = ("angle",), ("rad",), "0.5 urad"
    unknowns: Mapping[str, Quantity] = {"zero": "1 mrad"}

    def __init__(
        self, name: str, moves: str | Sequence[str], about: Direction = "y", **mounting: Unpack[Mounting]
    ) -> None:
        super().__init__(name, moves, **mounting)
        self.about = unit_vector(about, "Level", "about")

    def sees(self, at: At, u: Unknowns) -> Sequence[Array]:
        """Return the turn."""
        return [at.turned @ self.about + u["zero"]]


class Stationed(Instrument):
    """An instrument that stands somewhere.  station : (3,) in the frame of the workpiece, m"""

    def __init__(
        self, name: str, moves: str | Sequence[str], station: Sequence[Quantity], **mounting: Unpack[Mounting]
    ) -> None:
        super().__init__(name, moves, **mounting)
        self.station = quantities(station, type(self).__name__, "station", (3,), [METRES])


class BallBar(Stationed):
    """A distance from a station: ball bar, tracer.  It shows by how much the distance is not the nominal one."""

    names, units, noise = ("length",), ("m",), "0.5 um"
    unknowns: Mapping[str, Quantity] = {"zero": "1 mm", **_PLACE, **_CARRIED}

    def sees(self, at: At, u: Unknowns) -> Sequence[Array]:
        """Return the distance less the nominal one."""
        line = at.tcp - self.station
        off = np.array([u[name] for name in _PLACE])
        return [length(line + at.tip(u) - off) - length(line) + u["zero"]]


class RTest(Instrument):
    """Three lengths between a nest and a ball in the spindle: R-test, touched sphere."""

    names, units, noise = ("x", "y", "z"), ("m",) * 3, "0.7 um"
    unknowns: Mapping[str, Quantity] = {**_ZEROS, **_CARRIED}

    def sees(self, at: At, u: Unknowns) -> Sequence[Array]:
        """Return where the ball is."""
        return [part + u[zero] for part, zero in zip(at.tip(u).T, _ZEROS, strict=True)]


class Tracker(Stationed):
    """The place of the tool point, from unknown zeros and turns: laser tracker, measuring arm."""

    names, units, noise = ("x", "y", "z"), ("m",) * 3, "10 um"
    unknowns: Mapping[str, Quantity] = {**_ZEROS, **_TURNS, **_CARRIED}

    def sees(self, at: At, u: Unknowns) -> Sequence[Array]:
        """Return the place less the nominal one."""
        line = at.tcp - self.station
        turn = rotation(np.array([[u[name] for name in _TURNS]]))[0]
        found = (line + at.tip(u)) @ turn.T - line
        return [part + u[zero] for part, zero in zip(found.T, _ZEROS, strict=True)]
