"""One axis of a metre under a laser, a dial on a scale or a tape: lead errors, and what comes with them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from axiscal.numerics import Array
from tests.zoo.animals import Animal, Job, Met, Slope
from tests.zoo.answers import Answer
from tests.zoo.running import rows_of

LENGTH = 1000.0
EXPANSION = 11.7e-3
"""Of steel, um per mm and K."""
SETUP = "laser along X"
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


def out_and_back(targets: int, runs: int) -> tuple[Array, Array]:
    """Return positions and sides of a standard test: out and back between the ends, so many times."""
    out = np.linspace(0.0, LENGTH, targets)
    x = np.concatenate([out, out[::-1]] * runs)
    sides = np.tile(np.repeat([1.0, -1.0], targets), runs)
    return x, sides


def written(rule: Rule, x: Array, sides: Array, values: Array) -> str:
    """Return READINGS.csv; the display shows steps."""
    shown = np.round(values / rule.step) * rule.step
    ways = np.where(sides > 0, "X+", "X-")
    rows = zip([SETUP] * len(x), np.round(x, 3).tolist(), ways, np.round(shown, 3).tolist(), strict=True)
    return rows_of("setup,X_mm,approach,value_um", rows)


def lead(slope: float, rule: Rule, warm: float = 0.0, targets: int = 11, runs: int = 5) -> Callable[[int], Met]:
    """Return how an axis with a lead error is met.  slope : um/m; warm : what is measured, K above 20 degC"""

    def met(seed: int) -> Met:
        rng = np.random.default_rng((seed, 1))
        x, sides = out_and_back(targets, runs)

        def curve(at: Array, side: Array) -> Array:
            return slope / 1000 * at - 1.0 * side

        shown = curve(x, sides) + EXPANSION * warm * x + rng.normal(0, rule.noise, len(x))
        shown -= shown[0]
        return Met(written(rule, x, sides, shown), AxisTruth(curve, line(x, shown, rule.noise)))

    return met


_SLOPES = (5, 10, 20, 40, 60, 100)
LEADS = tuple(
    Animal(f"lead error: {slope} um/m by {rule.name}", rule.job, lead(slope, rule), quick=quick)
    for rule in (LASER, SCALE, TAPE)
    for slope in _SLOPES
    for quick in [slope == 20 or (rule is LASER and slope in (5, 100))]
)
