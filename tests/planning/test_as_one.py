"""What is not seen as a whole: the common scale of three spheres is said, with its size, until something shows it."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from axiscal.estimation.case import Case
from axiscal.planning.unseen import hidden_of, uniform_parts
from axiscal.present.demo import description

SCALE = "cannot see the common scale of X, Y and Z: a bar of known length"


@cache
def case_of(*numbers: int, aligned: bool = True) -> Case:
    """Return the case, which takes a second, of the demo's campaign with some of spheres, bar and laser."""
    campaign = description()
    target, setups = replace(campaign.target, aligned=aligned), tuple(campaign.setups[n] for n in numbers)
    return Case(replace(campaign, setups=setups, target=target))


def test_a_laser_shows_it_and_a_bar_whose_length_nobody_knows_does_not() -> None:
    lasered, barred = case_of(0, 2), case_of(0, 1)
    assert not any(SCALE in hidden.text for hidden in hidden_of(lasered))
    assert uniform_parts(lasered.yardstick)[0] < 0.1e-6
    assert any(SCALE in hidden.text for hidden in hidden_of(barred))


def test_how_a_part_lies_is_said_where_it_counts() -> None:
    counted, aligned = case_of(0, aligned=False), case_of(0)
    assert any("how the part lies" in hidden.text for hidden in hidden_of(counted))
    assert not any("how the part lies" in hidden.text for hidden in hidden_of(aligned))


def test_it_is_as_much_as_a_fit_of_seven_takes_off() -> None:
    """Three shifts, three turns and one strain fitted to what is not seen, one direction of it after the other."""
    yardstick = case_of(0, aligned=False).yardstick
    poses = yardstick.volume.inside
    hidden = yardstick.errors.rows_at(poses, np.zeros_like(poses)) @ yardstick.unseen
    tips = yardstick.errors.frames(poses).tcp
    x, y, z = (tips - tips.mean(axis=0)).T
    o, i = np.zeros_like(x), np.ones_like(x)
    shifts = np.array([[i, o, o], [o, i, o], [o, o, i]])
    turns = np.array([[o, -z, y], [z, o, -x], [-y, x, o]])
    strain = np.array([[x, y, z]])

    def left(*columns: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> float:
        design = np.concatenate(columns).transpose(2, 1, 0).reshape(3 * len(x), -1)
        flat = hidden.reshape(3 * len(x), -1)
        rest = flat - design @ np.linalg.lstsq(design, flat, rcond=None)[0]
        return float(np.sum(rest**2)) / len(x)

    scale, turn = uniform_parts(yardstick)
    assert scale**2 == pytest.approx(left(shifts, turns) - left(shifts, turns, strain), rel=1e-6, abs=0)
    assert turn**2 == pytest.approx(left(shifts, strain) - left(shifts, turns, strain), rel=1e-6, abs=0)
