"""Climbs of many readings where one axis moves, in one search: each as by itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.design.gains.candidate_rows import Pool
from axiscal.design.gains.running_gains import Scores
from axiscal.design.plan.task import Task
from axiscal.design.step.best_step import best_of
from axiscal.design.step.parked_lines import best_of_each, one_line_each
from tests.generators.designs import levered, problem

BOTH = [0, 1]


def _one_axis_each(candidates: int = 80) -> Task:
    """Return levers, reversal and rests, with two set-ups in each of which one slide moves."""
    machine, setups = levered(30).observation.machine, levered(30).observation.setups
    return problem(machine, tuple(replace(s, moves=(k,)) for k, s in enumerate(setups, 1)), candidates)


def _planned(asked: Task, count: int, seed: int) -> Scores:
    scores = Scores(Pool(asked.observation, asked.lattice, asked.memory), asked.state)
    chosen = np.random.default_rng(seed).permutation(len(asked.lattice))[:count]
    scores.enter_all(asked.lattice.within(chosen))
    return scores


@pytest.mark.parametrize("seed", range(4))
def test_the_best_for_each_slot_is_what_a_search_for_it_alone_finds(seed: int) -> None:
    scores = _planned(_one_axis_each(), 9, seed)
    columns = scores.columns_without(range(9))
    reach = scores.state.root.of(columns)
    found = best_of_each(scores.scorer(), BOTH, columns[: scores.pool.size], reach)
    for slot in range(9):
        alone = best_of(scores.scorer_without(scores.known_without(slot)[1]), scores.pool.lattice)
        place = found.at(slot)
        scorer = scores.scorer_without(scores.known_without(slot)[1])
        assert scorer.at(int(place.setups[0]), place.poses, place.approaches)[0] == pytest.approx(alone.gain, rel=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_what_a_reading_gains_in_the_place_of_another_is_what_it_gains_once_that_has_left(seed: int) -> None:
    asked = _one_axis_each()
    scores = _planned(asked, 9, seed)
    places = asked.lattice.within(np.random.default_rng(seed + 100).permutation(len(asked.lattice))[:9])
    columns = scores.columns_without(range(9))
    reach = scores.state.root.of(columns)
    gains = scores.state.gains_grown(places, columns, reach)
    for slot in range(9):
        left, change = scores.known_without(slot)
        assert np.sum(reach[:, slot] ** 2) == pytest.approx(-change.gain, rel=1e-9)
        assert gains[slot] == pytest.approx(left.entered(places.at(slot))[1].gain, rel=1e-9)


def test_only_set_ups_in_which_one_axis_moves_freely_are_searched_together() -> None:
    asked = _one_axis_each()
    assert one_line_each(asked.observation, BOTH)
    first, second = asked.observation.setups
    stepped = replace(first, raster=tuple(0.01 * (k == 1) for k in range(3)))
    assert not one_line_each(problem(asked.observation.machine, (stepped, second), 30).observation, BOTH)
    assert not one_line_each(levered(30).observation, BOTH)
