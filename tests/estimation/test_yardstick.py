"""The figures of a campaign against samples of its belief, from any side, and found once for cases that share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from axiscal.description.campaign import read_campaign
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import estimated
from axiscal.estimation.estimation import Estimation
from axiscal.measurement.reading import Reading
from axiscal.numerics.remembered import Memo
from axiscal.present.demo import description
from tests.generators.texts import machine_text

MACHINE = machine_text(
    "w-b-X-Y-t",
    {"X": (0, 700), "Y": (0, 100)},
    {"EXX": 'std = "10 um", knots = 13, length = "150 mm"', "EXX_reversal": "3 um"},
)
CAMPAIGN = """
machine = "machine.toml"
usual = "off"
sure = "exactly"
[target]
readings = 9
aligned = false
[[setups]]
name = "laser"
instrument = "interferometer"
direction = "x"
moves = ["X"]
unknowns = UNKNOWNS
approach = "APPROACH"
"""


def case(folder: Path, unknowns: str = '{ zero = "1 mm" }', approach: str = "+") -> Case:
    (folder / "machine.toml").write_text(MACHINE)
    text = CAMPAIGN.replace("UNKNOWNS", unknowns).replace("APPROACH", approach)
    (folder / f"{approach}.toml").write_text(text)
    return Case(read_campaign(folder / f"{approach}.toml"))


def read(stated: Case, sides: tuple[int, ...]) -> Estimation:
    places = enumerate(np.linspace(0.05, 0.65, 8).tolist())
    return estimated(stated, [Reading("laser", (x, 0.05), (sides[n % len(sides)], 0), 1e-6 * n) for n, x in places])


@pytest.mark.parametrize("sides", [(1, -1), (0,), (1, 0)])
def test_readings_from_other_sides_than_allowed_are_judged_by_what_they_see(
    tmp_path: Path, sides: tuple[int, ...]
) -> None:
    narrow = read(case(tmp_path, approach="+"), sides)
    wide = read(case(tmp_path, approach="both"), sides)
    assert narrow.accuracy == pytest.approx(wide.accuracy, rel=1e-9)
    assert narrow.accuracy.rms >= narrow.case.yardstick.unseen_rms
    assert narrow.accuracy.floor <= narrow.accuracy.rms
    assert narrow.case.description.setups[0].approach == "+"


_STATED = Case(description())
_POINT = 1e-6 * np.random.default_rng(3).standard_normal(_STATED.errors.size + len(_STATED.observation.unknowns))


def _elsewhere(case: Case) -> Case:
    """Return the case about another machine, with the ball bar where that has it."""
    return case.linear_about(_POINT)


def _bent(case: Case) -> Case:
    return case.linear_about(_POINT, bent=True)


def _rougher(case: Case) -> Case:
    return case.rescaled({("rest", "EXX"): 5.0, ("std", "EXX"): 2.0, ("noise", case.description.setups[0].name): 3.0})


def _from_both_sides(case: Case) -> Case:
    quiet = tuple(replace(setup, approach="+") for setup in case.description.setups)
    there = replace(case, description=replace(case.description, setups=quiet))
    assert there.yardstick.unseen.shape == case.yardstick.unseen.shape
    return replace(there, both=frozenset([quiet[0].name]))


@pytest.mark.long
@pytest.mark.parametrize("made", [_elsewhere, _bent, _rougher, _from_both_sides])
def test_it_is_what_a_case_by_itself_finds(made: Callable[[Case], Case]) -> None:
    case = made(_STATED)
    alone = replace(case, yardsticks=Memo(), volumes=Memo())
    one, other = case.yardstick, alone.yardstick
    np.testing.assert_array_equal(one.unseen, other.unseen)
    np.testing.assert_array_equal(one.root.matrix, other.root.matrix)
    assert one.measure(case.prior) == pytest.approx(other.measure(alone.prior), rel=1e-14)
    assert one.zeroed == other.zeroed
    assert one.moments.rest == pytest.approx(other.moments.rest, rel=1e-14)
