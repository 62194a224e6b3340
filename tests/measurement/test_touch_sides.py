"""Three touches of a sphere: what a larger radius shows, and from where axes come, by matrices of the tests' own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.exceptions import DescriptionError
from axiscal.machine import load_machine
from axiscal.measurement.candidates import chart_candidates
from axiscal.measurement.observation import Observation
from axiscal.measurement.setup import Setup
from axiscal.measurement.touched import cycle_of, touch_frames
from axiscal.numerics import Array
from tests.description.test_sites import SPHERES, TOUCHED, described
from tests.generators.kinematics import pose_with_tip, stem, tip
from tests.generators.machines import random_machine, random_poses

DMU = load_machine("dmu60")


def setup_of() -> Setup:
    return described(f'{SPHERES}{TOUCHED}touches = 3\napproach = "both"\n').setups[0]


def candidates() -> tuple[Setup, Array, Array]:
    setup = setup_of()
    assert setup.chart is not None
    return setup, *chart_candidates(DMU, setup, setup.chart, 60)


def test_a_larger_radius_shows_as_three_touches_find_their_centre() -> None:
    """Each touch says one coordinate of the centre: the tip, met a radius R + r off, less R."""
    setup, poses, _ = candidates()
    ball, radius, larger = np.array([0.2, 0.0, -0.08]), 0.015, 20e-6
    for pose in poses[:20]:
        ways = touch_frames(DMU, pose[None])[0]
        np.testing.assert_allclose(ways @ ways.T, np.eye(3), atol=1e-12)
        np.testing.assert_allclose(ways[2], stem(DMU, pose), atol=1e-12)
        met = [pose_with_tip(DMU, pose, ball + (radius + larger) * way) for way in ways]
        along = [way @ tip(DMU, at) - radius for way, at in zip(ways, met, strict=True)]
        found = np.linalg.solve(ways, np.array(along))
        at = setup.places(pose[None])
        assert setup.shown(at, {"radius": larger})[0] == pytest.approx(ball - found, abs=1e-12)
        assert setup.own_slopes(at, ["radius"])[0, :, 0] == pytest.approx((ball - found) / larger)


def test_linear_axes_come_as_they_touch_and_not_as_they_came_to_the_ball() -> None:
    _, poses, approaches = candidates()
    linear = [k for k, axis in enumerate(DMU.axes) if not axis.rotary]
    for pose, come in zip(poses[:20], approaches[:20], strict=True):
        at, ways = tip(DMU, pose), touch_frames(DMU, pose[None])[0]
        moves = np.array([(pose_with_tip(DMU, pose, at - 1e-3 * way) - pose)[linear] for way in ways])
        for axis, number in enumerate(linear):
            touching = moves[np.abs(moves[:, axis]).argmax(), axis]
            assert come[number] == np.sign(touching)


def test_the_reversals_of_linear_axes_count_and_the_radius_is_one_unknown_of_all_balls() -> None:
    setup, poses, approaches = candidates()
    assert not setup.mean_sides
    assert [unknown.owner for unknown in setup.unknowns if unknown.name == "radius"] == ["spheres"]
    rows = Observation(DMU, (setup,)).numbers(0, poses, approaches).rows
    (reversal,) = [f.columns for f in DMU.curves if f.name == "EXX_reversal"]
    even = replace(setup, mean_sides=True, three_touches=False)
    sides = np.where([axis.rotary for axis in DMU.axes], approaches, 0.0)
    evened = Observation(DMU, (even,)).numbers(0, poses, sides).rows
    np.testing.assert_allclose(np.linalg.norm(rows[:, :, reversal], axis=1), 0.5)
    assert np.abs(evened[:, :, reversal]).max() == 0.0


def test_a_cycle_that_touches_all_sides_is_refused() -> None:
    with pytest.raises(DescriptionError, match="touches them from all sides"):
        cycle_of(DMU, setup_of())


@pytest.mark.parametrize("seed", range(6))
def test_sides_are_square_to_each_other_and_to_the_stem_on_any_machine(seed: int) -> None:
    """Also where no linear axis goes across the stem, or there is none."""
    machine = random_machine(seed, count=2)
    poses, _ = random_poses(machine, 5, np.random.default_rng(seed))
    for pose, ways in zip(poses, touch_frames(machine, poses), strict=True):
        np.testing.assert_allclose(ways @ ways.T, np.eye(3), atol=1e-12)
        np.testing.assert_allclose(ways[2], stem(machine, pose), atol=1e-12)
