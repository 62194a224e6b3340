"""One axis of a metre under a laser, a dial on a scale or a tape: lead errors, and what comes with them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from axiscal.numerics import Array
from benchmarks.zoo.animals import Job, Met, Slope, Truth
from benchmarks.zoo.answers import Answer
from benchmarks.zoo.running import planned, rows_of

LENGTH, OVERRUN = 1000.0, 1.0
EXPANSION = 11.7e-3
"""Of steel, um per mm and K."""
SETUP = "laser along X"
Meet = Callable[[int], Met]
Curve = Callable[[Array, Array], Array]
"""From positions (mm) and sides (+1 or -1) to the deviation at 20 degC, um."""


@dataclass(frozen=True, slots=True)
class Rule:
    """What an axis is read by: its noise, um, and its step, um; the job that says so."""

    name: str
    noise: float
    step: float
    job: Job


def _job(*stated: tuple[str, str]) -> Job:
    return Job("one-axis", ("laser",), "10 um", stated)


def _instead(noise: str, more: str = "") -> tuple[tuple[str, str], ...]:
    """Return how a dial is put in the place of the laser."""
    line = f'noise = "{noise}"\n{more}'
    return ('instrument = "interferometer"', 'instrument = "indicator"'), ('# noise = "0.3 um" ', f"{line}#")


PERFECT = _job(
    ("[target]", '[target]\nrefers_to = "as read"'),
    ("# noise", 'type_b = { scale = "0 um/m", air = "0 um/m", cosine = "0 mrad" }\n# noise'),
)
"""A laser without an error, and a machine that is to be good as warm as it is."""
LASER = Rule("laser", 0.3, 0.01, _job())
SCALE = Rule("dial on a scale", 2.0, 1.0, _job(*_instead("2 um", 'resolution = "1 um"\n')))
TAPE = Rule("tape", 10.0, 10.0, _job(*_instead("10 um", 'resolution = "10 um"\n')))


@dataclass(frozen=True, slots=True)
class Line:
    """A straight line through readings: its slope and the standard deviation that noise gives it, um/mm."""

    slope: float
    std: float


def line(x: Array, values: Array, noise: float) -> Line:
    """Return the straight line of least squares.  x : (m,) mm; values, noise : um"""
    return Line(float(np.polyfit(x, values, 1)[0]), noise / float(np.std(x) * np.sqrt(len(x))))


@dataclass(frozen=True)
class AxisTruth(Truth):
    """curve : at 20 degC; read : the straight line through the readings, None where the truth has no slope

    end : of the travel, mm
    """

    curve: Curve
    read: Line | None = None
    end: float = LENGTH

    def left(self, answer: Answer) -> Array:
        """Return what the table leaves at a thousand places from both sides, its mean taken off, um."""
        where, values = answer.axis_table("X")
        x, sides = np.linspace(0.0, self.end, 1001), (1.0, -1.0)
        ways = zip(sides, values, strict=True)
        left = np.concatenate([self.curve(x, side + 0 * x) - np.interp(x, where, column) for side, column in ways])
        found: Array = left - left.mean()
        return found

    def kept(self, answer: Answer) -> Slope | None:
        """Return what the table keeps of the slope that was read."""
        if self.read is None:
            return None
        where, values = answer.axis_table("X")
        return Slope(float(np.polyfit(where, values.mean(axis=0), 1)[0]), self.read.slope, self.read.std)


@dataclass(frozen=True, slots=True)
class Visits:
    """Where an axis is read, in order.  x : (m,) mm; sides : (m,) +1 or -1; parked : before, which nobody tells, mm"""

    x: Array
    sides: Array
    parked: float = 0.0

    @property
    def ways(self) -> Array:
        """How far the axis has come since it turned, (m,) mm: it goes past a place that it cannot come to as asked."""
        stands, turned, going, found = self.parked, self.parked, 0.0, list[float]()
        for x, side in zip(self.x.tolist(), self.sides.tolist(), strict=True):
            if (x - stands) * side < OVERRUN:
                turned = x - side * OVERRUN
            elif side != going:
                turned = stands
            found.append(abs(x - turned))
            stands, going = x, side
        return np.array(found)


def even(targets: int, runs: int, end: float = LENGTH) -> Visits:
    """Return a standard test: out and back between the ends, so many times."""
    out = np.linspace(0.0, end, targets)
    x = np.concatenate([out, out[::-1]] * runs)
    return Visits(x, np.tile(np.repeat([1.0, -1.0], targets), runs))


def odd(targets: int, runs: int) -> Visits:
    """Return a standard test with three readings more at places of no round number."""
    test = even(targets, runs)
    return Visits(np.append(test.x, [137.3, 482.7, 861.1]), np.append(test.sides, [1.0, 1.0, 1.0]))


def anywhere(rng: np.random.Generator, readings: int) -> Visits:
    """Return places anywhere, out and back."""
    out, back = np.sort(rng.uniform(0, LENGTH, (2, readings // 2)))
    return Visits(np.concatenate([out, back[::-1]]), np.repeat([1.0, -1.0], readings // 2))


def as_planned(job: Job, readings: int) -> Visits:
    """Return the places that a plan asks for."""
    points = planned(job, readings)
    x = np.array([float(point["position"]["X"]) for point in points])
    return Visits(x, np.array([1.0 if point["approach"]["X"] == "+" else -1.0 for point in points]))


def written(rule: Rule, visits: Visits, values: Array) -> str:
    """Return READINGS.csv; the display shows steps."""
    shown = np.round(np.round(values / rule.step) * rule.step, 4)
    ways = np.where(visits.sides > 0, "X+", "X-")
    rows = zip([SETUP] * len(shown), np.round(visits.x, 3).tolist(), ways, shown.tolist(), strict=True)
    return rows_of("setup,X_mm,approach,value_um", rows)


Places = Callable[[np.random.Generator], Visits]
"""Where an axis is read, of which some places may be drawn."""
Shown = Callable[[Visits], Array]
"""What readings show beside the truth, um."""


def nothing(visits: Visits) -> Array:
    """Return nothing for each visit."""
    return np.zeros(len(visits.x))


def read(curve: Curve, rule: Rule, places: Places, beside: Shown = nothing, *, slope: bool = False) -> Meet:
    """Return how an axis is met.  slope : whether its slope has to be kept"""

    def met(seed: int) -> Met:
        rng = np.random.default_rng((seed, 1))
        visits = replace(places(rng), parked=LENGTH * np.random.default_rng((seed, 2)).uniform())
        shown = curve(visits.x, visits.sides) + beside(visits) + rng.normal(0, rule.noise, len(visits.x))
        shown -= shown[0]
        straight = line(visits.x, shown, rule.noise) if slope else None
        return Met(written(rule, visits, shown), AxisTruth(curve, straight))

    return met


def everywhere(targets: int, runs: int, job: Job) -> dict[str, Places]:
    """Return the kinds of places with about as many readings each."""
    count = 2 * targets * runs
    return {
        "planned": lambda _: as_planned(job, count),
        "even": lambda _: even(targets, runs),
        "even, three odd": lambda _: odd(targets, runs),
        "random": lambda rng: anywhere(rng, count),
    }
