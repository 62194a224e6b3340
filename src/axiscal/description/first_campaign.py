"""A first campaign.toml for a machine: the set-ups of the usual instruments, each line with a word on what it means."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, partial
from itertools import combinations, product, starmap
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from axiscal.document.ports import templates
from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import later
from axiscal.machine.axis import letter_direction
from axiscal.measurement.bodies import CLEAR, parts
from axiscal.measurement.readers.probe_offset import Beside
from axiscal.measurement.touched import Cycle
from axiscal.numerics import Array
from axiscal.units import format_quantity
from axiscal_core.axes import Axis
from axiscal_core.machine import Machine

if TYPE_CHECKING:
    from jinja2 import Environment

_ROOM, _FEWEST, _FULL = 30e-3, 25e-3, 90e-3
"""m beside a ball, for its touches and to put it down by eye; the arm of a cross that is worth turning, and of one that
has room for a second ball on each."""
_DIAMETER = 25e-3
"""m, of each ball, as the templates say."""
_WRITTEN = 1e-3
"""m: places are written in whole millimetres."""
_BELOW, _DEPTH = 3e-3, 32e-3
"""m of the travel of Z that heights of balls leave free: below the lowest, which is put down by eye, and in all, with
what is drawn back over the highest. Squareness is that of the whole travel: a quarter unread hides a third of it."""
_STEPS = (("1 mm", 0.01), ("0.1 mm", 0.0))
"""Steps, and travels from which on they are offered, m: half a travel then has several multiples.

Screws have leads of 5 or 10 mm, and places that are multiples of one show nothing of its error (ISO 230-2, 5.3.2).
"""
_ARM = 0.95
"""Of what would just turn: then it can also go aside."""
_CROSS = (
    ("one", -1.0, 0.0, 0.0), ("two", 1.0, 0.0, 1.0), ("three", 0.0, -1.0, 0.0), ("four", 0.0, 1.0, 1.0),
    ("five", -0.48, -0.48, 1.0), ("six", 0.48, 0.48, 0.0), ("seven", -0.48, 0.48, 0.0), ("eight", 0.48, -0.48, 1.0),
)  # fmt: skip
"""x, y and height of each ball, of the arm and of the lift: a holder gets between them, and half of them are high, for
heights tell how square Z is."""
_PLACED = (
    ((-1, -1), 90, 0), ((1, 1), 0, 2), ((-1, 1), 180, 2), ((1, -1), 270, 0),
    ((0, 0), 0, 1), ((0, 0), 90, 0), ((0, 0), 180, 0),
)  # fmt: skip
"""Where a board lies, of the room aside, its turn in deg, and on how many risers: these take it over the travel of Z,
for no post is higher than the nose."""
_RISER, _OVERLAP = 10e-3, 1.2
"""m, the lowest riser that is worth one; and of the heights of the balls, so that readings do not repeat each other."""
UNSAID = (
    "# compensation_active = false    # whether a table or backlash compensation is active on the control meanwhile"
)
"""Of campaign.toml, where nobody knows whether a compensation is active."""
UNSAID_OFFSET = '# offset = ["-33 mm", "-46 mm", "0 mm"]'
"""The same, where nobody knows where the probe stands."""


_Setups = Callable[[Machine, Any], Iterable[str]]
"""Texts of set-ups on a machine, by the functions of their template."""


class Purpose(NamedTuple):
    """What a first campaign is for.

    target : the expanded uncertainty wanted, "" for as good as the set-ups make it
    wants : the rows that are asked for, none where they follow from the set-ups
    budget : of machine time, such as "90 min"; "" for as much as it takes
    """

    target: str = ""
    wants: Sequence[str] = ()
    budget: str = ""


@dataclass(frozen=True, slots=True)
class Beginning:
    """A machine to begin with.

    text : of machine.toml; active : the line of campaign.toml on compensation; look : what could not be read
    beside : how far a probe stands beside the tool point along x and y, m; None where nobody said
    screws : the lines of campaign.toml on those under the bed, "" where there are none
    mesh : from where to where along X and Y a probe is sent, mm; none where nobody said
    instrument : of `OFFERED`, that it is measured by where nobody says another
    folder : where campaign.toml will stand, and files of instruments beside it
    """

    text: str
    active: str = UNSAID
    look: tuple[str, ...] = ()
    beside: Beside | None = None
    screws: str = ""
    mesh: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    instrument: str = "square"
    folder: Path = Path()


def first_campaign(machine: Machine, instruments: Sequence[str], purpose: Purpose, active: str = UNSAID) -> str:
    """Return the text of the campaign file of a machine.toml.

    instruments : of `OFFERED`; with a square the dial reads along its legs, and nothing else straight is asked for
    active : the line that says whether a compensation is active
    Raises DescriptionError where a machine has no linear axis that an instrument could be read along.
    """
    values = {"machine": machine, "instruments": list(instruments), "printer": _prints(machine)}
    head = _campaign_templates().get_template("campaign.jinja").render(values, **purpose._asdict(), active=active)
    offered = [name for name in instruments if name != "dial" or "square" not in instruments]
    made = {name: setups_of(machine, name) for name in offered}
    if none := [name for name, setups in made.items() if not setups]:
        what = "Nothing of {instruments} can be offered for {machine}"
        remedy = (
            "Name another instrument, such as a laser; balls need X, Y and Z, room for a board or a rotary axis that "
            "turns one, and [tool] has to get between them. docs/campaign.md shows set-ups written by hand"
        )
        raise DescriptionError(what, remedy, instruments=", ".join(none), machine=machine.name)
    setups = [text for each in made.values() for text in each]
    return "".join([head, *setups])


def setups_of(machine: Machine, name: str) -> list[str]:
    """Return the texts of the set-ups of an instrument of `OFFERED`, or of one that somebody wrote."""
    template = _setups(machine)
    if name in OFFERED:
        return [*OFFERED[name].setups(machine, template)]
    return [template.own(name, name.rpartition(":")[2], _linear(machine))]


def _linear(machine: Machine) -> list[Axis]:
    return [axis for axis in machine.axes if not axis.rotary]


def _way(axis: Axis) -> str:
    return "xyz"[letter_direction(axis.letter)]


@cache
def _campaign_templates() -> Environment:
    """Return the templates, with what they write: shares of a travel, steps, and points in whole millimetres.

    A step is one that an axis, or half of it, has several multiples of: a centimetre, or less where it is short.
    """
    return templates(
        "axiscal.description",
        way=_way,
        part=lambda axis, share: format_quantity(axis.travel[0] + share * axis.length, "mm", 4),
        step=lambda axis: next((step for step, least in _STEPS if axis.length >= least), _STEPS[-1][0]),
        place=lambda point: ", ".join(f'"{round(1e3 * float(each)) + 0:d} mm"' for each in point),
        mm=partial(format_quantity, unit="mm"),
    )


def _setups(machine: Machine) -> Any:
    """Return the set-ups of the template, each a function of what it is mounted on.

    Where a direction is that of an axis, rotary axes stand at zero: there the workpiece lies as the machine's axes do.
    """
    still = {axis.name: "0 deg" for axis in machine.axes if axis.rotary and axis.travel[0] <= 0 <= axis.travel[1]}
    return _campaign_templates().get_template("setups.jinja").make_module({"still": still, "printer": _prints(machine)})


def _prints(machine: Machine) -> bool:
    """Return whether this is a printer, as the library and `init --from printer.cfg` name them."""
    return machine.name.startswith("3D printer")


def _dials(machine: Machine, setups: Any) -> Iterator[str]:
    """Yield set-ups that read across each linear axis along something straight."""
    ways = {_way(axis) for axis in _linear(machine)}
    for axis in _linear(machine):
        yield from (setups.dial(axis, way) for way in sorted(ways - {_way(axis)}))


def _tilts(what: str, ways: str, machine: Machine, setups: Any) -> Iterator[str]:
    """Yield set-ups that read angles as one axis moves.  ways : about which `what` reads; a mirror sees no roll"""
    for axis, way in product(_linear(machine), ways):
        if what == "level" or way != _way(axis):
            yield setups.tilt(what, axis, way)


def _middle(machine: Machine, **places: float) -> Array:
    """Return where the tool point is with all axes amid their travels.  places : of axes that are elsewhere, by name"""
    at = [places.get(axis.name, sum(axis.travel) / 2) for axis in machine.axes]
    middle: Array = machine.frames(np.array([at])).tcp[0]
    return middle


def _ball_bars(machine: Machine, setups: Any) -> Iterator[str]:
    station = [round(float(each), 9) + 0.0 for each in _middle(machine)]
    for one, other in combinations(sorted({_way(axis) for axis in _linear(machine)}), 2):
        yield setups.ball_bar({"xz": "zx"}.get(one + other, one + other), station)


def _spheres(machine: Machine, setups: Any) -> Iterator[str]:
    """Yield three spheres about the middle of what the tool reaches, at different radii and heights."""
    rotary, linear = [axis for axis in machine.axes if axis.rotary], _linear(machine)
    if not rotary:
        yield from _board(machine, setups)
    if not rotary or {_way(axis) for axis in linear} != {*"xyz"}:  # a probe comes to a ball from all sides
        return
    reach = min(axis.length for axis in linear) / 6
    shares = {"low": (1.0, 0.0, -0.5), "high": (-0.5, 0.8, 0.5), "third": (-0.5, -0.8, 0.1)}
    centre = _middle(machine, **{axis.name: 0.0 for axis in rotary})
    about = next((axis.origin for axis in rotary if axis.letter == "C"), None)
    if about is not None:
        centre[:2] = about[:2]
    balls = _lowered(machine, {name: reach * np.array(each) for name, each in shares.items()})
    balls = balls or {"one": reach * np.array(shares["low"])}  # no tool gets between three: one of them tells much
    yield setups.spheres({name: centre + each for name, each in balls.items()}, rotary)


def _lowered(machine: Machine, balls: Mapping[str, Array]) -> dict[str, Array]:
    """Return balls as high as leaves room for tool, holder and nose at each of them; none where no height does.

    A part that comes over the post of another ball, turned by right angles, has to begin above that; no post is higher
    than the nose at the lowest ball, for nobody says how wide the machine is behind it.
    """
    places, cycle = np.array([*balls.values()]), Cycle((_DIAMETER + machine.nose.stylus) / 2)
    aside, top = cycle.radius + cycle.clear + cycle.back, _DIAMETER / 2 + CLEAR + _WRITTEN
    apart = np.abs(places[:, None, :2] - places[None, :, :2]).max(axis=2)
    rise, low = places[None, :, 2] - places[:, None, 2], float(places[:, 2].min())
    share = min(1.0, (machine.tool_length - top) / max(float(rise.max()), _WRITTEN))
    for part in parts(machine):
        over = (apart < aside + part.radius + top) & (rise > 0)
        share = min(share, float(np.min((part.start - top) / np.where(over, rise, 1.0), where=over, initial=1.0)))
    level = np.any((apart < aside + parts(machine)[0].radius + top) & ~np.eye(len(places), dtype=bool))
    if share < 0 or level:
        return {}
    return {name: at * [1, 1, 0] + [0, 0, low + share * (at[2] - low)] for name, at in balls.items()}


def _board(machine: Machine, setups: Any) -> Iterator[str]:
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
    free = max(z - _DEPTH, 0.0)
    lift = min(2 * arm, free)
    every = _CROSS if arm >= _FULL else _CROSS[:4]
    crosses = ({name: np.array(at) * [arm, arm, lift] for name, *at in some} for some in (every, _CROSS[:4]))
    balls = next(filter(None, (_lowered(machine, cross) for cross in crosses)), None)
    if balls is None:
        return
    yield setups.board(balls, axes["Z"].travel[1] - axes["Z"].overrun)
    centre = _middle(machine, Z=axes["Z"].travel[0] + _BELOW)
    aside = np.array([x / 2, y / 2, 0.0]) - [arm + _ROOM, arm + _ROOM, 0.0]
    rise = float(np.ptp([at[2] for at in balls.values()]))
    riser = min(_OVERLAP * rise, (free - rise) / max(risers for *_, risers in _PLACED))
    riser = np.floor(riser / _WRITTEN) * _WRITTEN if riser >= _RISER else 0.0
    for number, (way, turn, risers) in enumerate(_PLACED[: 5 if arm >= _FULL else 7], start=1):
        yield setups.placement(number, centre + aside * [*way, 0] + [0.0, 0.0, risers * riser], turn, risers * riser)


class Offer(NamedTuple):
    """words : what people call an instrument, in all of the languages; setups : their texts for a machine"""

    words: str
    setups: _Setups


def _probes(machine: Machine, setups: Any) -> Iterable[str]:
    """Return a probe that reads the height of the bed where Z is lowest, at places of X and Y."""
    axes = {axis.name: axis for axis in _linear(machine)}
    return [setups.probe(*map(axes.get, "XYZ"))] if {*"XYZ"} <= set(axes) else []


def _indexers(machine: Machine, setups: Any) -> Iterable[str]:
    """Return set-ups that read the angle of each rotary axis that turns about a direction of the workpiece."""
    rotary = (axis for axis in machine.axes if axis.rotary)
    return [setups.indexer(axis) for axis in rotary if abs(axis.direction[letter_direction(axis.letter)]) == 1]


def _trackers(machine: Machine, setups: Any) -> Iterable[str]:
    """Return a tracker that stands aside of what the tool reaches, at half its height."""
    return [setups.tracker(_middle(machine) - [0.0, sum(axis.length for axis in _linear(machine)), 0.0])]


OFFERED = {
    "dial": Offer(later("dial, dial gauge, dial indicator, indicator, straightedge, ruler"), _dials),
    "square": Offer(
        later("square, granite square, master square, dial on a square"),
        lambda machine, setups: starmap(setups.square, combinations(_linear(machine), 2)),
    ),
    "interferometer": Offer(
        later("laser, interferometer, laser interferometer"),
        lambda machine, setups: map(setups.laser, _linear(machine)),
    ),
    "ballbar": Offer(later("ball bar, double ball bar"), _ball_bars),
    "sphere": Offer(later("touch probe, sphere, spheres, ball, balls, ball plate"), _spheres),
    "probe": Offer(later("bed probe, probe, Z probe"), _probes),
    "level": Offer(later("level, electronic level, spirit level, inclinometer"), partial(_tilts, "level", "xy")),
    "autocollimator": Offer(later("autocollimator, collimator"), partial(_tilts, "autocollimator", "xyz")),
    "indexer": Offer(later("rotary indexer, indexer, rotary calibrator, polygon, reference encoder"), _indexers),
    "tracker": Offer(later("tracker, laser tracker"), _trackers),
}
"""The instruments whose set-ups follow from the machine alone."""
