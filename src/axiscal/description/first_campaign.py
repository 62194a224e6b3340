"""A first campaign.toml for a machine: the set-ups of the usual instruments, each line with a word on what it means."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import combinations

import numpy as np

from axiscal.exceptions import DescriptionError
from axiscal.machine import Axis, Machine
from axiscal.machine.axis import letter_direction
from axiscal.machine.kinematics import frames
from axiscal.numerics import Array
from axiscal.units import format_quantity

_BAR = "150 mm"
_HEAD = """\
#:schema ./campaign.schema.json
# One calibration of: {name}. Every quantity is a text with its unit.
# What is left out has its usual value; docs/campaign.md of axiscal says which.
machine = "{machine}"
{active}
# controls = ["linuxcnc"]        # whose tables are written; axiscal export R --to list names them all

[target]                         # the first one that is reached ends the campaign
U = "{target}"                   # 95 %, of the tool point in space, over all travel
readings = 150
# budget = "3 h"                 # of machine time
# volume = {{ X = ["50 mm", "550 mm"] }}   # where the work is done
"""
_LASER = """
[[setups]]
name = "laser along {axis}"
instrument = "interferometer"
direction = "{way}"
moves = ["{axis}"]
raster = {{ {axis} = "10 mm" }}    # positions are multiples of this
approach = "both"                # from both sides: reversal shows with both only
# noise = "0.3 um"               # standard deviation of one reading
# park = {{ }}                    # where the other axes stand; the middle of their travel
"""
_EDGE = """
[[setups]]
name = "straightedge along {axis}, read in {way}"
instrument = "straightedge"
direction = "{way}"
moves = ["{axis}"]
reach = {{ {axis} = ["{low}", "{high}"] }}   # from where to where the straightedge lies: say how yours does
raster = {{ {axis} = "10 mm" }}
approach = "both"
# noise = "1 um"
"""
_BALLBAR = """
[[setups]]
name = "ball bar in {plane}"
instrument = "ballbar"
length = "{length}"                # the nominal length of the bar
station = [{station}]   # the centre ball, in the workpiece frame
plane = "{plane}"
raster = {{ arc = "10 deg" }}
approach = "both"
"""


_SPHERES = """
[[artefacts]]
name = "spheres"
balls = {{ {balls} }}   # CHECK: where their middles stand with all rotary axes at zero, to 1 mm; let the heights differ
diameter = "25 mm"               # CHECK: of each
# placed = "1 mm"                # how well their places are known; they are found more closely by the readings

[[setups]]
name = "spheres"
instrument = "sphere"
artefact = "spheres"
raster = {{ {raster} }}
approach = "both"                # of the rotary axes: reversal shows with both only
# noise = "1 um"                 # standard deviation of one reading; docs/campaign.md says the usual one
"""
_TURNED, _SWUNG = "15 deg", "5 deg"
"""Rasters of a rotary axis that makes a whole turn, and of one that does not: angles that a person can follow."""


UNSAID = (
    "# compensation_active = false    # whether a table or backlash compensation is active on the control meanwhile"
)
"""Of campaign.toml, where nobody knows whether a compensation is active."""


def first_campaign(machine: Machine, source: str, instruments: Sequence[str], target: str, active: str = UNSAID) -> str:
    """Return the text of a campaign file.

    source : how the file names the machine; instruments : of `OFFERED`; target : the expanded uncertainty wanted
    active : the line that says whether a compensation is active
    Raises DescriptionError where a machine has no linear axis that an instrument could be read along.
    """
    head = _HEAD.format(name=machine.name, machine=source, target=target, active=active)
    setups = [text for name in instruments for text in OFFERED[name](machine)]
    if not setups:
        remedy = "Write the set-ups by hand, as docs/campaign.md shows"
        raise DescriptionError(f"Nothing of {', '.join(instruments)} can be offered for {machine.name}", remedy)
    return "".join([head, *setups])


def _linear(machine: Machine) -> list[Axis]:
    return [axis for axis in machine.axes if not axis.rotary]


def _way(axis: Axis) -> str:
    return "xyz"[letter_direction(axis.letter)]


def _lasers(machine: Machine) -> Iterator[str]:
    for axis in _linear(machine):
        yield _LASER.format(axis=axis.name, way=_way(axis))


def _straightedges(machine: Machine) -> Iterator[str]:
    ways = {_way(axis) for axis in _linear(machine)}
    for axis in _linear(machine):
        low, high = (format_quantity(float(each), "mm", 4) for each in np.quantile(axis.travel, [0.25, 0.75]))
        for way in sorted(ways - {_way(axis)}):
            yield _EDGE.format(axis=axis.name, way=way, low=low, high=high)


def _ball_bars(machine: Machine) -> Iterator[str]:
    middle = np.array([[float(np.mean(axis.travel)) for axis in machine.axes]])
    place = (round(float(each), 9) + 0.0 for each in frames(machine, middle).tcp[0])
    station = ", ".join(f'"{format_quantity(each, "mm", 6)}"' for each in place)
    ways = sorted({_way(axis) for axis in _linear(machine)})
    for one, other in combinations(ways, 2):
        plane = {"xz": "zx"}.get(one + other, one + other)
        yield _BALLBAR.format(plane=plane, length=_BAR, station=station)


def _spheres(machine: Machine) -> Iterator[str]:
    """Yield three spheres about the middle of what the tool reaches, at different radii and heights."""
    rotary = [axis for axis in machine.axes if axis.rotary]
    if not rotary:
        return
    middle = np.array([[0.0 if axis.rotary else float(np.mean(axis.travel)) for axis in machine.axes]])
    reach = min(axis.length for axis in _linear(machine)) / 6
    shares = {"low": (1.0, 0.0, -0.5), "high": (-0.5, 0.8, 0.5), "third": (-0.5, -0.8, 0.1)}
    centre = frames(machine, middle).tcp[0]
    about = next((axis.origin for axis in rotary if axis.letter == "C"), None)
    if about is not None:
        centre[:2] = about[:2]
    balls = ", ".join(f"{name} = [{_place(centre + reach * np.array(each))}]" for name, each in shares.items())
    raster = ", ".join(f'{axis.name} = "{_TURNED if axis.cyclic else _SWUNG}"' for axis in rotary)
    yield _SPHERES.format(balls=balls, raster=raster)


def _place(point: Array) -> str:
    """Return a point in whole millimetres."""
    return ", ".join(f'"{round(1e3 * float(each)) + 0:d} mm"' for each in point)


OFFERED: dict[str, Callable[[Machine], Iterator[str]]] = {
    "interferometer": _lasers,
    "ballbar": _ball_bars,
    "straightedge": _straightedges,
    "sphere": _spheres,
}
"""The instruments whose set-ups follow from the machine alone."""
