"""Machines that are far off: the exact chain taken off the readings brings parameters and bands to agreement."""

from __future__ import annotations

import re

import numpy as np
import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.errors.volume import MovedErrors, deviation_of
from axiscal.estimation.case import Case
from axiscal.estimation.located import Absorbed, absorbed, bent, located
from axiscal.estimation.stations import GAUSSIAN, indices
from axiscal.machine import load_machine
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator, VirtualMachine
from axiscal.numerics import Array

_CAMPAIGN = """machine = "m"
usual = "off"
[target]
readings = 1
[[setups]]
name = "nest"
instrument = "rtest"
noise = "0.7 um"
approach = "both"
unknowns = {}
"""


def _case(offset: str, tilt: str, zero: str = "") -> Case:
    """Return the built-in machine with fewer knots, its rotary axes as badly placed as stated."""
    text = re.sub(r"knots = \d+", "knots = 5", load_machine("dmu60").text)
    text = re.sub(r"(?m)^([XYZ]0[BC]) = .*$", rf'\1 = {{ std = "{offset}" }}', text)
    text = re.sub(r"(?m)^([ABC]0[BC]) = .*$", rf'\1 = {{ std = "{tilt}" }}', text)
    text += "".join(f'{name} = {{ std = "{zero}" }}\n' for name in ("B0B", "C0C") if zero)
    return Case(campaign_from_texts(_CAMPAIGN, "c.toml", re.sub(r", rest = [^}]*", " ", text), "m"))


def _read(case: Case, seed: int, count: int = 50) -> tuple[VirtualMachine, list[Reading]]:
    rng, setup = np.random.default_rng(seed), case.description.setups[0]
    machine = Simulator(case.description.machine, case.description.setups).drawn(seed)
    low, high = np.array([axis.travel for axis in case.description.machine.axes]).T
    readings = []
    for _ in range(count):
        pose, side = tuple(rng.uniform(low, high).tolist()), tuple(int(s) for s in rng.choice([-1, 1], len(low)))
        value, *others = machine.read_all(setup, pose, side, rng)
        readings.append(Reading(setup.name, pose, side, value, others=tuple(others), time=0.0))
    return machine, readings


def _truth(case: Case, machine: VirtualMachine) -> Array:
    """Return the control values of a virtual machine."""
    pairs = zip(case.errors.functions, machine.curves, strict=True)
    return np.concatenate([curve(function.basis.control_positions) for function, curve in pairs])


def _nees(known: Absorbed, truth: Array) -> float:
    """Return the normalised squared error of all parameters: 1 where the belief is right."""
    belief = known.knowledge.belief
    white = np.linalg.solve(belief.factor, truth - belief.mean)
    return float(np.mean(white**2))


@pytest.mark.long
def test_location_errors_of_a_millimetre_and_a_milliradian_keep_their_bands() -> None:
    """Twice as far off as the band says when taken as linear; as far as it says after chord rounds."""
    case, linear, exact = _case("1 mm", "1 mrad"), [], []
    for seed in range(12):
        machine, readings = _read(case, seed)
        truth = _truth(case, machine)
        linear.append(_nees(absorbed(case, readings, {}), truth))
        known = located(case, readings)
        exact.append(_nees(known, truth))
        assert indices(known.knowledge, readings).max() < GAUSSIAN
    assert np.mean(linear) > 1.5
    assert 0.9 < np.mean(exact) < 1.1


def test_a_machine_in_service_is_taken_as_linear() -> None:
    case = _case("15 um", "30 urad")
    _, readings = _read(case, 3)
    assert located(case, readings).case.about is None


def test_the_rounds_end_where_the_exact_chain_gives_the_readings() -> None:
    """At the end the rows and the chain say the same of every reading: the mean is a fixed point."""
    case = _case("3 mm", "3 mrad")
    _, readings = _read(case, 1)
    known = located(case, readings)
    assert known.case.about is not None
    poses, sides = (np.array([getattr(r, name) for r in readings], dtype=float) for name in ("pose", "approach"))
    mean = known.knowledge.belief.mean[: case.errors.size]
    chain = deviation_of(case.errors, mean, poses, sides).displacement
    beside = known.case.observation.nonlinear_part(0, poses, sides)
    assert case.errors.rows(poses, sides) @ mean + beside == pytest.approx(chain, abs=2e-8)


@pytest.mark.long
def test_rows_at_the_machine_as_believed_bring_bands_and_parameters_to_agreement() -> None:
    """Zeros of half a degree: what the chord leaves is many times the band, at the machine itself it is the band."""
    case, chord, moved = _case("3 mm", "3 mrad", "0.5 deg"), [], []
    for seed in range(4):
        machine, readings = _read(case, seed)
        truth = _truth(case, machine)
        known = located(case, readings)
        chord.append(_nees(known, truth))
        there = bent(known, readings)
        assert isinstance(there.case.errors, MovedErrors)
        moved.append(_nees(there, truth))
    assert np.mean(chord) > 1.5
    assert 0.8 < np.mean(moved) < 1.2
