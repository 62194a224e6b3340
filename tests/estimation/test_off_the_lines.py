"""What two axes do together off the lines that were read: as large as it may be by what was stated, not learnt."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from axiscal.estimation.defence import Defence, Departed, defence
from scipy import stats

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.measurement.reading import Reading

CAMPAIGN = """machine = "m"
[target]
readings = 30
[[setups]]
name = "probe"
instrument = "probe"
direction = "z"
moves = ["X", "Y"]
reach = { X = ["0 mm", "400 mm"], Y = ["0 mm", "400 mm"] }
noise = "1 um"
drift = "0 um/h"
"""
CROSS = [(float(x), 0.2) for x in np.linspace(0.01, 0.39, 16)] + [(0.2, float(y)) for y in np.linspace(0.01, 0.39, 16)]
GRID = [(float(x), float(y)) for x in np.linspace(0.01, 0.39, 6) for y in np.linspace(0.01, 0.39, 6)]
PROMISE = 2e-6


def plate(std: str) -> Case:
    """Return a plate of two axes whose straightness has this std."""
    curve = f'{{ std = "{std}", length = "150 mm", knots = 9, rest = "0.5 um" }}'
    machine = "".join(f'[axes.{axis}]\ntravel = ["0 mm", "400 mm"]\n' for axis in "XY")
    text = f'chain = "w-b-X-Y-t"\n{machine}[errors]\nEZX = {curve}\nEZY = {curve}\n'
    return Case(campaign_from_texts(CAMPAIGN, "c.toml", text, "m"))


def vouched(case: Case, places: Sequence[tuple[float, float]], stated: Case) -> Defence:
    """Return what readings at places vouch for, twice along the way."""
    readings = [Reading("probe", each, (1, 1), 0.0, time=20.0 * i) for i, each in enumerate([*places, *places[::-1]])]
    return defence(case, readings, PROMISE, stated.description.machine)


def together(found: Defence) -> Departed:
    """Return what is said of both axes together."""
    return next(each for each in found.departures if each.family == "together")


def test_a_twist_that_no_line_shows_hides_as_often_as_it_is_as_large() -> None:
    stated = plate("20 um")
    found = together(vouched(stated, CROSS, stated))
    spoils = float(np.sqrt(1.5**2 - 1) * PROMISE / (1 / 3))  # the twist uv is a third in the mean over the plate
    assert found.hidden >= float(stats.norm(0, 10e-6).sf(spoils))  # both tails, of one of two shapes
    assert vouched(stated, CROSS, stated).unchecked


def test_curves_found_to_be_small_say_nothing_of_it() -> None:
    stated, learnt = plate("20 um"), plate("5 um")
    found = vouched(learnt, CROSS, stated)
    assert together(found).hidden == pytest.approx(together(vouched(stated, CROSS, stated)).hidden, rel=0.1)
    assert found.unchecked
    assert found.u_def > 2 * PROMISE


def test_readings_all_over_the_plate_leave_no_room_for_it() -> None:
    stated = plate("20 um")
    found = vouched(stated, GRID, stated)
    assert together(found).hidden < 0.01
    assert not together(found).exceeds(PROMISE)
