"""Ways that are gone are free at every place: against close samples, a thin plate, and limits that are just met."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from axiscal.machine import Machine, machine_from_text
from axiscal.measurement.charts.room import Room
from axiscal.measurement.charts.ways import clear
from tests.generators.kinematics import in_travel, stem, tip
from tests.measurement.test_charts import DMU, circle, held

_TRAVELS = {"X": ("-400 mm", "400 mm"), "Y": ("-300 mm", "300 mm"), "Z": ("-200 mm", "400 mm")}
_TURNS = {"B": ("-100 deg", "100 deg", (30, 10, -120)), "C": ("0 deg", "360 deg", (-20, 40, 0))}


def machine(chain: str) -> Machine:
    """A machine whose rotary axes meet neither each other nor the origin."""
    linear = [
        f'[axes.{name}]\ntravel = ["{low}", "{high}"]\nspeed = "10 m/min"\nacceleration = "2 m/s^2"\n'
        for name, (low, high) in _TRAVELS.items()
    ]
    rotary = [
        f'[axes.{name}]\ntravel = ["{low}", "{high}"]\nspeed = "10 rpm"\nacceleration = "100 deg/s^2"\n'
        f'origin = ["{x} mm", "{y} mm", "{z} mm"]\n'
        for name, (low, high, (x, y, z)) in _TURNS.items()
    ]
    head = f'name = "m"\nchain = "{chain}"\n[tool]\nlength = "120 mm"\n[errors]\nEXX = {{ std = "10 um" }}\n'
    return machine_from_text(head + "".join(linear + rotary))


def test_a_way_that_is_gone_is_free_at_every_place_and_hardly_one_that_is_free_is_not_gone() -> None:
    rng, table = np.random.default_rng(1), np.array([[[-0.25, 0.25], [-0.25, 0.25], [-0.3, -0.15]]])
    chart = replace(held(), room=Room(DMU, table))
    places = rng.uniform([0, -0.5], [math.tau, 1.8], (200, 2))
    places = places[chart.feasible(chart.poses(places))]
    gone = free = 0
    for start, stop in zip(places[:-1:2], places[1::2], strict=False):
        along = start + np.linspace(0.0, 1.0, 1001)[:, None] * (stop - start)
        every = bool(np.all(chart.feasible(chart.poses(along))))
        found = clear(chart, np.stack([start, stop]))
        assert every or not found
        gone, free = gone + found, free + every
    assert 10 < gone == free


def test_a_plate_thinner_than_a_quarter_of_a_degree_is_met() -> None:
    """The tool sweeps over a thin plate between two places: no sample of 0.25 deg meets it."""
    slim = replace(DMU, tool_radius=0.0)
    chart = replace(held(), room=Room.empty(slim))
    start, stop = np.radians([[20.0, 0.0], [20.0, 60.0]])
    middle = chart.poses(np.radians([[20.0, 30.1234]]))[0]
    at = tip(slim, middle) + 0.1 * stem(slim, middle)
    plate = np.stack([at - 2e-5, at + 2e-5], axis=1)[None]
    blocked = replace(chart, room=Room(slim, plate))
    coarse = blocked.poses(start + np.linspace(0.0, 1.0, 243)[:, None] * (stop - start))
    assert np.all(blocked.feasible(coarse))
    assert clear(chart, np.stack([start, stop]))
    assert not clear(blocked, np.stack([start, stop]))


def test_a_way_along_a_limit_and_up_to_one_is_gone() -> None:
    chart = held(cone=60.0)
    along = np.radians([[10.0, 60.0], [25.0, 60.0]])  # the tool stays at the edge of its cone
    assert clear(chart, along)
    low, high = 0.0, 2.0
    for _ in range(60):  # to the last place along B that can be reached
        middle = (low + high) / 2
        inside = held().feasible(held().poses(np.array([[1.0, middle]])))[0]
        low, high = (middle, high) if inside else (low, middle)
    assert clear(held(), np.array([[1.0, 0.0], [1.0, low]]))
    assert not clear(held(), np.array([[1.0, 0.0], [1.0, low + 1e-6]]))


def test_a_circle_whose_side_bulges_out_of_a_travel_by_a_tenth_of_a_micrometre_is_not_gone() -> None:
    """Between its two ends X is beyond its travel by 0.1 um for 0.1 deg."""
    whole = circle()
    axes = list(DMU.axes)
    index = next(k for k, axis in enumerate(axes) if axis.name == "X")
    top = float(whole.poses(np.array([[0.0]]))[0, index])
    assert np.isclose(top, whole.poses(np.linspace(0, math.tau, 721)[:, None])[:, index].max())
    for beyond, gone in ((1e-7, False), (-1e-7, True)):
        axes[index] = replace(DMU.axes[index], travel=(DMU.axes[index].travel[0], top - beyond))
        short = replace(whole, room=Room.empty(replace(DMU, axes=tuple(axes))))
        ways = np.array([[-0.3], [0.3]])
        assert clear(short, ways) == gone
        assert in_travel(short.room.machine, short.poses(ways)[0])
