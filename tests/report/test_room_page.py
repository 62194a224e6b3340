"""The pictures of where a plan reads: what stands where, by matrices of the tests' own, and names that stay names."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from axiscal.demo.five_axis import description
from axiscal.measurement.candidates import spread
from axiscal.measurement.place import Place
from axiscal.report.room_page import View, in_machine, on_workpiece, render
from tests.generators.kinematics import tip

CAMPAIGN = description()
ABOVE, FRONT = View(0, 1, "from above"), View(0, 2, "from the front")


def places(count: int = 24) -> list[Place]:
    lattice = spread(CAMPAIGN.machine, CAMPAIGN.setups, count)
    rows = zip(lattice.setups.tolist(), lattice.poses.tolist(), lattice.approaches.astype(int).tolist(), strict=True)
    return [Place(CAMPAIGN.setups[setup].name, tuple(pose), tuple(side)) for setup, pose, side in rows]


@pytest.mark.parametrize("view", [ABOVE, FRONT])
def test_readings_stand_where_the_tool_point_is(view: View) -> None:
    asked = places()
    found = {trace["name"]: trace for trace in on_workpiece(CAMPAIGN, asked, view)["data"] if "text" in trace}
    for name in {place.setup for place in asked}:
        tips = np.array([tip(CAMPAIGN.machine, np.array(p.pose)) for p in asked if p.setup == name]) * 1e3
        np.testing.assert_allclose(found[name]["x"], tips[:, view.right], rtol=1e-5, atol=1e-6)
        np.testing.assert_allclose(found[name]["y"], tips[:, view.up], rtol=1e-5, atol=1e-6)


def test_part_balls_and_travels_are_drawn_in_their_sizes() -> None:
    asked = places()
    above = {trace["name"]: trace for trace in on_workpiece(CAMPAIGN, asked, ABOVE)["data"]}
    for x, y in zip(above["part"]["x"], above["part"]["y"], strict=True):
        assert math.hypot(x, y) == pytest.approx(200.0, rel=1e-5)
    assert above["three spheres"]["text"] == ["low", "high", "third"]
    assert above["three spheres"]["x"] == [200.0, -100.0, -100.0]
    front = {trace["name"]: trace for trace in on_workpiece(CAMPAIGN, asked, FRONT)["data"]}
    assert (min(front["part"]["y"]), max(front["part"]["y"])) == (-100.0, 100.0)
    travel = {trace["name"]: trace for trace in in_machine(CAMPAIGN, asked, FRONT)["data"]}["travel of the axes"]
    assert (min(travel["x"]), max(travel["x"]), min(travel["y"]), max(travel["y"])) == (-300.0, 300.0, 0.0, 500.0)


def test_the_way_goes_through_the_readings_in_their_order() -> None:
    asked = places()
    way = next(trace for trace in in_machine(CAMPAIGN, asked, ABOVE)["data"] if not trace["name"])
    index = CAMPAIGN.machine.index("X")
    np.testing.assert_allclose(way["x"], [1e3 * place.pose[index] for place in asked], rtol=1e-5, atol=1e-9)


def test_a_name_stays_a_name() -> None:
    hostile = "<script>alert(1)</script>"
    first = replace(CAMPAIGN.setups[0], name=hostile)
    campaign = replace(CAMPAIGN, setups=(first, *CAMPAIGN.setups[1:]))
    page = render(hostile, campaign, [replace(place, setup=hostile) for place in places()[:3]])
    assert not re.search(r"<script>alert", page)
    assert "3 readings" in page
