"""The verdict on an estimate: drifts and steps widen it, nonsense contradicts it, few readings leave it unchecked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from axiscal.campaign.ending import DOES_NOT_FIT, accuracy_reached
from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.ruled import ruled, ruling_of
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.simulation import Simulator, VirtualMachine

MACHINE = """
chain = "w-b-X-t"
[axes.X]
travel = ["0 mm", "1000 mm"]
[errors]
EXX = { std = "10 um", length = "200 mm", knots = 21, rest = "0.3 um" }
EXX_reversal = { std = "3 um" }
"""
CAMPAIGN = """machine = "m"
[target]
rms = "3 um"
[[setups]]
name = "laser"
instrument = "interferometer"
direction = "x"
noise = "0.5 um"
approach = "both"
unknowns = { zero = "1 mm" }
drift = "0 um/h"
"""
CASE = Case(campaign_from_texts(CAMPAIGN, "c.toml", MACHINE, "m"))


def _machine(seed: int) -> VirtualMachine:
    return Simulator(CASE.description.machine, CASE.description.setups).drawn(seed)


def _read(machine: VirtualMachine, count: int) -> list[Reading]:
    """Return readings out and back, unevenly, one a minute; one side on each way."""
    rng, setup = np.random.default_rng(7), CASE.description.setups[0]
    along = np.linspace(0.005, 0.995, count) + 4e-3 * np.sin(3.0 * np.arange(count))
    order = [(float(x), 1) for x in along[::2]] + [(float(x), -1) for x in along[1::2][::-1]]
    return [
        Reading("laser", (x,), (side,), machine.read(setup, (x,), (side,), rng), time=60.0 * index)
        for index, (x, side) in enumerate(order)
    ]


def _plus(readings: Sequence[Reading], added: Sequence[float] | Array) -> list[Reading]:
    return [replace(each, value=each.value + float(more)) for each, more in zip(readings, added, strict=True)]


def _missed(known: Estimation, machine: VirtualMachine) -> float:
    """Return the RMS that an estimate is wrong by over the travel, a constant taken off, m."""
    poses = np.linspace(0, 1, 200)[:, None]
    sides = np.where(np.arange(200)[:, None] % 2 == 0, 1.0, -1.0)
    left = (machine.deviation(poses, sides) - known.estimate().deviation(poses, sides))[:, 0]
    return float(np.std(left))


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_drift_widens_and_what_explains_it_is_taken_off(seed: int) -> None:
    machine = _machine(seed)
    readings = _plus(_read(machine, 28), 10e-6 * np.linspace(0, 1, 28))
    model = concluded(CASE, readings)
    known = ruled(model)
    ruling = ruling_of(known)
    assert ruling.verdict == "widened"
    assert ruling.comparison.explanations[0].family in ("drift", "levelling")
    assert ruling.expanded.space >= ruling_of(replace(model, ruling=None)).expanded.space * 0.999
    assert known.accuracy.rms >= model.accuracy.rms
    assert _missed(known, machine) <= 1.5 * known.accuracy.rms


def test_a_step_between_the_readings_is_within_what_is_promised_then() -> None:
    machine = _machine(4)
    readings = _read(machine, 28)
    stepped = _plus(readings, [12e-6 * (each.pose[0] > 0.43) for each in readings])
    known = ruled(concluded(CASE, stepped))
    assert ruling_of(known).verdict == "widened"
    assert ruling_of(known).comparison.explanations[0].family in ("step", "bump")
    assert known.accuracy.rms > concluded(CASE, readings).accuracy.rms


def test_readings_of_the_model_itself_hold_where_they_could_have_said_otherwise() -> None:
    verdicts = [ruling_of(ruled(concluded(CASE, _read(_machine(seed), 60)))).verdict for seed in range(10)]
    assert verdicts.count("holds") >= 8


def test_few_readings_leave_it_unchecked_and_their_means_as_they_were() -> None:
    model = concluded(CASE, _read(_machine(1), 8))
    known = ruled(model)
    ruling = ruling_of(known)
    assert ruling.verdict == "unchecked"
    assert ruling.vouched > 1.25 * known.accuracy.rms
    assert known.banded is model.banded


@pytest.mark.parametrize("count", [0, 1, 2])
def test_two_readings_or_less_are_unchecked(count: int) -> None:
    known = ruled(concluded(CASE, _read(_machine(1), 8)[:count]))
    assert ruling_of(known).verdict == "unchecked"


def test_nonsense_contradicts_every_explanation_and_reaches_no_target() -> None:
    rng, readings = np.random.default_rng(1), _read(_machine(1), 40)
    nonsense = _plus(readings, 60e-6 * rng.standard_cauchy(40))
    known = concluded(CASE, nonsense)
    assert ruling_of(ruled(known)).verdict == "contradicted"
    assert known.accuracy.rms < 3e-6
    assert accuracy_reached(CASE.description.target, known) == DOES_NOT_FIT


def test_the_verdict_is_the_same_every_time() -> None:
    readings = _plus(_read(_machine(2), 20), 5e-6 * np.linspace(0, 1, 20))
    first, second = (ruled(concluded(CASE, readings)) for _ in range(2))
    assert ruling_of(first).verdict == ruling_of(second).verdict
    assert first.accuracy == second.accuracy
