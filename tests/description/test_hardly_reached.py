"""Balls that few poses reach are said, with the angles; by hand: the tool keeps within its cone of upright."""

from __future__ import annotations

import re

from axiscal.description.hardly_reached import hardly_reached
from tests.description.test_sites import SPHERES, TOUCHED, described


def test_a_ball_that_few_poses_reach_is_said_with_its_angles() -> None:
    """B turns from -30 to 120 deg: within 3 deg of upright lies a twenty-fifth of it."""
    said = hardly_reached(described(SPHERES + 'cone = "3 deg"\n' + TOUCHED + 'ball = "low"\n'))
    assert said is not None
    found = re.search(r'"touched" reaches ball low of spheres in ([\d.]+) % of the turns', said)
    assert found is not None
    assert 3.5 < float(found[1]) < 4.5
    assert "B -5 to 5 deg" in said
    assert "C 0 to 360 deg" in said


def test_balls_that_many_poses_reach_are_not() -> None:
    assert hardly_reached(described(SPHERES + TOUCHED)) is None
    assert hardly_reached(described(SPHERES + 'cone = "6 deg"\n' + TOUCHED)) is None
