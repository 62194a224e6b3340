"""What is found, known, left and not measured, on one axis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from axiscal.description.target import Want
from axiscal.estimation.accuracy.expanded import BAND
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.functionals.asked import asked_rows
from axiscal.estimation.known_rows import KnownRow
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import proposed
from axiscal.present.answer import AnswerRow
from axiscal.present.answer_of_campaign import Aims, answered, missing_readings
from tests.generators.laser_axis import CASE, machine

DRAWN = machine(5)
SETUP = CASE.description.setups[0]


def _readings(places: Sequence[tuple[float, int]]) -> list[Reading]:
    rng = np.random.default_rng(1)
    return [
        Reading("laser", (x,), (side,), DRAWN.read_all(SETUP, (x,), (side,), rng)[0], time=10.0 * number)
        for number, (x, side) in enumerate(places)
    ]


ONE_SIDE = [(x, 1) for x in np.linspace(0.05, 0.95, 10).tolist()]
BOTH = [*ONE_SIDE, *((x, -1) for x, _ in reversed(ONE_SIDE))]


@cache
def _known(both: bool) -> Estimation:
    return concluded(CASE, _readings(BOTH if both else ONE_SIDE))


def _rows(known: Estimation) -> dict[str, tuple[KnownRow, AnswerRow]]:
    return {row.row: (known, row) for known, row in answered(known, {})}


def test_backlash_read_from_one_side_is_not_measured_and_one_reading_would_do() -> None:
    exact = Case(replace(CASE.description, sure="exactly"))  # what readings teach of sizes is not known beforehand
    row, _ = _rows(concluded(exact, _readings(ONE_SIDE)))["backlash X"]
    assert not row.measured
    assert row.known > 0.9 * row.before
    assert (len(row.lines[0].plus), len(row.lines[0].minus), len(row.lines[0].both)) == (10, 0, 0)
    last = ONE_SIDE[-1][0]
    more, _ = _rows(concluded(exact, _readings([*ONE_SIDE, (last, -1)])))["backlash X"]
    assert more.measured
    target = replace(CASE.description.target, wants=(Want(row.row, 1.2 * more.known),))
    wanted = concluded(Case(replace(exact.description, target=target)), _readings(ONE_SIDE))
    rows = answered(wanted, {})
    aims = Aims.from_case(wanted.case, wanted.printed.belief, wanted.case.yardstick_as_sized, [row for row, _ in rows])
    assert missing_readings(wanted, aims, rows)[0] == 1
    assert more.known < 0.5 * row.known


@pytest.mark.parametrize("taken", [1, 2, 4])
def test_the_first_readings_do_not_tell_of_hundreds_more(taken: int) -> None:
    yardstick = CASE.yardstick
    limit = float(np.hypot(yardstick.rms_floor, 0.1 * yardstick.measure(CASE.prior).rms))
    target = replace(CASE.description.target, readings=None, rms=limit, wants=())
    case = Case(replace(CASE.description, target=target, sure="exactly"))
    known = concluded(case, _readings(BOTH[:taken]))
    aims = Aims.from_case(known.case, known.printed.belief, known.case.yardstick_as_sized, [])
    assert taken * aims.volume[0].missing > 90
    more, _ = missing_readings(known, aims, [])
    planned = len(proposed(case, Limits(rms=limit)).places)
    assert planned - taken <= more <= 3 * planned


def test_backlash_read_from_both_sides_is_measured_over_the_places_read_from_both() -> None:
    known = _known(True)
    _, row = _rows(known)["backlash X"]
    assert row.measured
    assert row.lines[0].places["both"] == 10
    poses = np.array([[x] for x, _ in ONE_SIDE])
    true = np.mean(DRAWN.deviation(poses, np.ones_like(poses)) - DRAWN.deviation(poses, -np.ones_like(poses)), axis=0)
    (signed,) = row.signed
    assert signed.direction == "X"
    assert abs(signed.value - 1e6 * true[0]) <= signed.U == row.known_to
    assert abs(signed.value) > 3 * abs(signed.value - 1e6 * true[0])  # so that a turned sign fails
    at = 1e6 * _of(known, "backlash X")[0]
    assert row.found**2 == pytest.approx(at**2 + (row.known_to / BAND) ** 2, rel=1e-3)


def _of(known: Estimation, name: str) -> Array:
    asked = next(each for each in asked_rows(CASE.description, known.readings) if each.want.row.name == name)
    assert asked.map is not None
    return asked.map.row(known.estimate().deviation(asked.map.poses, asked.map.sides))


def test_a_control_that_corrects_what_is_known_leaves_what_is_not() -> None:
    known = _known(True)

    def control(poses: Array, sides: Array) -> Array:
        return -known.estimate().deviation(poses, sides)[:, :1]

    def nothing(poses: Array, sides: Array) -> Array:
        return np.zeros_like(poses)

    for _, row in answered(known, {"all": control, "none": nothing}):
        assert row.left["none"] == row.found
        assert row.left["all"] < row.found
        missing = row.known_to / BAND if row.signed else 1e6 * known.estimate().unknown.rms
        assert row.left["all"] == pytest.approx(missing, rel=1e-3)
