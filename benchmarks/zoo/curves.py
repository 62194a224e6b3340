"""Curves of one axis that the model has no row for, and lead errors: each a function of numpy."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from axiscal.numerics import Array
from benchmarks.zoo.animals import Animal
from benchmarks.zoo.axes import (
    EXPANSION,
    LASER,
    LENGTH,
    PERFECT,
    SCALE,
    TAPE,
    Curve,
    Places,
    Rule,
    Shown,
    Visits,
    anywhere,
    as_planned,
    even,
    everywhere,
    nothing,
    read,
)


def straight(slope: float) -> Curve:
    """Return a lead error with a backlash of 2 um.  slope : um/m"""
    return lambda x, side: slope / 1000 * x - side


def warm(kelvin: float) -> Shown:
    """Return what a scale or part that is so much above 20 degC shows."""
    return lambda visits: EXPANSION * kelvin * visits.x


def bowed(x: Array, side: Array) -> Array:
    """Return a gentle bow of 8 um with a backlash of 2 um."""
    return 8 * np.sin(np.pi * x / LENGTH) - side


def pitch(x: Array, side: Array) -> Array:
    """Return a screw's error of 3 um in each turn of 10 mm."""
    return 3 * np.sin(2 * np.pi * x / 10 + 0.7) - side


def sawtooth(x: Array, side: Array) -> Array:
    """Return a scale put together from pieces of 100 mm, 8 um off at each joint."""
    found: Array = 8 * ((x / 100 + 0.3) % 1 - 0.5) - side
    return found


def air(visits: Visits) -> Array:
    """Return what air conditioning does to readings that are a minute apart: 5 um every 11 min."""
    found: Array = 5 * np.sin(2 * np.pi * np.arange(len(visits.x)) / 11 + 0.7)
    return found


def rack(x: Array, side: Array) -> Array:
    """Return four racks of 250 mm that are not set in line, each with a pitch of its own."""
    number = np.clip((x // 250).astype(int), 0, 3)
    within = x - 250.0 * number
    joints, slopes = np.array([0.0, 15.0, -8.0, 12.0]), np.array([0.03, -0.02, 0.05, 0.01])
    found: Array = joints[number] + slopes[number] * within - 3 * side
    return found


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
    found: Array = own - shape.mean(axis=0)
    return found


def heated(x: Array, side: Array) -> Array:
    """Return the mean over the test of an axis that heat travels along."""
    time = np.linspace(0, 1, 200)[:, None]
    mean: Array = (25 * (1 - np.exp(-3 * time)) * np.exp(-np.ravel(x) / (200 + 900 * time))).mean(axis=0)
    return mean - side


def returning(visits: Visits) -> Array:
    """Return a zero that goes away by 10 um and comes back while the axis goes out and back."""
    return 10 * np.sin(np.pi * np.minimum(np.arange(len(visits.x)) / 21, 1))


def _out_and_back(_: np.random.Generator) -> Visits:
    return even(11, 1)


def _three_again(_: np.random.Generator) -> Visits:
    test = even(11, 1)
    return Visits(np.append(test.x, [0, 500, 1000, 500, 0]), np.append(test.sides, [1, 1, 1, -1, -1]))


def _twice_anywhere(rng: np.random.Generator) -> Visits:
    first, second = anywhere(rng, 22), anywhere(rng, 22)
    return Visits(np.append(first.x, second.x), np.append(first.sides, second.sides))


def _planned(readings: int) -> Places:
    return lambda _: as_planned(_CLOSE, readings)


def _iso(_: np.random.Generator) -> Visits:
    return even(11, 5)


def _once(_: np.random.Generator) -> Visits:
    test = even(11, 1)
    return Visits(test.x[:11], test.sides[:11])


def worn(x: Array, side: Array) -> Array:
    """Return a backlash that grows from 2 to 12 um, and a gentle bow."""
    return 3 * np.sin(np.pi * x / LENGTH) + side * (1 + 5 * x / LENGTH)


def wave(x: Array, side: Array) -> Array:
    """Return a wave of 5 um every 40 mm with a backlash of 2 um."""
    return 5 * np.sin(2 * np.pi * x / 40 + 1) - side


_SLOPES = (5, 10, 20, 40, 60, 100)
LEADS = (
    Animal("lead error: 20 um/m by laser, eleven readings", LASER.job, read(straight(20), LASER, _once, slope=True)),
    *(
        Animal(
            f"lead error: {slope} um/m by {rule.name}",
            rule.job,
            read(straight(slope), rule, _iso, slope=True),
        )
        for rule in (LASER, SCALE, TAPE)
        for slope in _SLOPES
    ),
)
WARM = tuple(
    Animal(
        f"scale or part not at 20 degC: {kelvin:+g} K, by laser",
        LASER.job,
        read(straight(40), LASER, _iso, warm(kelvin), slope=True),
    )
    for kelvin in (0.5, -1.0, 1.5)  # as the usual 1 K scatters
)


@dataclass(frozen=True, slots=True)
class Foreign:
    """A truth that no row of the model has.  beside : what readings show beside it; cause : words that name it"""

    kind: str
    curve: Curve
    beside: Shown = nothing
    cause: str = ""

    def animal(self, places: str) -> Animal:
        """Return it as an animal of the zoo."""
        met = read(self.curve, LASER, _PLACES[places], self.beside)
        return Animal(f"{self.kind}: {places}", LASER.job, met, self.cause)


_PLACES = everywhere(21, 2, LASER.job)
_TURN = r"multiples? of|period"
_WAY = r"since it turned|way after"
FOREIGN = (
    Foreign("pitch", pitch, cause=_TURN),
    Foreign("growing pitch", lambda x, side: 2 * x / LENGTH * (pitch(x, side) + side) - side, cause=_TURN),
    Foreign("pitch of half an inch", lambda x, side: 5 * np.sin(2 * np.pi * x / 12.7) - side, cause=_TURN),
    Foreign("sawtooth of 100 mm", sawtooth, cause=_TURN),
    Foreign("air conditioning", bowed, air, _TURN),
    Foreign("steps of a rack", rack),
    Foreign("backlash with a way of 60 mm", backlash, winding(60), _WAY),
    Foreign("backlash with a way of 300 mm", backlash, winding(300), _WAY),
    Foreign("thermal front", heated, front, r"warm(s|ed|ing) (up|while)|\bdrift\b"),
)
NOTHING_WRONG = Animal("nothing wrong: random", LASER.job, read(bowed, LASER, _twice_anywhere))
_CLOSE = replace(PERFECT, target="7 um")
_EXACT = Rule("laser", LASER.noise, LASER.step, PERFECT)
ONCE = Animal(
    "zero that comes back: out and back once",
    PERFECT,
    read(bowed, _EXACT, _out_and_back, returning),
    "changes meanwhile",
    asked=True,
)
AGAIN = Animal("zero that comes back: three places again", PERFECT, read(bowed, _EXACT, _three_again, returning))
FEW = tuple(
    Animal(f"few readings: {name}, {count} planned", _CLOSE, read(curve, LASER, _planned(count)), "NOT CHECKED")
    for name, curve in (("backlash from 2 to 12 um", worn), ("wave of 40 mm", wave))
    for count in (5, 8)
)
CURVES = (
    NOTHING_WRONG,
    *FEW,
    ONCE,
    AGAIN,
    *(each.animal(places) for each in FOREIGN for places in _PLACES),
    Animal(
        "half-read axis: 0 to 500 mm",
        LASER.job,
        read(wavy, LASER, lambda _: even(11, 2, LENGTH / 2)),
        r"not read|0 to 500|500 to 1000",
    ),
)
