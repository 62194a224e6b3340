"""A first campaign.toml for a machine: the set-ups of the usual instruments, each line with a word on what it means."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import combinations, product
from typing import NamedTuple

import numpy as np

from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import later
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
{tool}{active}
{controls}   # whose tables are written; axiscal export R --to list names them all

[target]                         # the first one that is reached ends the campaign
{first}U = "{target}"                   # 95 %, of the tool point, over {over}
readings = {readings}
{counted}
{budget}of machine time
{volume}
"""
_IN_SPACE = {
    "first": "",
    "budget": '# budget = "3 h"                 # ',
    "controls": '# controls = ["linuxcnc"]     ',
    "over": "all travel",
    "counted": '# directions = ["z"]           # only these count: the height of a bed; in space where nothing is said',
    "volume": '# volume = { X = ["50 mm", "550 mm"] }   # where the work is done',
}
_BED = _IN_SPACE | {
    "controls": 'controls = ["klipper", "marlin", "reprapfirmware"]',
    "over": "the bed",
    "counted": 'directions = ["z"]               # only the height counts; nothing else of the printer has to be known',
}
_OF_BOARD = {
    "first": """\
wants = ["squareness XY", "squareness XZ", "squareness YZ", "straightness X in Y", "straightness Y in X"]
# """,
    "budget": 'budget = "30 min"                # ',
}
_TOOL = """\
tool_length = "100 um"           # CHECK: how well the length of the tool is known; "0 um" if the zeros were set with it
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
name = "dial along {axis}, read in {way}"
instrument = "straightedge"
direction = "{way}"
moves = ["{axis}"]
reach = {{ {axis} = ["{low}", "{high}"] }}   # from where to where it touches something straight: say how yours does
raster = {{ {axis} = "10 mm" }}
approach = "both"
# noise = "1 um"
"""
_SQUARE = """
[[artefacts]]
name = "square {one}{other}"
turned = "1 mrad"                # how far it may lie turned; both legs share it
{legs}"""
_LEG = """
[[setups]]
name = "dial on the leg of square {one}{other} along {axis}"
instrument = "straightedge"
artefact = "square {one}{other}"
direction = "{way}"
moves = ["{axis}"]
reach = {{ {axis} = ["{low}", "{high}"] }}   # from where to where the leg lies: say how yours does
raster = {{ {axis} = "10 mm" }}
approach = "both"
# noise = "1 um"
"""
_TILT = """
[[setups]]
name = "{what} along {axis}, about {way}"
instrument = "{what}"
direction = "{way}"                # the tilt about {way}
moves = ["{axis}"]
raster = {{ {axis} = "10 mm" }}
approach = "both"
"""
_TRACKER = """
[[setups]]
name = "tracker"
instrument = "tracker"
station = [{station}]   # CHECK: where it stands, in the workpiece frame
unknowns = {{ turn_x = "20 mrad", turn_y = "20 mrad", turn_z = "20 mrad" }}   # it is set down by eye
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

_PROBE = """
[[setups]]
name = "probe"
instrument = "probe"
direction = "z"
moves = ["X", "Y"]
park = {{ Z = "{bed}" }}
reach = {{ {reach} }}   # CHECK: where the probe reaches the bed
raster = {{ X = "5 mm", Y = "5 mm" }}
noise = "5 um"                   # CHECK: one standard deviation of the probe; PROBE_ACCURACY of Klipper says yours
unknowns = {{ zero = "1 mm" }}   # the Z offset is set anew anyway
"""
_FIRST_LAYERS = 1e-3
"""m over the bed in which its height counts: a mesh fades out farther up."""

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
_BOARD = """
[programs]
clearance = "{clearance}"         # over the balls, where the probe goes from ball to ball

[[artefacts]]
name = "board"                   # balls on a board that is put down and turned: their places need not be known
balls = {{ {balls} }}   # CHECK: their middles, as built
calibrated = "0.3 mm"            # how well; from a certificate such as "1 um", and it shows how long a metre is, too
diameter = "25 mm"               # CHECK: of each
placed = "1 mm"                  # how well it is put down where the set-ups say
turned = "5 mrad"
"""
_PLACEMENT = """
[[setups]]
name = "placement {number}"
instrument = "sphere"
artefact = "board"
at = [{at}]   # CHECK: where the board's own zero stands
turn = "{turn} deg"                # counter-clockwise from above
setup_time = "2 min"
reading_time = "25 s"            # six touches and the way, at the feeds of linuxcnc-live
retract = "25 mm"
"""
_ROOM, _FEWEST, _FULL = 30e-3, 25e-3, 90e-3
"""m beside a ball, for its touches and to put it down by eye; the arm of a cross that is worth turning, and of one that
has room for a second ball on each."""
_DEPTH = 50e-3
"""m of the travel of Z that heights of balls leave free: below the lowest, and over the highest for its touches and the
first run above it."""
_ARM = 0.9
"""Of what would just turn: then it can also go aside."""
_CROSS = (
    ("one", -1.0, 0.0, 0.25), ("two", 1.0, 0.0, 0.5), ("three", 0.0, -1.0, 1.0), ("four", 0.0, 1.0, 0.75),
    ("five", -0.5, 0.0, 1.0), ("six", 0.5, 0.0, 0.25), ("seven", 0.0, -0.5, 0.0), ("eight", 0.0, 0.5, 1.0),
)  # fmt: skip
"""x, y and height of each ball, of the arm and of the lift: of many crosses with five placements the one that tells
most of squareness and straightness."""
_TURNED, _SWUNG = "15 deg", "5 deg"
"""Rasters of a rotary axis that makes a whole turn, and of one that does not: angles that a person can follow."""


_MOST, _USUAL = 150, 40
"""Readings that a target may take, and those of a campaign that wants none."""
UNSAID = (
    "# compensation_active = false    # whether a table or backlash compensation is active on the control meanwhile"
)
"""Of campaign.toml, where nobody knows whether a compensation is active."""


def first_campaign(machine: Machine, source: str, instruments: Sequence[str], target: str, active: str = UNSAID) -> str:
    """Return the text of a campaign file.

    source : how the file names the machine
    instruments : of `OFFERED`; with a square the dial reads along its legs, and nothing else straight is asked for
    target : the expanded uncertainty wanted, "" for as good as the set-ups make it
    active : the line that says whether a compensation is active
    Raises DescriptionError where a machine has no linear axis that an instrument could be read along.
    """
    about = {**_BED, "volume": _over_bed(machine)} if list(instruments) == ["probe"] else _IN_SPACE
    turns = any(axis.rotary for axis in machine.axes)
    about = about if turns or list(instruments) != ["sphere"] else about | _OF_BOARD
    tool = _TOOL if "sphere" in instruments and turns else ""
    if not target:
        about = about | {"first": about["first"] or "# "}
    ends = {"target": target or "20 um", "readings": _MOST if target else _USUAL}
    head = _HEAD.format(name=machine.name, machine=source, active=active, tool=tool, **ends, **about)
    offered = [name for name in instruments if name != "dial" or "square" not in instruments]
    setups = [text for name in offered for text in OFFERED[name].setups(machine)]
    if not setups:
        what = "Nothing of {instruments} can be offered for {machine}"
        remedy = "Write the set-ups by hand, as docs/campaign.md shows"
        raise DescriptionError(what, remedy, instruments=", ".join(instruments), machine=machine.name)
    return "".join([head, *setups])


def _linear(machine: Machine) -> list[Axis]:
    return [axis for axis in machine.axes if not axis.rotary]


def _way(axis: Axis) -> str:
    return "xyz"[letter_direction(axis.letter)]


def _lasers(machine: Machine) -> Iterator[str]:
    for axis in _linear(machine):
        yield _LASER.format(axis=axis.name, way=_way(axis))


def _dials(machine: Machine) -> Iterator[str]:
    """Yield set-ups that read across each linear axis along something straight."""
    ways = {_way(axis) for axis in _linear(machine)}
    for axis in _linear(machine):
        low, high = _within(axis)
        for way in sorted(ways - {_way(axis)}):
            yield _EDGE.format(axis=axis.name, way=way, low=low, high=high)


def _tilts(machine: Machine, what: str, ways: str) -> Iterator[str]:
    """Yield set-ups that read angles as one axis moves.  ways : about which `what` reads; a mirror sees no roll"""
    for axis, way in product(_linear(machine), ways):
        if what == "level" or way != _way(axis):
            yield _TILT.format(what=what, axis=axis.name, way=way)


_levels = partial(_tilts, what="level", ways="xy")
_autocollimators = partial(_tilts, what="autocollimator", ways="xyz")


def _trackers(machine: Machine) -> Iterator[str]:
    """Yield a tracker that stands aside of what the tool reaches, at half its height."""
    middle = np.array([[float(np.mean(axis.travel)) for axis in machine.axes]])
    far = sum(axis.length for axis in _linear(machine))
    yield _TRACKER.format(station=_place(frames(machine, middle).tcp[0] - [0.0, far, 0.0]))


def _squares(machine: Machine) -> Iterator[str]:
    """Yield a square for each two linear axes, with a dial on both of its legs."""
    for pair in combinations(_linear(machine), 2):
        names = {"one": pair[0].name, "other": pair[1].name}
        legs = ""
        for axis, across in (pair, pair[::-1]):
            low, high = _within(axis)
            legs += _LEG.format(**names, axis=axis.name, way=_way(across), low=low, high=high)
        yield _SQUARE.format(**names, legs=legs)


def _within(axis: Axis, share: float = 0.25) -> tuple[str, str]:
    """Return both ends of a travel without a share of it on either side; of the middle half where none is said."""
    low, high = (format_quantity(float(each), "mm", 4) for each in np.quantile(axis.travel, [share, 1 - share]))
    return low, high


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
    rotary, linear = [axis for axis in machine.axes if axis.rotary], _linear(machine)
    if not rotary:
        yield from _board(machine)
    if not rotary or not linear:  # without a linear axis no probe gets to a ball
        return
    middle = np.array([[0.0 if axis.rotary else float(np.mean(axis.travel)) for axis in machine.axes]])
    reach = min(axis.length for axis in linear) / 6
    shares = {"low": (1.0, 0.0, -0.5), "high": (-0.5, 0.8, 0.5), "third": (-0.5, -0.8, 0.1)}
    centre = frames(machine, middle).tcp[0]
    about = next((axis.origin for axis in rotary if axis.letter == "C"), None)
    if about is not None:
        centre[:2] = about[:2]
    balls = ", ".join(f"{name} = [{_place(centre + reach * np.array(each))}]" for name, each in shares.items())
    raster = ", ".join(f'{axis.name} = "{_TURNED if axis.cyclic else _SWUNG}"' for axis in rotary)
    yield _SPHERES.format(balls=balls, raster=raster)


def _board(machine: Machine) -> Iterator[str]:
    """Yield balls on a cross, and placements that turn it and take it over the travels.

    Eight balls tell more in the same time than four that are touched twice; a short axis has room for four only.
    """
    axes = {axis.name: axis for axis in machine.axes}
    if not {"X", "Y", "Z"} <= set(axes):
        return
    x, y, z = (axes[name].length for name in "XYZ")
    arm = _ARM * (min(x, y) / 2 - _ROOM)
    if arm < _FEWEST:
        return
    lift = min(2 * arm, max(z - _DEPTH, 0.0))
    every = _CROSS if arm >= _FULL else _CROSS[:4]
    scaled = {name: np.array(each) * [arm, arm, lift] for name, *each in every}
    balls = ", ".join(f"{name} = [{_place(each)}]" for name, each in scaled.items())
    clear = format_quantity(axes["Z"].travel[1] - axes["Z"].overrun, "mm", 6)
    yield _BOARD.format(balls=balls, clearance=f"Z={clear}")
    middle = np.array(
        [[axis.travel[0] + _ROOM / 3 if axis.name == "Z" else sum(axis.travel) / 2 for axis in machine.axes]]
    )
    centre, aside = frames(machine, middle).tcp[0], np.array([x / 2, y / 2, 0.0]) - [arm + _ROOM, arm + _ROOM, 0.0]
    placed = (((-1, -1), 90), ((1, 1), 0), ((-1, 1), 180), ((1, -1), 270), ((0, 0), 0), ((0, 0), 90), ((0, 0), 180))
    for number, (way, turn) in enumerate(placed[: 5 if arm >= _FULL else 7], start=1):
        yield _PLACEMENT.format(number=number, at=_place(centre + aside * [*way, 0]), turn=turn)


def _probes(machine: Machine) -> Iterator[str]:
    """Yield a probe that reads the height of the bed where Z is lowest, at places of X and Y."""
    axes = {axis.name: axis for axis in _linear(machine)}
    if not {"X", "Y", "Z"} <= set(axes):
        return
    reach = ", ".join(f'{name} = ["{low}", "{high}"]' for name in "XY" for low, high in [_within(axes[name], 1 / 30)])
    yield _PROBE.format(bed=format_quantity(axes["Z"].travel[0], "mm", 6), reach=reach)


def _over_bed(machine: Machine) -> str:
    """Return the line of the volume just over the bed."""
    low = next((axis.travel[0] for axis in _linear(machine) if axis.name == "Z"), 0.0)
    ends = '", "'.join(format_quantity(each, "mm", 6) for each in (low, low + _FIRST_LAYERS))
    return f'volume = {{ Z = ["{ends}"] }}  # the first layers, where the probe reads'


def _place(point: Array) -> str:
    """Return a point in whole millimetres."""
    return ", ".join(f'"{round(1e3 * float(each)) + 0:d} mm"' for each in point)


class Offer(NamedTuple):
    """words : what people call an instrument, in all of the languages; setups : their texts for a machine"""

    words: str
    setups: Callable[[Machine], Iterator[str]]


OFFERED = {
    "dial": Offer(later("dial, dial gauge, dial indicator, indicator, straightedge, ruler"), _dials),
    "square": Offer(later("square, granite square, master square, dial on a square"), _squares),
    "interferometer": Offer(later("laser, interferometer, laser interferometer"), _lasers),
    "ballbar": Offer(later("ball bar, double ball bar"), _ball_bars),
    "sphere": Offer(later("touch probe, sphere, spheres, ball, balls, ball plate"), _spheres),
    "probe": Offer(later("probe, bed probe, Z probe"), _probes),
    "level": Offer(later("level, electronic level, spirit level, inclinometer"), _levels),
    "autocollimator": Offer(later("autocollimator, collimator"), _autocollimators),
    "tracker": Offer(later("tracker, laser tracker"), _trackers),
}
"""The instruments whose set-ups follow from the machine alone."""
