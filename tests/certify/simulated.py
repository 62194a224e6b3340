"""Random machines for a running LinuxCNC, each with programs of three to five readings: quick, for time is real."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from axiscal.description.campaign import campaign_from_texts
from axiscal.exceptions import InputError, ProgramError
from axiscal.machine.axis import Axis
from axiscal.machine.description import Machine
from axiscal.measurement.candidates import chart_candidates
from axiscal.measurement.reading import Place
from axiscal.measurement.setup import Setup
from axiscal.ports.linuxcnc.tables import pivots
from axiscal.programs import dialect, programs
from tests.certify.gcode import plan_on, random_machine, setups_of
from tests.generators.texts import campaign_text, setup_text
from tests.linuxcnc.lab import Joint, Settings, files

PROGRAMS = 8
"""For each machine: one LinuxCNC runs them one after the other."""

ACCELERATION = 5e4
"""mm/s², deg/s²"""
_BEYOND = 1e-6
"""mm or deg, of LinuxCNC's limits beyond the travel: where it stands at the end of a program is off by rounding."""


@dataclass(frozen=True)
class Job:
    """A program, with the plan that it is of.  places : numbered from 1"""

    text: str
    setup: Setup
    places: tuple[Place, ...]


@dataclass(frozen=True)
class Simulated:
    """A machine with its programs, and the LinuxCNC that runs them.

    joints : in the order of their numbers; order : index of each of the machine's axes among them
    ball : (3,) m, what a nest holds; bar : (3,) m and the length of a bar about it; None where nothing is in touch
    """

    machine: Machine
    joints: tuple[Joint, ...]
    order: tuple[int, ...]
    settings: Settings
    jobs: tuple[Job, ...]
    ball: tuple[float, ...] | None = None
    bar: tuple[tuple[float, ...], float] | None = None


def random_simulated(seed: int) -> Simulated:
    """Return the machine of a seed: every second one is driven in its own coordinates, the others hold what touches."""
    rng = np.random.default_rng(seed)
    kinds: tuple[Callable[[np.random.Generator], Simulated | None], ...] = (_apart, _nest, _apart, _bar)
    while (made := kinds[seed % len(kinds)](rng)) is None:
        pass  # where nothing is reached, or no tool can be drawn back, another machine is drawn
    return made


def _apart(rng: np.random.Generator) -> Simulated:
    """Return axes of any names and travels, in any order of moves, with readings at the ends of their travels too."""
    drawn = random_machine(rng)
    machine = replace(drawn, axes=tuple(_quick(axis, rng) for axis in drawn.axes))
    letters = [name for name in "XYZABC" if name in {axis.name for axis in machine.axes}]
    ends = [_written(machine.axis(name)) for name in letters]
    limits = [(low - _BEYOND, high + _BEYOND) for low, high in ends]
    joints = tuple(Joint(n, *each, 5000.0, ACCELERATION) for n, each in zip(letters, limits, strict=True))
    order = tuple(letters.index(axis.name) for axis in machine.axes)
    jobs: list[Job] = []
    while len(jobs) < PROGRAMS:
        plan = plan_on(machine, rng)
        settle, reading = float(rng.choice([0.1, 0.15])), float(rng.choice([0.0, 0.15]))
        driving = plan.setups[0].driving
        driving = replace(driving, feed=None if driving.feed is None else 0.1, dwell=bool(rng.random() < 0.9))
        quick = [replace(each, driving=driving, settle=settle, reading_time=reading) for each in plan.setups]
        plan = replace(plan, setups=tuple(quick))
        few = min(len(plan.places), int(rng.integers(3, 6)))
        plan = replace(plan, places=tuple(replace(each, setup=plan.places[0].setup) for each in plan.places[:few]))
        (setup,), (program,) = setups_of(plan), plan.programs("linuxcnc")
        jobs.append(Job(program.text, setup, plan.places))
    return Simulated(machine, joints, order, Settings(), tuple(jobs))


def _quick(axis: Axis, rng: np.random.Generator) -> Axis:
    """Return an axis that is fast, and whose travel holds zero, where LinuxCNC homes it."""
    low, high = axis.travel
    shift = min(max(0.0, low), high) if low > 0 else max(high, low) if high < 0 else 0.0
    speed = float(rng.uniform(5, 30) if axis.rotary else rng.uniform(0.5, 2))
    return replace(axis, travel=(low - shift, high - shift), speed=speed)


def _written(axis: Axis) -> tuple[float, float]:
    """Return the travel in mm or deg, without the noise of binary numbers, as somebody would type it."""
    low, high = (round(math.degrees(end) if axis.rotary else 1e3 * end, 9) for end in axis.travel)
    return low, high


_TABLE = """
name = "swivelling table"
chain = "w-C'-{swivel}'-b-X-Y-Z-t"
[tool]
length = "{tool} mm"
"""
_AXIS = """[axes.{name}]
travel = ["{low} {unit}", "{high} {unit}"]
speed = "{speed} {unit}/s"
"""
_ERRORS = '[errors]\nEXX = { std = "10 um" }\n'
_NEST = """
machine = "machine.toml"
[[artefacts]]
name = "ball"
balls = {{ one = ["{} mm", "{} mm", "{} mm"] }}
[[setups]]
name = "nest"
instrument = "rtest"
artefact = "ball"
approach = "both"
stroke = "5 mm"
"""


def _nest(rng: np.random.Generator) -> Simulated | None:
    """Return a table C on a swivel A or B, as LinuxCNC's trt-kins has it, and a ball that is held."""
    swivel, tool = str(rng.choice(["A", "B"])), round(float(rng.uniform(50, 150)), 3)
    across, height, at = (np.round(rng.uniform(low, high, n), 3) for low, high, n in _PLACES)
    line = (0.0, float(across[0]), float(height[0])) if swivel == "A" else (float(across[0]), 0.0, float(height[0]))
    origins = {swivel: line, "C": (*np.round(rng.uniform(-20, 20, 2), 3).tolist(), float(height[0]))}
    text = _TABLE.format(swivel=swivel, tool=tool)
    for name in ("X", "Y", "Z", swivel, "C"):
        low, high = (-400, 400) if name in "XYZ" else (-110, 110) if name == swivel else (-180, 180)
        unit, speed = ("deg", 900) if name in origins else ("mm", 1200)
        text += _AXIS.format(name=name, low=low, high=high, unit=unit, speed=speed)
        if name in origins:
            texts = ", ".join(f'"{value} mm"' for value in origins[name])
            text += f'origin = [{texts}]\ndirection = "reversed"\n'
    campaign = campaign_from_texts(_NEST.format(*at), "campaign.toml", text + _ERRORS, "machine.toml")
    jobs = _in_touch(campaign.machine, campaign.setups[0], rng)
    if jobs is None:
        return None
    nominal, letters = pivots.pivots(campaign.machine, {}), ["X", "Y", "Z", swivel, "C"]
    hal = pivots.write(nominal, "mm")
    hal += f"net tool-length motion.tooloffset.z => {nominal.kinematics}.tool-offset\n"
    hal += "net kinstype-select motion.analog-out-03 => motion.switchkins-type\n"
    joints = tuple(Joint(name, -500.0, 500.0, 5000.0, ACCELERATION) for name in letters)
    settings = _switched(joints, Settings(hal, f"{nominal.kinematics} sparm=identityfirst"))
    order = tuple(letters.index(axis.name) for axis in campaign.machine.axes)
    return Simulated(campaign.machine, joints, order, settings, jobs, ball=tuple((at * 1e-3).tolist()))


_PLACES = ((-30, 30, 1), (-200, -50, 1), (-120, 120, 3))
"""mm: across the bed and the height of the swivel, and where the ball stands on the table."""


def _switched(joints: tuple[Joint, ...], settings: Settings) -> Settings:
    """Return settings in which M428 and M429 are what they are in LinuxCNC's own configurations."""
    words = {"m428": 1, "m429": 0}
    subs = {
        f"{word}.ngc": f"o<{word}> sub\nM68 E3 Q{q}\nM66 E0 L0\no<{word}> endsub\nM2\n" for word, q in words.items()
    }
    remaps = "".join(f"REMAP = {word.upper()} modalgroup=10 ngc={word}\n" for word in words)
    ini = files(joints, settings)["machine.ini"]
    ini = ini.replace("[RS274NGC]\n", f"[RS274NGC]\nSUBROUTINE_PATH = .\n{remaps}")
    return replace(settings, beside={**subs, "machine.ini": ini})


_MILL = """
name = "mill"
chain = "w-Y'-X'-b-Z-t"
[tool]
length = "80 mm"
"""
_BAR = campaign_text(
    "machine.toml",
    setup_text("bar", "ballbar", length="{} mm", station=["{} mm", "{} mm", "{} mm"], plane="{}", approach="both"),
)


def _bar(rng: np.random.Generator) -> Simulated | None:
    """Return a machine of three slides that carry a bar round its centre."""
    text = _MILL + "".join(_AXIS.format(name=n, low=-500, high=500, unit="mm", speed=1200) for n in "XYZ")
    length, centre = round(float(rng.uniform(60, 300)), 3), np.round(rng.uniform(-100, 100, 3), 3)
    plane = str(rng.choice(["xy", "yz", "zx"]))
    said = _BAR.format(length, *centre, plane)
    campaign = campaign_from_texts(said, "campaign.toml", text + _ERRORS, "machine.toml")
    jobs = _in_touch(campaign.machine, campaign.setups[0], rng)
    if jobs is None:
        return None
    joints = tuple(Joint(name, -500.0, 500.0, 5000.0, ACCELERATION) for name in "XYZ")
    order = tuple("XYZ".index(axis.name) for axis in campaign.machine.axes)
    about = (tuple((centre * 1e-3).tolist()), length * 1e-3)
    return Simulated(campaign.machine, joints, order, Settings(), jobs, bar=about)


def _in_touch(machine: Machine, given: Setup, rng: np.random.Generator) -> tuple[Job, ...] | None:
    """Return programs over places of a chart, drawn without order; None where there are no such places."""
    chart = given.chart
    assert chart is not None
    driving = replace(given.driving, feed=0.2, dwell=True)
    setup = replace(given, driving=driving, settle=0.1, reading_time=0.15)
    jobs: list[Job] = []
    while len(jobs) < PROGRAMS:
        count = int(rng.integers(3, 6))
        try:
            poses, approaches = chart_candidates(machine, setup, chart, 60)
            chosen = rng.choice(len(poses), count, replace=False)
            sides = approaches[chosen].astype(int).tolist()
            pairs = zip(poses[chosen].tolist(), sides, strict=True)
            places = tuple(Place(setup.name, tuple(pose), tuple(side)) for pose, side in pairs)
            (program,) = programs(machine, [setup], places, dialect("linuxcnc"))
        except (InputError, ProgramError, ValueError):
            return None
        jobs.append(Job(program.text, setup, places))
    return tuple(jobs)
