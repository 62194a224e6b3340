"""How far from linear readings are: draws of our own, estimates made twice, the exact chain taken off."""

import re
from collections.abc import Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.errors.volume import deviation_of
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation, Linearity, linearity
from axiscal.estimation.history import History
from axiscal.estimation.located import history, located
from axiscal.estimation.stations import indices
from axiscal.machine import load_machine
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import seen, shown_by_each
from axiscal.measurement.simulation import Simulator, VirtualMachine
from axiscal.numerics import Array
from tests.generators import laser_axis
from tests.generators.problems import readings_of
from tests.generators.texts import campaign_text, setup_text
from tests.generators.tracers import tracers


def shown_values(observation: Observation, readings: Sequence[Reading], point: Array) -> Array:
    """Return what readings show by the exact chain, (m,).  point : (k,) errors, then unknowns"""
    shown: Array = shown_by_each(observation, readings, point[None])[0]
    return shown


def _few(case: Case) -> tuple[History, list[Reading]]:
    """Return what eight readings of each tracer make known, and these; the first one stands off."""
    rng, places = np.random.default_rng(2), np.random.default_rng(1).uniform(0.0, 0.35, (8, 3))
    bare = [
        Reading(setup.name, (x, y, z), (1, 1, 1), 0.0, time=0.0)
        for setup in case.description.setups
        for x, y, z in places.tolist()
    ]
    truth = np.zeros(case.observation.size)
    truth[case.observation.unknowns_of(0)] = 0.7 * np.array([u.std for u in case.description.setups[0].unknowns])
    shown = shown_values(case.observation, bare, truth[: case.errors.size + len(case.observation.unknowns)])
    readings = [
        replace(each, value=float(value) + 1e-6 * rng.standard_normal())
        for each, value in zip(bare, shown, strict=True)
    ]
    return history(case, readings), readings


def test_the_index_of_few_readings_is_what_draws_of_the_belief_say() -> None:
    """The second order of a distance, over the noise: 120 draws beside the 64 of the module."""
    case = tracers("2 mm", "1 mm")
    known = history(case, ())
    readings = [Reading("tracer 1", (0.1 * k, 0.2, 0.1), (1, 1, 1), 0.0, time=0.0) for k in range(3)]
    observation, belief = known.knowledge.observation, known.knowledge.belief
    (numbers, _), rng, size = seen(observation, readings), np.random.default_rng(9), observation.size
    steps = (belief.factor @ rng.standard_normal((belief.factor.shape[1], 120)))[:size].T
    nominal = shown_values(observation, readings, belief.mean[:size])
    beyond = [shown_values(observation, readings, belief.mean[:size] + each) - nominal - numbers.rows[:, :size] @ each
              for each in steps]  # fmt: skip
    expected = np.sqrt(np.mean(np.square(beyond), axis=0) / observation.variances(numbers))
    assert expected.min() > 0.3
    assert indices(known.knowledge, readings) == pytest.approx(expected, rel=0.4)
    assert indices(known.knowledge, []).shape == (0,)


def test_the_least_linear_reading_is_named_and_what_is_rounding_is_nothing() -> None:
    known, readings = _few(tracers("5 mm", "1 mm"))
    readings = readings[::-1]
    each = indices(known.knowledge, readings)
    worst = int(np.argmax(each))
    assert worst > 0
    found = linearity(cast("Estimation", SimpleNamespace(readings=tuple(readings), history=known)))
    assert found.largest == pytest.approx(float(each.max()))
    assert found.reading == worst + 1
    assert [Linearity(largest, 1).gaussian for largest in (0.3, 0.31)] == [True, False]
    laser = concluded(laser_axis.CASE, laser_axis.read(laser_axis.machine(1), 6))
    assert linearity(laser).largest == 0.0
    assert linearity(concluded(laser_axis.CASE, [])) == (0.0, None)


_CAMPAIGN = campaign_text(
    "m", setup_text("nest", "rtest", noise="0.7 um", approach="both", unknowns={}), target={"readings": 1}, usual="off"
)


def _case(offset: str, tilt: str, zero: str = "") -> Case:
    """Return the built-in machine with fewer knots, its rotary axes as badly placed as stated."""
    text = re.sub(r"knots = \d+", "knots = 5", load_machine("dmu60").text)
    text = re.sub(r"(?m)^([XYZ]0[BC]) = .*$", rf'\1 = {{ std = "{offset}" }}', text)
    text = re.sub(r"(?m)^([ABC]0[BC]) = .*$", rf'\1 = {{ std = "{tilt}" }}', text)
    text += "".join(f'{name} = {{ std = "{zero}" }}\n' for name in ("B0B", "C0C") if zero)
    return Case(campaign_from_texts(_CAMPAIGN, "c.toml", re.sub(r", rest = [^}]*", " ", text), "m"))


def _read(case: Case, seed: int) -> tuple[VirtualMachine, list[Reading]]:
    machine = Simulator(case.description.machine, case.description.setups).drawn(seed)
    return machine, readings_of(case, 50, seed)


def test_readings_that_pass_for_linear_need_no_round() -> None:
    """Errors of micrometres pass; those of millimetres do not."""
    for offset, tilt, passed in (("3 um", "3 urad", True), ("30 um", "30 urad", True), ("3 mm", "3 mrad", False)):
        case = _case(offset, tilt)
        _, readings = _read(case, 1)
        known = history(case, readings)
        assert (located(known) is known) == passed


def test_the_rounds_end_where_the_exact_chain_gives_the_readings() -> None:
    """At the end the rows and the chain say the same of every reading: the mean is a fixed point."""
    case = _case("3 mm", "3 mrad")
    _, readings = _read(case, 1)
    known = located(history(case, readings))
    assert known.case.about is not None
    poses, sides = (np.array([getattr(r, name) for r in readings], dtype=float) for name in ("pose", "approach"))
    mean = known.knowledge.belief.mean[: case.errors.size]
    chain = deviation_of(case.errors, mean, poses, sides).displacement
    beside = known.case.observation.nonlinear_part(0, poses, sides)
    assert case.errors.rows_at(poses, sides) @ mean + beside == pytest.approx(chain, abs=2e-8)
