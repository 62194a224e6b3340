"""`python -m benchmarks.beyond`: pictures of docs/evidence/equations.md, where joints are not what the paper assumes.

One joint turns far, two act together, a station is unknown. The same readings give two estimates of each: by the
paper's method and by all of this package. The paper's is additive and linear about the nominal machine and the stated
station.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.located import absorbed
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator, VirtualMachine
from axiscal.numerics import Array
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import proposed
from axiscal_core.threads import one_thread
from tests.docs.pictures import svg

PICTURES = Path(__file__).parents[1] / "docs" / "pictures"
NAMES = ("beyond-joint.svg", "beyond-plane.svg", "beyond-station.svg")
_MICRO = 1e6
MACHINES = 3
"""Drawn for each: medians of so few are good to a third, which is less than what they show."""
_POSES = 200
"""Tool points at which estimates are compared: their RMS is known to a tenth."""
_SEED = 7
"""Any seed: the pictures are to be the same every time."""

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
    """truth, linear : machine.toml of what there is, and of what the linear method knows

    setups : of campaign.toml; readings : after how many both are compared
    """

    truth: str
    linear: str
    setups: str
    readings: tuple[int, ...]


@dataclass(frozen=True, eq=False, slots=True)
class Compared:
    """RMS in space at the tool of truth less estimate, constants off, m, (machines, readings): by both methods."""

    scenario: Scenario
    linear: Array
    whole: Array


SCENARIOS = (
    Scenario(
        # The first joint swings by ±60°; its angle is off by 10 mrad, its axis line by 1 mm and 10 mrad.
        _TURNING,
        _TURNING,
        _TRACKER,
        (5, 12, 24),
    ),
    Scenario(
        # The height has a part, 10 µm large, that belongs to the first two joints together.
        _AXES + _HEIGHTS + _PLANE,
        _AXES + _HEIGHTS,
        _DIAL,
        (12, 24, 48, 72),
    ),
    Scenario(
        # Each tracer stands within 50 mm a coordinate of what is stated, its dead path within 10 mm.
        _AXES + _PLACES,
        _AXES + _PLACES,
        _TRACERS,
        (40, 80),
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
    missed = np.zeros((2, MACHINES, len(scenario.readings)))
    for seed in range(MACHINES):
        machine = Simulator(real.description.machine, real.description.setups).drawn(_SEED + seed)
        readings = _read(real, machine, max(scenario.readings), seed)
        for column, count in enumerate(scenario.readings):
            methods = _linear(known, readings[:count]), _whole(real, readings[:count])
            missed[:, seed, column] = [_missed(machine, method, poses) for method in methods]
    return Compared(scenario, missed[0], missed[1])


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


_BRIDGE = """chain = "w-b-Y-X-Z-t"
[axes.X]
travel = ["0 mm", "4000 mm"]
speed = "4 m/min"
[axes.Y]
travel = ["0 mm", "2000 mm"]
speed = "4 m/min"
[axes.Z]
travel = ["0 mm", "1000 mm"]
speed = "2 m/min"
[errors]
EXX = { std = "20 um", knots = 9, length = "800 mm" }
EYX = { std = "20 um", knots = 9, length = "800 mm" }
EYY = { std = "20 um", knots = 9, length = "600 mm" }
EZY = { std = "20 um", knots = 9, length = "600 mm" }
EZZ = { std = "10 um", knots = 9, length = "400 mm" }
"""
_TRACKER_24 = """machine = "m"
[target]
readings = 24
[[setups]]
name = "tracker"
instrument = "tracker"
station = ["-1000 mm", "-1000 mm", "0 mm"]
noise = "5 um"
unknowns = {}
setup_time = "5 min"
settle = "1 s"
reading_time = "2 s"
"""


def costs() -> str:
    """Return how well a large machine is known against minutes: the same 24 readings by their worth, and by the way."""
    case = Case(campaign_from_texts(_TRACKER_24, "c.toml", _BRIDGE, "m.toml"))
    plan = proposed(case, Limits(24), 600).plan.places
    rows = zip(plan.poses.tolist(), plan.approaches.tolist(), strict=True)
    readings = [Reading("tracker", tuple(p), tuple(int(a) for a in s), 0.0, others=(0.0, 0.0)) for p, s in rows]
    lines = {
        "one by one, the best first (the paper)": _known(case, _best_first(case, readings)),
        "by the way": _known(case, readings),
    }
    return svg({"x": "minutes", "y": "standard deviation, RMS, um", "lines": lines})


def _known(case: Case, readings: list[Reading]) -> tuple[list[float], list[float]]:
    """Return minutes and RMS over the volume, um, after each reading."""
    minutes, rms, known, last = [0.0], [_rms(case, [])], 0.0, None
    for count, reading in enumerate(readings, 1):
        known += case.seconds_of(last, reading)
        last = reading
        minutes.append(known / 60)
        rms.append(_rms(case, readings[:count]))
    return minutes, rms


def _best_first(case: Case, readings: list[Reading]) -> list[Reading]:
    chosen: list[Reading] = []
    left = list(readings)
    while left:
        best = min(range(len(left)), key=lambda i: _rms(case, [*chosen, left[i]]))
        chosen.append(left.pop(best))
    return chosen


def _rms(case: Case, readings: list[Reading]) -> float:
    belief = case.knowledge.read(readings).belief if readings else case.knowledge.belief
    return case.yardstick.measure(belief).rms * _MICRO


def picture(found: Compared) -> str:
    """Return what both methods miss against the number of readings."""
    count = list(found.scenario.readings)
    lines = {
        "linear and additive": (count, np.median(found.linear, axis=0) * _MICRO),
        "with everything": (count, np.median(found.whole, axis=0) * _MICRO),
    }
    return svg({"x": "readings", "y": "missed, um", "lines": lines, "log": True})


if __name__ == "__main__":
    for name, found in zip(NAMES, beyond(), strict=True):
        (PICTURES / name).write_text(picture(found))
    (PICTURES / "beyond-costs.svg").write_text(costs())
