"""How often the printed ± holds: whole calibrations of virtual machines drawn from the prior, on built-in machines.

The readings are planned once, for where they stand does not depend on what is read. Every virtual machine is then read
by its full non-linear kinematics, and what is estimated is compared with what it hides: each error curve, each
constant, and the TCP at poses all over the volume.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.answers.prediction import tcp_prediction
from axiscal.description.campaign import campaign_from_texts
from axiscal.errors.model import Term
from axiscal.errors.plane import PlaneError
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import estimated
from axiscal.estimation.estimation import Estimation
from axiscal.machine import load_machine
from axiscal.measurement.instrument import INSTRUMENTS
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import seen
from axiscal.measurement.simulation import Simulator, VirtualMachine
from axiscal.numerics import Array
from axiscal.planning.gains.covariance import Covariance
from axiscal.present.curves import constants, curves
from axiscal.present.volume_error import planes
from axiscal.units import from_unit
from tests.generators.forms import gains_of

CLAIMED, SLACK = 0.95, 0.015
_BAND = 1.96
_POSES = 60
_LENGTH = '[[setups]]\nname = "length {0}"\ninstrument = "indicator"\ndirection = "{0}"\n'
_ANGLE = '[[setups]]\nname = "angle {0}"\ninstrument = "autocollimator"\ndirection = "{0}"\n'
_ALL = "".join(kind.format(axis) for kind in (_LENGTH, _ANGLE) for axis in "xyz")
MACHINES = {
    "one-axis": (_LENGTH.format("x"), 15),
    "paper-three-stacked": (_LENGTH.format("z"), 15),
    "printer-gantry": (_ALL, 60),
    "three-axis-mill": (_ALL, 60),
    "portal-mill": (_ALL, 60),
    "router": (_ALL, 60),
    "lathe": (_LENGTH.format("x") + _LENGTH.format("z") + _ANGLE.format("y"), 40),
    "dmu60": (_ALL, 60),
}
"""Set-ups and number of readings for each built-in machine."""


@dataclass(frozen=True)
class Covered:
    """How much of one error's band, or of the TCP's, held the truth: a share in [0, 1] for each virtual machine."""

    name: str
    shares: Array

    @property
    def mean(self) -> float:
        """The share over all machines."""
        return float(self.shares.mean())

    @property
    def std(self) -> float:
        """Standard deviation of the mean if the claim is true and a band holds all of its truth or none of it."""
        return float(np.sqrt(CLAIMED * (1 - CLAIMED) / len(self.shares)))


class Trial:
    """One built-in machine with its readings planned, and the bands that they give."""

    def __init__(self, name: str, readings: int | None = None) -> None:
        setups, usual = MACHINES[name]
        text = f'machine = "{name}"\nusual = "off"\nsure = "exactly"\n[target]\nreadings = 1\n{setups}'
        description = campaign_from_texts(text, "campaign.toml", load_machine(name).text, name)
        self.name, self.description = name, description
        self.estimation = estimated(Case(description), planned(Case(description), readings or usual))
        self.visits = list(self.estimation.readings)  # with the times that a zero wanders by
        self.gain = _gain(self.estimation, self.visits)
        self.terms = self.estimation.case.errors.terms
        self.poses, self.approaches = _spread_poses(self.estimation)
        self.tcp_std = tcp_prediction(self.estimation, self.poses, self.approaches)[1]
        self.stds = printed_stds(self.estimation)

    def judged(self, machines: int, first: int = 0) -> list[Covered]:
        """Return the coverage of every error's band and of the TCP's over so many virtual machines."""
        rows = [self._held(self.drawn(seed), seed) for seed in range(first, first + machines)]
        names = [*(term.name for term in self.terms), "TCP"]
        return [Covered(name, shares) for name, shares in zip(names, np.array(rows).T, strict=True)]

    def drawn(self, seed: int) -> VirtualMachine:
        """Return a virtual machine drawn from the prior."""
        return Simulator(self.description.machine, self.description.setups).drawn(seed)

    def estimate(self, machine: VirtualMachine, seed: int) -> Array:
        """Return the coefficients estimated from a machine's readings."""
        coefficients: Array = self.gain @ self.values(machine, seed)
        return coefficients[: self.estimation.case.errors.size]

    def values(self, machine: VirtualMachine, seed: int) -> Array:
        """Return what the set-ups read of a machine."""
        result = np.empty(len(self.visits))
        for setup in self.description.setups:
            mine = [i for i, visit in enumerate(self.visits) if visit.setup == setup.name]
            if mine:
                poses, approaches = _stacked([self.visits[i] for i in mine])
                length = INSTRUMENTS[setup.instrument].model.reads == "length"
                deviation = machine.deviation(poses, approaches) if length else machine.rotation(poses, approaches)
                zero = machine.offsets[setup.name].get("zero", 0.0)
                noise = setup.noise * np.random.default_rng((seed, 3, mine[0])).standard_normal(len(mine))
                moved = machine.drifts.get(setup.name)
                gone = [moved(self.visits[i].time or 0.0)[0] if moved else 0.0 for i in mine]
                result[mine] = deviation @ np.array(setup.direction) + zero + np.array(gone) + noise
        return result

    def _held(self, machine: VirtualMachine, seed: int) -> list[float]:
        estimate = self.estimate(machine, seed)
        shares = [
            _share(curve(positions) - term.rows(positions) @ estimate[term.columns], std)
            for term, curve, (positions, std) in zip(self.terms, machine.curves, self.stds, strict=True)
        ]
        rows = self.estimation.case.errors.rows(self.poses, self.approaches)
        truth = machine.deviation(self.poses, self.approaches)
        return [*shares, _share(truth - rows @ estimate, self.tcp_std)]


def planned(problem: Case, readings: int) -> list[Reading]:
    """Return readings one after another, each the best of the program's candidates; their values are not looked at."""
    known, taken = problem.knowledge, list[Reading]()
    for _ in range(readings):
        scorer = Covariance.from_factor(known.observation, known.belief.factor, problem.yardstick.root).scorer()
        best = int(gains_of(scorer, problem.lattice).argmax())
        setup, pose = problem.description.setups[problem.lattice.setups[best]], problem.lattice.poses[best]
        approach = tuple(int(sign) for sign in problem.lattice.approaches[best])
        taken.append(Reading(setup.name, tuple(pose.tolist()), approach, 0.0))
        known = known.read(taken[-1:])
    return taken


def printed_stds(estimation: Estimation) -> list[tuple[Array, Array]]:
    """Return positions and standard deviations of every error as the report prints them, in SI."""
    shown = {curve.name: curve for curve in curves(estimation, (), None)}
    single = {constant.name: constant for constant in constants(estimation)}
    maps = {plane.name: plane for plane in planes(estimation)}

    def of(function: Term) -> tuple[Array, Array]:
        if isinstance(function, PlaneError):
            plane = maps[function.name]
            at = [from_unit(np.array(x), unit) for x, unit in zip(plane.position, plane.position_unit, strict=True)]
            places = np.stack([grid.ravel() for grid in np.meshgrid(*at, indexing="ij")], axis=1)
            return places, from_unit(np.array(plane.std).ravel(), plane.value_unit)
        if function.name in single:
            one = single[function.name]
            return np.zeros(1), np.array([from_unit(one.std, one.unit)])
        curve = shown[function.name]
        positions = [from_unit(x, curve.position_unit) for x in curve.position]
        return np.array(positions), np.array([from_unit(s, curve.value_unit) for s in curve.std])

    return [of(term) for term in estimation.case.errors.terms]


def _share(error: Array, std: Array) -> float:
    held: NDArray[np.bool_] = np.abs(error) <= _BAND * std
    return float(held[std > 0].mean())


def _gain(estimation: Estimation, visits: list[Reading]) -> Array:
    """Return K with posterior mean = K values: C Hᵀ R⁻¹ with the posterior C."""
    rows, variances, _, _ = seen(estimation.knowledge.observation, visits)
    factor = estimation.knowledge.belief.factor
    return factor @ (rows @ factor).T / variances


def _stacked(visits: list[Reading]) -> tuple[Array, Array]:
    return np.array([v.pose for v in visits]), np.array([v.approach for v in visits], dtype=float)


def _spread_poses(estimation: Estimation) -> tuple[Array, Array]:
    axes, rng = estimation.case.errors.machine.axes, np.random.default_rng(1)
    low, high = np.array([axis.travel for axis in axes]).T
    size = (_POSES, len(axes))
    return rng.uniform(low, high, size), rng.choice([-1.0, 1.0], size)
