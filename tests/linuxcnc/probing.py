"""A sphere that a probe touches with real `G38` moves, and the centre that its touches show.

The cycle is that of a machine: pole, four sides, pole again, each touched fast, then slowly from a short way off. The
simulated sphere is HAL: the distance of the motors from its centre is compared with its radius, which drives
`motion.probe-input`. At 60 mm/min LinuxCNC notices within 1 um. With `trt-kins` the same moves go in TCP mode, in
places of the workpiece, for the rotary axes stand while a sphere is touched.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.measurement.touched import Sphere, centred
from axiscal.numerics import Array
from tests.linuxcnc.lab import Session, signals
from tests.linuxcnc.running import ControlError

_AXES = "xyz"
_AFAR = 1e6
"""mm: out of every machine."""


@dataclass(frozen=True, slots=True)
class Probe:
    """How a sphere is touched; mm and mm/min.

    radius : of sphere and stylus together; clear : off its surface where a touch begins; past : how far beyond its
        surface a touch goes before it finds nothing; back : off it before the slow touch; fast, slow : feeds
    """

    radius: float = 15.5
    clear: float = 4.0
    past: float = 4.0
    back: float = 0.2
    fast: float = 1500.0
    slow: float = 60.0


@dataclass(frozen=True, eq=False, slots=True)
class Touch:
    """One side touched.

    side : (3,) unit vector from the centre to where the sphere is met; place : (3,) mm, where the tip is to meet it
    codes : the moves, from beside the sphere or above it; slow : which of them is the slow touch
    """

    side: Array
    place: Array
    codes: tuple[str, ...]
    slow: int


def ball(radius: float, hal: str = "") -> str:
    """Return HAL text with a sphere of a radius, mm, far away until `placed` says where it is.

    hal : what the machine is given besides, where the motors of joints 0 to 2, which are X, Y, Z, may be moved
    """
    lines = ["loadrt sum2 names=ball-x,ball-y,ball-z", "loadrt hypot names=ball-far", "loadrt comp names=ball-touch"]
    for number, (axis, signal) in enumerate(zip(_AXES, signals(3, hal), strict=True)):
        lines += [f"addf ball-{axis} servo-thread", f"net {signal} => ball-{axis}.in0"]
        lines += [f"net ball-d{axis} ball-{axis}.out => ball-far.in{number}"]
    lines += ["addf ball-far servo-thread", "addf ball-touch servo-thread"]
    lines += ["net ball-distance ball-far.out => ball-touch.in0", f"setp ball-touch.in1 {radius:.6f}"]
    lines += ["net ball-touched ball-touch.out => motion.probe-input", *placed([_AFAR] * 3)]
    return "\n".join(lines) + "\n"


def placed(centre: Sequence[float]) -> list[str]:
    """Return what moves the simulated sphere.  centre : where X, Y, Z have the tip at its middle, mm"""
    return [f"setp ball-{axis}.offset {-at:.9f}" for axis, at in zip(_AXES, centre, strict=True)]


def cycle(centre: Array, stem: Array, sideways: Array, probe: Probe) -> tuple[Touch, ...]:
    """Return the touches: pole, four sides, pole again, all moves in the coordinates of the program.

    centre : (3,) mm, where the sphere is looked for; stem : (3,) from the tip to the spindle
    sideways : (2, 3) unit vectors across the stem
    """
    pole = _touch(centre, stem, stem, probe)
    sides = [_touch(centre, side, stem, probe) for side in (*sideways, *-sideways)]
    return (pole, *sides, pole)


def touched(
    session: Session, touches: Sequence[Touch], before: Callable[[Touch], list[str]], probe: Probe, length: float = 0.0
) -> Sphere:
    """Touch a sphere and return where it is found, in the coordinates of the program.

    before : what is said to the control before each touch, such as where a simulated sphere is
    length : of the tool that the program counts with, mm: LinuxCNC shows where the probe tripped without it
    Raises ControlError when the probe finds nothing.
    """
    hits = []
    for touch in touches:
        told = before(touch)
        position, tripped = session.move([*told, *touch.codes])[len(told) + touch.slow].probe
        if not tripped:
            raise ControlError("the probe found no ball where it was looked for", "Look for it elsewhere")
        hits.append(np.array(position[:3]) - [0.0, 0.0, length])
    return centred(np.array(hits), np.array([touch.side for touch in touches]), probe.radius)


def _touch(centre: Array, side: Array, stem: Array, probe: Probe) -> Touch:
    """Return the moves that touch one side, from above and back to above; the pole is touched from there."""
    away = centre + side * (probe.radius + probe.clear)
    into = _words(centre + side * (probe.radius - probe.past))
    across = abs(float(side @ stem)) < _ALONG
    above = [f"G0 {_words(away + stem * (probe.radius + probe.clear))}"] if across else []
    codes = [
        *above,
        f"G0 {_words(away)}",
        f"G38.3 F{probe.fast:g} {into}",
        f"G91 G1 F{probe.fast:g} {_words(side * probe.back)}",
        f"G90 G38.3 F{probe.slow:g} {into}",
        f"G0 {_words(away)}",
        *above,
    ]
    return Touch(side, centre + side * probe.radius, tuple(codes), len(above) + 3)


_ALONG = 0.5
"""Geometry: a side is across the stem or along it."""


def _words(place: Array) -> str:
    return " ".join(_each(place))


def _each(place: Array) -> Iterator[str]:
    for letter, at in zip("XYZ", place.tolist(), strict=True):
        yield f"{letter}{at + 0.0:.6f}"
