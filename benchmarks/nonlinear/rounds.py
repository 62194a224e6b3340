"""What the rounds of the exact chain bring: error of the tool point and of the parameters, on virtual machines."""

from __future__ import annotations

import re
from typing import NamedTuple

import numpy as np

from axiscal.description.campaign import campaign_from_texts
from axiscal.errors.volume import deviation_of
from axiscal.estimation.case import Case
from axiscal.estimation.located import absorbed, bent
from axiscal.machine import load_machine
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator, VirtualMachine
from axiscal.numerics import Array

CAMPAIGN = """machine = "m"
[target]
readings = 1
[[setups]]
name = "nest"
instrument = "rtest"
noise = "0.5 um"
approach = "both"
unknowns = {}
"""
_READINGS, _POSES, _ROUNDS = 150, 200, 3
_LOCATIONS = {"offset": ("X0B", "Z0B", "X0C", "Y0C"), "tilt": ("A0B", "C0B", "A0C", "B0C"), "zero": ("B0B", "C0C")}


class Round(NamedTuple):
    """missed, band : RMS of truth less estimate and of its std at the tool, in space, m; nees : of the parameters."""

    missed: float
    band: float
    nees: float


def case_of(offset: str, tilt: str, zero: str) -> Case:
    """Return the five-axis machine without rests, its rotary axes as badly placed as stated, and a known nest."""
    text = load_machine("dmu60").text
    text = re.sub(r", rest = [^}]*", " ", text)
    kept = [line for line in text.splitlines() if line.split(" ")[0] not in sum(_LOCATIONS.values(), ())]
    stds = {"offset": offset, "tilt": tilt, "zero": zero}
    kept += [f'{name} = {{ std = "{stds[kind]}" }}' for kind, names in _LOCATIONS.items() for name in names]
    return Case(campaign_from_texts(CAMPAIGN, "c.toml", "\n".join(kept), "m"))


def read(case: Case, seed: int) -> tuple[VirtualMachine, list[Reading]]:
    """Return a machine drawn from the prior and its readings at random poses."""
    rng, setup = np.random.default_rng(seed), case.description.setups[0]
    machine = Simulator(case.description.machine, case.description.setups).drawn(seed)
    low, high = np.array([axis.travel for axis in case.description.machine.axes]).T
    readings = []
    for _ in range(_READINGS):
        pose, side = tuple(rng.uniform(low, high).tolist()), tuple(int(s) for s in rng.choice([-1, 1], len(low)))
        value, *others = machine.read_all(setup, pose, side, rng)
        readings.append(Reading(setup.name, pose, side, value, others=tuple(others), time=0.0))
    return machine, readings


def rounds(case: Case, seed: int) -> list[Round]:
    """Return how right a machine is known: taken as linear, after each round of the exact chain, with rows moved."""
    machine, readings = read(case, seed)
    low, high = np.array([axis.travel for axis in case.description.machine.axes]).T
    poses = np.random.default_rng((seed, 1)).uniform(low, high, (_POSES, len(low)))
    sides = np.ones_like(poses)
    truth, control = machine.deviation(poses, sides), _control(case, machine)
    nominal, found = case.errors.rows(poses, sides), list[Round]()
    known = absorbed(case, readings, {})
    for number in range(_ROUNDS + 1):
        if number == _ROUNDS:
            known = bent(known)
        belief = known.knowledge.belief
        mean, factor = belief.mean[: case.errors.size], belief.factor[: case.errors.size]
        exact = deviation_of(case.errors, mean, poses, sides).displacement if number else nominal @ mean
        missed = np.sqrt(np.mean(np.sum((truth - exact) ** 2, axis=1)))
        rows = known.case.errors.rows(poses, sides)
        band = np.sqrt(np.mean(np.sum((rows @ factor) ** 2, axis=(1, 2))))
        white = np.linalg.solve(np.linalg.cholesky(factor @ factor.T), control - mean)
        found.append(Round(float(missed), float(band), float(np.mean(white**2))))
        if number < _ROUNDS - 1:
            known = absorbed(known.case.linear_about(belief.mean), readings, {})
    return found


def _control(case: Case, machine: VirtualMachine) -> Array:
    """Return the control values of a virtual machine."""
    pairs = zip(case.errors.functions, machine.curves, strict=True)
    return np.concatenate([curve(function.basis.control_positions) for function, curve in pairs])
