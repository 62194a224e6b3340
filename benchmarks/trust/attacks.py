"""Ways of being wrong, and what one machine's readings promise under each of them beside what is true."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from axiscal.campaign.wrong_unit import refuse_implausible
from axiscal.estimation.accuracy.expanded import expanded
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.exceptions import ReadingError
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.measurement.simulation import Simulator, VirtualMachine
from axiscal.numerics import Array
from axiscal_core.instrument import TOOL
from axiscal_core.machine import Machine
from axiscal_core.threads import one_thread
from benchmarks.trust.benches import BENCHES, Changes, Name, case_of, visits

_POSES, _MINUTE = 200, 60.0
_MOVED = 50e-6
"""m, by which a tool is longer, or an axis line elsewhere, than stated."""

Field = Callable[[Array, Array, float], Array]
"""Poses (m, q), sides of the first axis (m,), a place of the machine's own -> what it does besides, (m,) um."""
Shown = Callable[[Array, Array, np.random.Generator], Array]
"""Values (m, k) um, shares of the time (m, 1), the machine's own chance -> what is read, (m, k) um."""
Passing = Callable[[Array, Array, Array], Array]
"""Poses (m, q), sides of the first axis, shares of the time (m,) -> what readings show besides that is no error of the
machine, (m,) um."""
Moved = Callable[[Machine], Machine]
"""A machine as stated -> one whose chain is another."""
Offsets = Mapping[str, Mapping[str, float]]
"""By set-up and name."""


def _as_stated(machine: Machine) -> Machine:
    return machine


@dataclass(frozen=True, slots=True)
class Attack:
    """words : what is wrong; stated : what is stated otherwise; truth : what is not as stated

    field : besides, along the first direction that is read
    passing : besides, along the same, on readings alone; shown : what becomes of the readings
    count : of readings, that of the bench unless said
    tool : another tool than stated, just so much, which is no error of the machine; chain : other axis lines, which are
    lengths : what no reading shows counts; else instruments and temperatures are perfect
    """

    words: str
    truth: Changes = ()
    stated: Changes = ()
    field: Field = lambda x, side, place: 0.0 * side
    passing: Passing = lambda x, side, along: 0.0 * along
    shown: Shown = lambda values, along, rng: values
    bench: Name = "axis"
    count: int | None = None
    tool: Moved = _as_stated
    chain: Moved = _as_stated
    lengths: bool = False


def _bad(count: int) -> Shown:
    def shown(values: Array, _along: Array, rng: np.random.Generator) -> Array:
        which = rng.choice(len(values), count, replace=False)
        wrong = 8.0 * np.isin(np.arange(len(values)), which) * rng.choice([-1.0, 1.0], len(values))
        spoilt = values.copy()
        spoilt[:, 0] += wrong
        return spoilt

    return shown


def _strained(strain: float) -> Passing:
    """Return what makes all readings longer about the middle of the travel.  strain : um/m"""
    return lambda x, side, along: strain * (x[:, 0] - 0.5)


def _drifting(shape: Callable[[Array], Array]) -> Shown:
    def shown(values: Array, along: Array, _rng: np.random.Generator) -> Array:
        drifted = values.copy()
        drifted[:, :1] += 10 * shape(along)
        return drifted

    return shown


def _hump(x: Array, centre: float, width: float) -> Array:
    hump: Array = np.exp(-(((x[:, 0] - centre) / width) ** 2))
    return hump


def _twist(x: Array) -> Array:
    twist: Array = (x[:, 0] / 0.2 - 1) * (x[:, 1] / 0.2 - 1)
    return twist


def _sag(x: Array) -> Array:
    sag: Array = np.sin(np.pi * x[:, 0] / 0.4) * np.sin(np.pi * x[:, 1] / 0.4)
    return sag


def _longer(machine: Machine) -> Machine:
    return replace(machine, tool=(0.0, 0.0, -machine.tool_length - _MOVED))


def _elsewhere(name: str) -> Moved:
    """Return a machine whose rotary axis lies elsewhere, along x."""

    def moved(machine: Machine) -> Machine:
        axes = [
            replace(axis, origin=(axis.origin[0] + _MOVED, *axis.origin[1:])) if axis.name == name else axis
            for axis in machine.axes
        ]
        return replace(machine, axes=tuple(axes))

    return moved


ATTACKS = (
    Attack("nothing"),
    Attack("errors five times as large as stated", (("STD", "50 um"),)),
    Attack("errors a fifth as large", (("STD", "2 um"),)),
    Attack("five times as smooth", (("LENGTH", "1000 mm"),)),
    Attack("a fifth as smooth", (("LENGTH", "40 mm"), ("knots = 21", "knots = 51"))),
    Attack("noise five times as stated", (("NOISE", "2.5 um"),)),
    Attack("drift, 10 µm", shown=_drifting(lambda t: t)),
    Attack("drift that levels off, 10 µm", shown=_drifting(lambda t: 1 - np.exp(-3 * t))),
    Attack("zero that comes and goes, 10 µm", passing=lambda x, side, t: 10 * np.sin(np.pi * t) ** 2),
    Attack("growth that comes and goes, 10 µm/m", passing=lambda x, side, t: 10 * x[:, 0] * (1 - np.abs(2 * t - 1))),
    Attack("one bad reading, 8 µm", shown=_bad(1)),
    Attack("three bad readings, 8 µm", shown=_bad(3)),
    Attack("4 K too warm", field=lambda x, side, c: 11.7 * 4 * (x[:, 0] - 0.5)),
    Attack("step, 15 µm", field=lambda x, side, c: np.where(x[:, 0] > c, 15.0, 0.0)),
    Attack("pitch of 10 mm, 5 µm", field=lambda x, side, c: 5 * np.sin(2 * np.pi * x[:, 0] / 0.01)),
    Attack("pitch of 50 mm, 5 µm", field=lambda x, side, c: 5 * np.sin(2 * np.pi * x[:, 0] / 0.05)),
    Attack("bump of 30 mm, 12 µm", field=lambda x, side, c: 12 * _hump(x, c, 0.03)),
    Attack("reversal that varies, 8 µm", field=lambda x, side, c: 4 * side * _hump(x, c, 0.25)),
    Attack("values in mm, read as µm", shown=lambda v, t, rng: v / 1000),
    Attack("7 readings", count=7),
    Attack("sign turned", shown=lambda v, t, rng: -v),
    Attack("two axes: nothing", bench="plate"),
    Attack("two axes: twist, 20 µm", field=lambda x, side, c: 20 * _twist(x), bench="plate"),
    Attack("two axes: sag, 20 µm", field=lambda x, side, c: 20 * _sag(x), bench="plate"),
    Attack("five axes: nothing", bench="five axes"),
    Attack("five axes: tool 50 µm too long", bench="five axes", tool=_longer, stated=(("TOOL", "100 um"),)),
    Attack("five axes: pivot of B 50 µm aside", bench="five axes", chain=_elsewhere("B")),
    Attack("five axes: drift, 10 µm", shown=_drifting(lambda t: t), bench="five axes"),
    Attack("five axes: one bad reading, 8 µm", shown=_bad(1), bench="five axes"),
    Attack("five axes: step of X, 15 µm", field=lambda x, side, c: np.where(_x(x) > 0.0, 15.0, 0.0), bench="five axes"),
    Attack("lengths: nothing", lengths=True),
    Attack("lengths: laser, 5 µm/m", passing=_strained(5.0), lengths=True),
    Attack("lengths: material, 1 K", passing=_strained(11.7), lengths=True),
    Attack("lengths: 20 µm/m", passing=_strained(20.0), lengths=True),
)


def _x(poses: Array) -> Array:
    """Return the coordinate of X of the five axes, C B Y X Z, m."""
    along: Array = poses[:, 3]
    return along


@dataclass(frozen=True, slots=True)
class Outcome:
    """ratio : of true to promised RMS; inside : share of the volume no farther off than U

    withheld : nothing is promised, since the readings contradict each other
    """

    ratio: float
    inside: float
    withheld: bool


@dataclass(frozen=True, eq=False)
class Attacked:
    """A machine that is not as stated, and its readings.

    attack : how it is not; stated : the case; machine : the truth; own : a place of the machine's own, share of a metre
    """

    attack: Attack
    stated: Case
    machine: VirtualMachine
    own: float
    readings: tuple[Reading, ...]

    @property
    def column(self) -> int:
        """The direction along which the attack acts."""
        return 2 if self.attack.bench == "plate" else 0

    @property
    def places(self) -> tuple[Array, Array]:
        """Poses of the volume and the sides from which the axes come, (p, q) each."""
        low, high = np.array(self.stated.description.target.volume).T
        where = np.random.default_rng(1).uniform(low, high, (_POSES, len(low)))
        return where, np.where(np.arange(_POSES)[:, None] % 2 == 0, 1.0, -1.0) * np.ones_like(where)

    def sizes_left(self, estimated: Array) -> Array:
        """Return how far the tool is from what an estimate says, (p,) m, a shift and a turn of the part taken off.

        estimated : (p, 3) m
        """
        where, ways = self.places
        left = self.machine.deviation(where, ways) - estimated
        left[:, self.column] += 1e-6 * self.attack.field(where, ways[:, 0], self.own)
        left += _aside(self.stated.description.machine, (self.attack.chain,), where)
        moved = _moves(self.stated.description.machine.frames(where).tcp)
        fitted = np.linalg.lstsq(moved.reshape(-1, 6), left.ravel(), rcond=None)[0]
        size: Array = np.linalg.norm(left - moved @ fitted, axis=1)
        return size


def _moves(points: Array) -> Array:
    """Return what a shift by a metre and a turn by a radian, along and about x, y, z, do to points, (p, 3, 6)."""
    turns = np.cross(np.eye(3), (points - points.mean(axis=0))[:, None]).swapaxes(1, 2)
    return np.concatenate([np.broadcast_to(np.eye(3), turns.shape), turns], axis=2)


def attacked(attack: Attack, places: str, scales: str, seed: int) -> Attacked:
    """Return a machine and what is read of it."""
    stated = case_of(attack.bench, scales, attack.stated)
    actual = case_of(attack.bench, scales, (*attack.truth, *attack.stated), "off").description
    machine, rng = Simulator(actual.machine, actual.setups).drawn(seed), np.random.default_rng((seed, 4))
    machine, own = replace(machine, offsets=_with_tool(attack, machine.offsets)), float(rng.uniform(0.2, 0.8))
    taken = visits(attack.bench, scales, places, attack.count or BENCHES[attack.bench].readings, seed)
    poses, sides = (np.array([visit[part] for visit in taken], dtype=float) for part in (0, 1))
    read = np.array([machine.read_all(actual.setups[0], *visit, rng) for visit in taken]) * 1e6
    read[:, 0] += attack.field(poses, sides[:, 0], own)
    read += 1e6 * _aside(stated.description.machine, (attack.tool, attack.chain), poses)[:, : read.shape[1]]
    along = np.linspace(0, 1, len(read))
    read[:, 0] += attack.passing(poses, sides[:, 0], along)
    values = attack.shown(read, along[:, None], rng) * 1e-6
    readings = tuple(
        Reading("it", *visit, float(value[0]), others=tuple(value[1:].tolist()), time=_MINUTE * index)
        for index, (visit, value) in enumerate(zip(taken, values, strict=True))
    )
    return Attacked(attack, stated, machine, own, readings)


@one_thread()
def outcome(attack: Attack, places: str, scales: str, seed: int) -> Outcome:
    """Return what one machine's readings promise, and what is true."""
    met = attacked(attack, places, scales, seed)
    try:
        refuse_implausible([replace(each, line=1) for each in met.readings], met.stated.description, "readings")
    except ReadingError:
        return Outcome(np.nan, np.nan, withheld=True)
    described = met.stated.description
    setups = tuple(
        replace(setup, at_20=attack.lengths, stated=() if attack.lengths else _perfect(setup))
        for setup in described.setups
    )
    known = concluded(replace(met.stated, description=replace(described, setups=setups)), met.readings)
    belief = known.printed.belief
    size = met.sizes_left(known.estimate().deviation(*met.places))
    inside = float(np.mean(size <= expanded(known.case.yardstick, belief).space))
    return Outcome(float(np.sqrt(np.mean(size**2))) / known.accuracy.rms, inside, known.agreement.withheld)


def _perfect(setup: Setup) -> tuple[tuple[str, float], ...]:
    """Return sizes of nothing for what no reading shows."""
    kept = "temperature", "expansion"
    return tuple({row.name: 0.0 for row in setup.type_b if row.name not in kept}.items())


def _with_tool(attack: Attack, offsets: Offsets) -> Offsets:
    """Return what a machine's set-ups do not know; a tool that is put in is not another one by chance besides."""
    if attack.tool is _as_stated:
        return offsets
    return {name: {own: 0.0 if own in TOOL else value for own, value in each.items()} for name, each in offsets.items()}


def _aside(machine: Machine, moves: tuple[Moved, ...], poses: Array) -> Array:
    """Return how far the tool point stands off for another tool or other axis lines, workpiece frame, (m, 3) m."""
    stated = machine.frames(poses).tcp
    total: Array = np.zeros_like(stated)
    for moved in moves:
        total += moved(machine).frames(poses).tcp - stated
    return total
