"""What only readings suffer: a reversal that is not there yet, by the way since the axis turned."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.description.causes import WAY
from axiscal.description.usual import Learnable, sizes_of
from axiscal.estimation.case import Case
from axiscal.estimation.promise.passing import passing_columns, turning
from axiscal.machine import load_machine
from axiscal.measurement.place import Places
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array

AT = (0.1, 0.3, 0.45, 0.2, 0.15, 0.2, 0.2)
SIDES = (1, 1, 1, 1, -1, -1, -1)
SINCE = (0.001, 0.201, 0.351, 0.001, 0.001, 0.001, 0.001)
"""Back to 0.2 from above, coming from below, it turns twice; so it does where it comes from above and goes up."""


def axis(approach: str = "both", usual: str = "on") -> Case:
    """Return an axis with a reversal of 4 um under a laser."""
    text = f"""machine = "m"
usual = "{usual}"
[target]
readings = 20
[[setups]]
name = "laser"
instrument = "interferometer"
direction = "x"
approach = "{approach}"
noise = "0.5 um"
"""
    return Case(campaign_from_texts(text, "campaign.toml", load_machine("one-axis").text, "one-axis"))


def columns(case: Case) -> dict[str, Array]:
    """Return the columns of what passes by the kind of their size."""
    places = Places.of_setup(0, np.array(AT)[:, None], np.array(SIDES, dtype=float)[:, None])
    readings = [
        Reading("laser", (at,), (side,), 0.0, time=60.0 * n) for n, (at, side) in enumerate(zip(AT, SIDES, strict=True))
    ]
    found = passing_columns(case.observation, readings, places, np.arange(len(AT)), case.sizes, case.description.usual)
    kinds = np.array([case.sizes.of[number].kind for number in found.size_at])
    return {kind: found.columns[:, kinds == kind] for kind in np.unique(kinds)}


def test_what_is_missing_of_a_reversal_falls_with_the_way_since_the_axis_turned() -> None:
    case = axis()
    std = next(entry.std for entry in case.description.machine.errors if entry.name == "EXX_reversal")
    found = columns(case)["way"]
    assert found.shape == (len(AT), 1)
    wanted = -WAY.size * std / 2 * np.array(SIDES) * np.exp(-np.array(SINCE) / 0.1)
    assert found[:, 0] == pytest.approx(wanted, rel=1e-9)


def test_it_is_there_where_both_sides_are_read_and_what_usually_goes_wrong_counts() -> None:
    assert "way" in {size.kind for size in axis().sizes.of}
    assert "way" not in columns(axis(approach="+"))
    assert "way" not in {size.kind for size in axis(usual="off").sizes.of}


def test_readings_in_another_order_have_turned_elsewhere() -> None:
    case, poses = axis(), np.array(AT)[:, None]
    (one,) = turning(case.observation, 0, poses, np.array(SIDES, dtype=float)[:, None])
    order = np.array([6, 5, 4, 0, 3, 1, 2])
    there = turning(case.observation, 0, poses[order], np.array(SIDES, dtype=float)[order, None])[0]
    assert one.missing(poses, order)[:, order] == pytest.approx(there.missing(poses[order], np.arange(7)))
    assert not np.allclose(one.missing(poses, order), one.missing(poses, np.arange(7)))


def test_rotary_axes_have_none() -> None:
    machine = load_machine("dmu60")
    reversing = {entry.name for entry in machine.errors if entry.kind == "reversal"}
    found = sizes_of(machine, (), Learnable("roughly", usual=True, inherited=False))
    (owners,) = (set(size.owners) for size in found.of if size.kind == "way")
    assert owners < reversing
    assert {machine.axis(name[2]).rotary for name in owners} == {False}
    assert {machine.axis(name[2]).rotary for name in reversing - owners} == {True}
