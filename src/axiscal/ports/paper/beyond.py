"""Three joints again, where they are not what the paper assumes: one turns far, two act together, a station is unknown.

The same readings give two estimates of each: by the paper's method and by all of this package. The paper's is additive
and linear about the nominal machine and the stated station.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.absorbed import absorbed
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator, VirtualMachine
from axiscal.numerics import Array
from axiscal.numerics.threads import one_thread
from axiscal.units import to_unit

MACHINES = 3
"""Drawn for each: medians of so few are good to a third, which is less than what they show."""
_POSES = 200
"""Tool points at which estimates are compared: their RMS is known to a tenth."""
_DRAWN, _ASIDE = 101, 0.3
"""Points of a drawn curve, and where along its travel each other axis stands for it."""
_MICRO = 1e6
"""um in a metre."""
_SEED = 7
"""Any seed: the page is to be the same every time."""

Deviation = Callable[[Array], Array]
"""Poses (m, q) -> deviation of the tool point (m, 3), m."""

_AXES = """chain = "w-X'-b-Y-Z-t"
[axes.X]
travel = ["0 mm", "500 mm"]
[axes.Y]
travel = ["0 mm", "500 mm"]
[axes.Z]
travel = ["0 mm", "500 mm"]
[errors]
"""
_TURNING = """chain = "w-B'-b-X-Z-t"
[tool]
length = "100 mm"
[axes.X]
travel = ["-200 mm", "200 mm"]
[axes.Z]
travel = ["0 mm", "300 mm"]
[axes.B]
travel = ["-60 deg", "60 deg"]
[errors]
EXX = { std = "10 um", knots = 7 }
EZZ = { std = "10 um", knots = 7 }
EBB = { std = "10 mrad", knots = 7, length = "60 deg" }
A0B = { std = "10 mrad" }
C0B = { std = "10 mrad" }
X0B = { std = "1 mm" }
Z0B = { std = "1 mm" }
"""
_HEIGHTS = """EZX = { std = "10 um", knots = 7 }
EZY = { std = "10 um", knots = 7 }
EZZ = { std = "10 um", knots = 7 }
"""
_PLANE = 'EZXY = { std = "10 um", knots = [7, 7], length = ["200 mm", "200 mm"] }\n'
_PLACES = """EXX = { std = "10 um", knots = 7 }
EYY = { std = "10 um", knots = 7 }
EZZ = { std = "10 um", knots = 7 }
"""
_DIAL = '[[setups]]\nname = "dial"\ninstrument = "indicator"\ndirection = "z"\nnoise = "1 um"\nunknowns = {}\n'
_TRACKER = """[[setups]]
name = "tracker"
instrument = "tracker"
station = ["-800 mm", "-600 mm", "200 mm"]
noise = "1 um"
unknowns = {}
"""
_TRACERS = "".join(
    f"""[[setups]]
name = "station {number}"
instrument = "tracer"
station = {json.dumps(place)}
noise = "0.5 um"
unknowns = {{ zero = "10 mm", station_x = "50 mm", station_y = "50 mm", station_z = "50 mm" }}
"""
    for number, place in enumerate(
        (
            ("-400 mm", "-400 mm", "0 mm"),
            ("900 mm", "-400 mm", "100 mm"),
            ("900 mm", "900 mm", "0 mm"),
            ("-300 mm", "900 mm", "800 mm"),
        ),
        start=1,
    )
)
"""Around the volume, one of them above: from there they see every direction."""


@dataclass(frozen=True, eq=False, slots=True)
class Scenario:
    """title, what : in words; truth, linear : machine.toml of what there is, and of what the linear method knows

    setups : of campaign.toml; readings : after how many both are compared; moving : index of the axis that is drawn
    """

    title: str
    what: str
    truth: str
    linear: str
    setups: str
    readings: tuple[int, ...]
    moving: int


@dataclass(frozen=True, eq=False, slots=True)
class Compared:
    """RMS in space at the tool of truth less estimate, constants taken off, m, (machines, readings): by both methods.

    along : (n,) in the unit; real, by_linear, by_whole : (n,) m, z of the first machine there, and both last estimates
    """

    scenario: Scenario
    linear: Array
    whole: Array
    along: Array
    real: Array
    by_linear: Array
    by_whole: Array
    unit: str


SCENARIOS = (
    Scenario(
        "A joint that turns far",
        "The first joint swings by ±60°; its angle is off by 10 mrad, its axis line by 1 mm and 10 mrad. "
        "A tracker reads x, y and z.",
        _TURNING,
        _TURNING,
        _TRACKER,
        (5, 12, 24),
        0,
    ),
    Scenario(
        "Two joints that act together",
        "The height has a part, 10 µm large, that belongs to the first two joints together. A dial reads the height.",
        _AXES + _HEIGHTS + _PLANE,
        _AXES + _HEIGHTS,
        _DIAL,
        (12, 24, 48, 72),
        0,
    ),
    Scenario(
        "A station that nobody knows",
        "Four tracers read distances in turn; each stands within 50 mm a coordinate of what is stated, its dead path "
        "within 10 mm (standard deviations).",
        _AXES + _PLACES,
        _AXES + _PLACES,
        _TRACERS,
        (40, 80),
        2,
    ),
)
"""Sizes at which the linear method fails; a machine in service is far from them."""


@one_thread()
def beyond() -> tuple[Compared, ...]:
    """Return all scenarios, simulated and estimated by both methods."""
    return tuple(_compared(scenario) for scenario in SCENARIOS)


def _compared(scenario: Scenario) -> Compared:
    real, known = _case(scenario, scenario.truth), _case(scenario, scenario.linear)
    low, high = np.array([axis.travel for axis in real.description.machine.axes]).T
    poses = np.random.default_rng(_SEED).uniform(low, high, (_POSES, len(low)))
    line = np.tile(low + _ASIDE * (high - low), (_DRAWN, 1))
    line[:, scenario.moving] = np.linspace(low[scenario.moving], high[scenario.moving], _DRAWN)
    missed = np.zeros((2, MACHINES, len(scenario.readings)))
    for seed in reversed(range(MACHINES)):  # the first one comes last and is drawn
        machine = Simulator(real.description.machine, real.description.setups).drawn(_SEED + seed)
        readings = _read(real, machine, max(scenario.readings), seed)
        for column, count in enumerate(scenario.readings):
            methods = _linear(known, readings[:count]), _whole(real, readings[:count])
            missed[:, seed, column] = [_missed(machine, method, poses) for method in methods]
    truth, by_linear, by_whole = (_centred(each(line)[:, 2]) for each in (_deviation(machine), *methods))
    unit = real.description.machine.axes[scenario.moving].unit
    along = to_unit(line[:, scenario.moving], unit)
    return Compared(scenario, missed[0], missed[1], along, truth, by_linear, by_whole, unit)


def _case(scenario: Scenario, machine: str) -> Case:
    head = 'machine = "m"\nusual = "off"\nsure = "exactly"\n'  # machines are drawn from what is stated, as in the paper
    text = f"{head}[target]\nreadings = {max(scenario.readings)}\n{scenario.setups}"
    return Case(campaign_from_texts(text, "campaign.toml", machine, "machine.toml"))


def _read(case: Case, machine: VirtualMachine, count: int, seed: int) -> list[Reading]:
    """Return readings at random poses, of the set-ups in turn."""
    rng, setups = np.random.default_rng((seed, _SEED)), case.description.setups
    low, high = np.array([axis.travel for axis in case.description.machine.axes]).T
    readings = []
    for index in range(count):
        setup, pose = setups[index % len(setups)], tuple(rng.uniform(low, high).tolist())
        value, *others = machine.read_all(setup, pose, (1,) * len(low), rng)
        readings.append(Reading(setup.name, pose, (1,) * len(low), value, others=tuple(others), time=0.0))
    return readings


def _linear(case: Case, readings: list[Reading]) -> Deviation:
    """Return what the paper's method makes of readings: once, about what was stated (B&H eq. 31-33)."""
    mean = absorbed(case, readings, {}).knowledge.belief.mean[: case.errors.size]
    return lambda poses: case.errors.rows(poses, np.ones_like(poses)) @ mean


def _whole(case: Case, readings: list[Reading]) -> Deviation:
    estimate = concluded(case, readings).estimate()
    return lambda poses: estimate.deviation(poses, np.ones_like(poses))


def _deviation(machine: VirtualMachine) -> Deviation:
    return lambda poses: machine.deviation(poses, np.ones_like(poses))


def _missed(machine: VirtualMachine, method: Deviation, poses: Array) -> float:
    """Return the RMS in space of truth less estimate, constants taken off, m."""
    left = _centred(_deviation(machine)(poses) - method(poses))
    return float(np.sqrt(np.mean(np.sum(left**2, axis=1))))


def _centred(values: Array) -> Array:
    centred: Array = values - values.mean(axis=0)
    return centred


def numbers(found: tuple[Compared, ...]) -> list[dict[str, object]]:
    """Return the figures for `--json`, um."""
    return [
        {
            "title": each.scenario.title,
            "readings": list(each.scenario.readings),
            "linear_additive_um": (np.median(each.linear, axis=0) * _MICRO).tolist(),
            "whole_um": (np.median(each.whole, axis=0) * _MICRO).tolist(),
            "machines": MACHINES,
        }
        for each in found
    ]


def lines(found: tuple[Compared, ...]) -> list[str]:
    """Return the same as lines of a table for people."""
    rows = [f"Beyond the paper: RMS missed at the tool, um, median of {MACHINES} machines"]
    for each in found:
        rows += [each.scenario.title, f"{'readings':>10} {'linear, additive':>18} {'all of it':>12}"]
        medians = np.median(each.linear, axis=0) * _MICRO, np.median(each.whole, axis=0) * _MICRO
        rows += [f"{k:10d} {a:18.3g} {b:12.3g}" for k, a, b in zip(each.scenario.readings, *medians, strict=True)]
    return rows
