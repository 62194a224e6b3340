"""One axis of a metre under a laser, a dial on a scale or a tape: lead errors, and what comes with them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from axiscal.numerics import Array
from tests.zoo.animals import Animal, Job, Met, Slope
from tests.zoo.answers import Answer
from tests.zoo.running import planned, rows_of

LENGTH = 1000.0
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


@dataclass(frozen=True, slots=True)
class AxisTruth:
    """curve : at 20 degC; read : the straight line through the readings, None where the truth has no slope"""

    curve: Curve
    read: Line | None = None

    def left(self, answer: Answer) -> Array:
        """Return what the table leaves at a thousand places from both sides, its mean taken off, um."""
        where, values = answer.axis_table("X")
        x = np.linspace(0.0, LENGTH, 1001)
        sides = np.array([1.0, -1.0])
        left = np.array(
            [
                self.curve(x, side + 0 * x) - np.interp(x, where, column)
                for side, column in zip(sides, values, strict=True)
            ]
        )
        return left.ravel() - left.mean()

    def promised(self, answer: Answer) -> float:
        """Return U with the table, um."""
        return answer.expanded_with_tables()

    def kept(self, answer: Answer) -> Slope | None:
        """Return what the table keeps of the slope that was read."""
        if self.read is None:
            return None
        where, values = answer.axis_table("X")
        return Slope(float(np.polyfit(where, values.mean(axis=0), 1)[0]), self.read.slope, self.read.std)


@dataclass(frozen=True, slots=True)
class Visits:
    """Where an axis is read, in order.  x : (m,) mm; sides : (m,) +1 or -1"""

    x: Array
    sides: Array

    @property
    def ways(self) -> Array:
        """How far the axis has come since it turned, at least what it comes from beyond the ends, mm."""
        turned = np.concatenate([[True], self.sides[1:] != self.sides[:-1]])
        begun = self.x[np.maximum.accumulate(np.where(turned, np.arange(len(self.x)), 0))]
        ways: Array = np.abs(self.x - begun)
        return ways


def even(targets: int = 21, runs: int = 2, end: float = LENGTH) -> Visits:
    """Return a standard test: out and back between the ends, so many times."""
    out = np.linspace(0.0, end, targets)
    x = np.concatenate([out, out[::-1]] * runs)
    return Visits(x, np.tile(np.repeat([1.0, -1.0], targets), runs))


def odd(targets: int = 21, runs: int = 2) -> Visits:
    """Return a standard test with three readings more at places of no round number."""
    test = even(targets, runs)
    return Visits(np.append(test.x, [137.3, 482.7, 861.1]), np.append(test.sides, [1.0, 1.0, 1.0]))


def anywhere(rng: np.random.Generator, readings: int = 48) -> Visits:
    """Return places anywhere, out and back."""
    out, back = np.sort(rng.uniform(0, LENGTH, (2, readings // 2)))
    return Visits(np.concatenate([out, back[::-1]]), np.repeat([1.0, -1.0], readings // 2))


def as_planned(job: Job, readings: int = 48) -> Visits:
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
Shown = Callable[[Visits], Array]
"""What readings show beside the truth, um."""


def nothing(visits: Visits) -> Array:
    """Return nothing for each visit."""
    return np.zeros(len(visits.x))


def read(curve: Curve, rule: Rule, places: Places, beside: Shown = nothing, *, slope: bool = False) -> Meet:
    """Return how an axis is met.  slope : whether its slope has to be kept"""

    def met(seed: int) -> Met:
        rng = np.random.default_rng((seed, 1))
        visits = places(rng)
        shown = curve(visits.x, visits.sides) + beside(visits) + rng.normal(0, rule.noise, len(visits.x))
        shown -= shown[0]
        straight = line(visits.x, shown, rule.noise) if slope else None
        return Met(written(rule, visits, shown), AxisTruth(curve, straight))

    return met


def straight(slope: float) -> Curve:
    """Return a lead error with a backlash of 2 um.  slope : um/m"""
    return lambda x, side: slope / 1000 * x - side


def warm(kelvin: float) -> Shown:
    """Return what a scale or part that is so much above 20 degC shows."""
    return lambda visits: EXPANSION * kelvin * visits.x


def _five_runs(_: np.random.Generator) -> Visits:
    return even(11, 5)


def _even(_: np.random.Generator) -> Visits:
    return even()


def _odd(_: np.random.Generator) -> Visits:
    return odd()


def _planned(_: np.random.Generator) -> Visits:
    return as_planned(LASER.job)


def _half(_: np.random.Generator) -> Visits:
    return even(11, 2, LENGTH / 2)


def bowed(x: Array, side: Array) -> Array:
    """Return a gentle bow of 8 um with a backlash of 2 um."""
    return 8 * np.sin(np.pi * x / LENGTH) - side


def pitch(x: Array, side: Array) -> Array:
    """Return a screw's error of 3 um in each turn of 10 mm."""
    return 3 * np.sin(2 * np.pi * x / 10 + 0.7) - side


def growing_pitch(x: Array, side: Array) -> Array:
    """Return a screw's error of each turn that grows from nothing to 6 um."""
    return 6 * x / LENGTH * np.sin(2 * np.pi * x / 10 + 0.7) - side


def rack(x: Array, side: Array) -> Array:
    """Return four racks of 250 mm that are not set in line, each with a pitch of its own."""
    number = np.clip((x // 250).astype(int), 0, 3)
    within = x - 250.0 * number
    joints, slopes = np.array([0.0, 15.0, -8.0, 12.0]), np.array([0.03, -0.02, 0.05, 0.01])
    return joints[number] + slopes[number] * within - 3 * side


def wavy(x: Array, side: Array) -> Array:
    """Return an axis that goes on differently in its second half."""
    return 8 * np.sin(2 * np.pi * x / 500) + 0.03 * np.maximum(x - 500, 0) - side


def backlash(x: Array, side: Array) -> Array:
    """Return a backlash of 16 um and a gentle bow."""
    return 5 * np.sin(np.pi * x / LENGTH) - 8 * side


def winding(way: float) -> Shown:
    """Return what is missing of that backlash soon after the axis has turned.  way : mm"""
    return lambda visits: 16 * visits.sides * np.exp(-visits.ways / way)


def front(visits: Visits) -> Array:
    """Return what heat that travels from the motor's end adds to the mean over the test: up to 25 um."""
    time = np.linspace(0, 1, len(visits.x))[:, None]
    shape = 25 * (1 - np.exp(-3 * time)) * np.exp(-visits.x / (200 + 900 * time))
    own: Array = np.diagonal(shape)
    return own - shape.mean(axis=0)


def heated(x: Array, side: Array) -> Array:
    """Return the mean over the test of an axis that heat travels along."""
    time = np.linspace(0, 1, 200)[:, None]
    mean: Array = (25 * (1 - np.exp(-3 * time)) * np.exp(-np.ravel(x) / (200 + 900 * time))).mean(axis=0)
    return mean - side


_SLOPES = (5, 10, 20, 40, 60, 100)
LEADS = tuple(
    Animal(
        f"lead error: {slope} um/m by {rule.name}",
        rule.job,
        read(straight(slope), rule, _five_runs, slope=True),
        quick=slope == 20 or (rule is LASER and slope in (5, 100)),
    )
    for rule in (LASER, SCALE, TAPE)
    for slope in _SLOPES
)
WARM = tuple(
    Animal(
        f"scale or part not at 20 degC: {kelvin:+g} K, by laser",
        LASER.job,
        read(straight(40), LASER, _five_runs, warm(kelvin), slope=True),
        quick=kelvin == 1.3,
    )
    for kelvin in (1.3, -0.7)
)
_EVERYWHERE: dict[str, Places] = {"even": _even, "even, three odd": _odd, "random": anywhere, "planned": _planned}


def _of_places(kind: str, curve: Curve, beside: Shown = nothing, cause: str = "", quick: str = "") -> list[Animal]:
    return [
        Animal(f"{kind}: {name}", LASER.job, read(curve, LASER, places, beside), cause, quick=name == quick)
        for name, places in _EVERYWHERE.items()
    ]


NOTHING_WRONG = Animal("nothing wrong: random", LASER.job, read(bowed, LASER, anywhere), quick=True)
CURVES = (
    NOTHING_WRONG,
    *_of_places("pitch", pitch, cause=r"multiples? of|period", quick="even"),
    *_of_places("growing pitch", growing_pitch, cause=r"multiples? of|period"),
    *_of_places("steps of a rack", rack, quick="planned"),
    *_of_places("backlash with a way of 60 mm", backlash, winding(60), cause="since it turned|way after"),
    *_of_places(
        "backlash with a way of 300 mm", backlash, winding(300), cause="since it turned|way after", quick="even"
    ),
    *_of_places("thermal front", heated, front, cause=r"warm(s|ed|ing) (up|while)|\bdrift", quick="even"),
    Animal(
        "half-read axis: 0 to 500 mm", LASER.job, read(wavy, LASER, _half), r"not read|0 to 500|500 to 1000", quick=True
    ),
)
