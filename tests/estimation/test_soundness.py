"""An estimation that is read from a file: each of its parts spoiled alone is noticed; its misfit written out."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from axiscal.belief import Belief, Innovations
from axiscal.estimation.absorbed import Absorbed
from axiscal.estimation.believed import plausible_with_sides, trusted, with_sides
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.knowledge import Knowledge
from axiscal.estimation.soundness import is_sound
from axiscal.inference.outliers import Doubt, Verdict
from tests.generators.laser_axis import CASE, machine, read

READINGS = read(machine(4), 12)
KNOWN = concluded(CASE, READINGS)
COUNT = len(READINGS)


def stage(name: str, **fields: Any) -> Callable[[Estimation], Estimation]:
    """Return what changes fields of one stage."""

    def change(found: Estimation) -> Estimation:
        return replace(found, stages=found.stages._replace(**{name: replace(getattr(found.stages, name), **fields)}))

    return change


def verdict(*weights: float, doubts: tuple[Doubt, ...] = ()) -> Verdict:
    """Return a verdict of readings."""
    return Verdict(doubts, weights)


def knowledge(belief: Belief) -> Knowledge:
    """Return a belief as what is known."""
    return Knowledge(KNOWN.knowledge.observation, belief)


def surprise(value: float = 0.0, std: float = 1.0) -> tuple[Innovations, ...]:
    """Return one surprise of this kind among right ones."""
    right = [Innovations(np.zeros(1), np.ones(1))] * (COUNT - 1)
    return (Innovations(np.array([value]), np.array([std])), *right)


BELIEF = KNOWN.knowledge.belief
SIZE = BELIEF.size
PLAUSIBLE = KNOWN.stages.judged.plausibility


@pytest.mark.parametrize(
    "change",
    [
        lambda found: found,
        stage("learnt", verdict=verdict(*[0.0] * COUNT)),
        stage("learnt", verdict=verdict(*[1.0] * COUNT)),
        stage("absorbed", verdict=verdict(0.5)),
        stage("learnt", verdict=verdict(doubts=(Doubt(0, 5.0, 0.0), Doubt(COUNT - 1, 5.0, 0.0)))),
        lambda found: replace(found, innovations=surprise(-1e300, 1e-300)),
    ],
)
def test_what_just_fits_together_is_sound(change: Callable[[Estimation], Estimation]) -> None:
    assert is_sound(change(KNOWN))


@pytest.mark.parametrize(
    "change",
    [
        lambda found: replace(found, readings=found.readings[:-1]),
        lambda found: replace(found, innovations=found.innovations[1:]),
        stage("absorbed", innovations=KNOWN.stages.absorbed.innovations[1:]),
        *(stage("timed", **{name: getattr(KNOWN.stages.timed, name)[1:]}) for name in ("given", "readings", "ends")),
        stage("timed", ends=(math.nan, *KNOWN.stages.timed.ends[1:])),
        stage("judged", plausibility=replace(PLAUSIBLE, sizes=PLAUSIBLE.sizes[1:])),
        stage("judged", plausibility=replace(PLAUSIBLE, sizes=(math.inf, *PLAUSIBLE.sizes[1:]))),
        stage(
            "judged", plausibility=replace(PLAUSIBLE, mean=PLAUSIBLE.mean[1:], covariance=PLAUSIBLE.covariance[1:, 1:])
        ),
        stage("judged", plausibility=replace(PLAUSIBLE, mean=PLAUSIBLE.mean * math.nan)),
        stage("judged", implausible={0: Doubt(-1, 20.0, 0.0, True)}),
        stage("learnt", verdict=verdict(doubts=(Doubt(COUNT, 5.0, 0.0),))),
        stage("absorbed", verdict=verdict(doubts=(Doubt(-1, 5.0, 0.0),))),
        stage("learnt", verdict=verdict(*[1.0] * (COUNT + 1))),
        stage("absorbed", verdict=verdict(*[1.0] * (COUNT + 1))),
        stage("learnt", verdict=verdict(-1e-9)),
        stage("absorbed", verdict=verdict(1.0 + 1e-9)),
        stage("learnt", case="a case"),
        stage("absorbed", knowledge=knowledge(Belief(np.zeros(SIZE + 1), np.eye(SIZE + 1)))),
        lambda found: replace(found, outliers=(Doubt(COUNT, 5.0, 0.0),)),
        lambda found: replace(found, outliers=("a doubt",)),
        lambda found: replace(found, case="a case"),
        lambda found: replace(found, stated=None),
        lambda found: replace(found, knowledge=knowledge(Belief(np.zeros(SIZE - 1), np.eye(SIZE - 1)))),
        lambda found: replace(found, banded=found.banded._replace(knowledge=knowledge(Belief(np.zeros(1), np.eye(1))))),
        lambda found: replace(found, banded=found.banded._replace(case=None)),
        lambda found: replace(found, accuracy=found.accuracy._replace(rms=math.nan)),
        *(
            lambda found, wrong=wrong: replace(found, innovations=surprise(*wrong))
            for wrong in ((math.nan, 1.0), (0.0, math.inf), (0.0, 0.0), (0.0, -1.0))
        ),
    ],
)
def test_each_part_that_does_not_fit_is_noticed(change: Callable[[Estimation], Estimation]) -> None:
    assert not is_sound(change(KNOWN))


@pytest.mark.parametrize(("count", "left_out"), [(5, 1), (9, 1), (10, 1), (11, 2), (12, 2)])
def test_the_misfit_is_the_scatter_without_the_largest_tenth(count: int, left_out: int) -> None:
    sizes = np.random.default_rng(count).permutation(np.arange(1.0, count + 1))
    found = replace(KNOWN, innovations=tuple(Innovations(np.array([2.0 * s]), np.array([2.0])) for s in sizes))
    assert found.misfit() == pytest.approx(np.sqrt(np.mean(np.arange(1.0, count - left_out + 1) ** 2)))


def test_a_reading_of_several_numbers_counts_by_their_mean_square_and_an_implausible_one_not_at_all() -> None:
    several = Innovations(np.array([3.0, 4.0]), np.array([1.0, 1.0]))
    impossible = Innovations(np.array([1e6]), np.array([1.0]))
    found = replace(KNOWN, innovations=(impossible, *[several] * 5), outliers=(Doubt(0, 99.0, 0.0, True),))
    assert found.misfit() == pytest.approx(np.sqrt(12.5))
    assert replace(found, innovations=(impossible, *[several] * 4)).misfit() == 1.0
    contradicted = replace(found, outliers=(Doubt(0, 99.0, 0.0),), innovations=(impossible, *[several] * 4))
    assert contradicted.misfit() == pytest.approx(np.sqrt(12.5))


def test_readings_that_are_doubted_are_not_believed_and_only_impossible_ones_contradict_nothing() -> None:
    found = replace(KNOWN, outliers=(Doubt(2, 99.0, 0.0, True), Doubt(5, 6.0, 0.1)))
    assert trusted(found) == [reading for index, reading in enumerate(found.readings) if index not in (2, 5)]
    assert with_sides(found) == trusted(found)
    assert plausible_with_sides(found) == [reading for index, reading in enumerate(found.readings) if index != 2]
    anywhere = tuple(replace(reading, approach=(0,)) for reading in found.readings)
    assert with_sides(replace(found, readings=anywhere)) == []
    assert plausible_with_sides(replace(found, readings=(*anywhere[:3], *found.readings[3:]))) == [*found.readings[3:]]


def test_weights_of_readings_beyond_the_verdict_are_one_and_of_implausible_ones_none() -> None:
    known = Absorbed.nothing(CASE, verdict(0.2, 0.4, 0.6))
    assert known.weights(0, 5, {}) == [0.2, 0.4, 0.6, 1.0, 1.0]
    assert known.weights(2, 5, {}) == [0.6, 1.0, 1.0]
    assert known.weights(3, 5, {}) == [1.0, 1.0]
    assert known.weights(4, 5, {}) == [1.0]
    assert known.weights(1, 2, {}) == [0.4]
    assert known.weights(1, 5, {2: Doubt(2, 99.0, 0.0, True)}) == [0.4, 0.0, 1.0, 1.0]
