"""How well a machine will be known after a plan, and at best."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from axiscal.description.target import Target
from axiscal.estimation.accuracy.expanded import expanded_floor
from axiscal.estimation.accuracy.yardstick import Accuracy, Yardstick
from axiscal.estimation.belief import Belief
from axiscal.estimation.case import Case
from axiscal.estimation.knowledge import Knowledge
from axiscal.estimation.promise.posterior import gain
from axiscal.estimation.promise.problem import Problem, problem
from axiscal.estimation.promise.spaces import Given
from axiscal.estimation.promise.type_b_columns import Contribution, contributions
from axiscal.estimation.promise.unknowns import space_of
from axiscal.estimation.timed import timed
from axiscal.exceptions import PlanError
from axiscal.measurement.place import Place
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import blank_readings, places_of
from axiscal.numerics import Array


class WantedAccuracy(NamedTuple):
    """A target accuracy, and its floor after endless readings, m."""

    name: str
    limit: float
    floor: float


def asked(target: Target, yardstick: Yardstick) -> tuple[WantedAccuracy, ...]:
    """Return the accuracies that a target asks for; a campaign ends at the first that is reached."""
    rms, worst = yardstick.floors
    found = [] if target.rms is None else [WantedAccuracy("rms", target.rms, rms)]
    found += [] if target.worst is None else [WantedAccuracy("worst", target.worst, worst)]
    found += [] if target.expanded is None else [WantedAccuracy("U", target.expanded, expanded_floor(yardstick).space)]
    return tuple(found)


def promised(case: Case, knowledge: Knowledge, places: Sequence[Place]) -> Accuracy:
    """Return how well the machine would be known after readings at these places, whatever they showed."""
    return case.yardstick.measure(knowledge.read(blank_readings(case.description.setups, places)).belief)


def foreseen(case: Case, readings: Sequence[Reading], places: Sequence[Place]) -> Knowledge:
    """Return what readings and those to come would make known, with all that a result counts, at the case's sizes.

    places : of the readings to come, whatever they will show
    It includes type B errors, such as that of a laser's wavelength, and what wanders with time; J leaves them out.
    """
    together = timed(case, [*readings, *blank_readings(case.description.setups, places)]).readings
    if not together:
        return case.knowledge
    answer = _given(case, together)[1].answer()
    return Knowledge(case.observation, Belief(answer.mean, (answer.covariance + answer.covariance.T) / 2))


class Blank(NamedTuple):
    """Readings to come with their times, as a problem, and everything at the case's sizes."""

    readings: tuple[Reading, ...]
    posed: Problem
    found: Given


def blank_problem(case: Case, places: Sequence[Place]) -> Blank:
    """Return the readings of a plan, at least one, whatever they will show."""
    readings = timed(case, blank_readings(case.description.setups, places)).readings
    return Blank(readings, *_given(case, readings))


def unseen_parts(case: Case, places: Sequence[Place]) -> list[tuple[Contribution, Array]]:
    """Return type B causes, and by what one standard deviation moves what readings would say, (answered,) m and rad.

    places : of the readings; those causes are left out whose effect follows from the values that are read
    """
    readings, posed, found = blank_problem(case, places)
    at = places_of(case.observation.setups, readings)
    every = contributions(case.observation, at, usual=case.description.usual)
    causes = [each for each in every if not each.row.of_values]
    moved = gain(posed, found, posed.rows[:, : len(causes)])  # their columns come first
    return list(zip(causes, moved.T, strict=True))


def _given(case: Case, readings: Sequence[Reading]) -> tuple[Problem, Given]:
    """Return readings as a problem, and everything at the case's sizes."""
    posed = problem(case.observation, readings, case.sizes, case.inherited, case.description.usual)
    found = space_of(posed).given(np.zeros(len(posed.sizes)))
    if found is None:
        raise PlanError("the stated sizes differ by more than 15 digits", "Look at the std of errors and unknowns")
    return posed, found


def reachable_rms(case: Case) -> float:
    """Return the RMS over the volume that endless readings would leave, m."""
    return case.yardstick.floors[0]
