"""Coverage on virtual machines drawn from the prior, with that prior and with priors that are wrong by three."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.estimation.accuracy.expanded import BAND
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.prediction import tcp_prediction
from axiscal.machine import load_machine
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Curve, Simulator, VirtualMachine
from axiscal.numerics import Array
from axiscal.present.findings import findings
from axiscal_core.errors import Error
from axiscal_core.machine import Machine
from benchmarks.trust.kept import Trial, Tried, one_by_one

_LENGTH = '[[setups]]\nname = "length {0}"\ninstrument = "indicator"\ndirection = "{0}"\napproach = "both"\n'
_ANGLE = '[[setups]]\nname = "angle {0}"\ninstrument = "autocollimator"\ndirection = "{0}"\n'
_ALL = "".join(kind.format(axis) for kind in (_LENGTH, _ANGLE) for axis in "xyz")
SETUPS = {"one-axis": _LENGTH.format("x"), "three-axis-mill": _ALL, "dmu60": _ALL}
READINGS = {"one-axis": 15, "three-axis-mill": 60, "dmu60": 90}
_POSES = 80
_POSITIONS = 101
"""Of each curve; any number that is finer than its knots would do."""
_JUDGED = 40
"""Machines whose reports are looked at."""
_AMONG = 30
"""Readings, of which one is bad."""


@dataclass(frozen=True)
class Coverage:
    """curves, tcp : share of the truth in the 95 % band over all machines; error : standard error of `curves`

    misfit : share of the machines of which the report says that the prior did not fit
    """

    machine: str
    wrong: float
    scales: str
    machines: int
    curves: float
    error: float
    tcp: float
    misfit: float


def described(name: str, wrong: float, scales: str) -> tuple[CampaignDescription, Machine]:
    """Return a campaign whose stated prior is the true one times `wrong`, and the machine with the true one.

    scales : "stated", what is stated alone; "estimate", what usually goes wrong, and sizes that are learnt
    """
    head = 'usual = "off"\nsure = "exactly"\n' if scales == "stated" else ""
    text = f'machine = "{name}"\n{head}[target]\nreadings = 1\n{SETUPS[name]}'
    description = campaign_from_texts(text, "campaign.toml", load_machine(name).text, name)
    true = load_machine(name)

    def stated(entry: Error) -> Error:
        rest = entry.rest if entry.rest is None or entry.sides else entry.rest * wrong
        return replace(entry, std=entry.std * wrong, rest=rest)

    machine = description.machine
    return replace(description, machine=replace(machine, errors=tuple(map(stated, machine.stated)))), true


def covered(name: str, wrong: float, scales: str, machines: int, tried: Tried = one_by_one) -> Coverage:
    """Return the coverage over so many virtual machines.  scales : as `described` has it"""
    found = tried(held, [(name, wrong, scales, seed) for seed in range(machines)])
    rows = np.array([[each["curves"], each["tcp"], each["misfit"]] for each in found], dtype=float)
    curves, tcp, misfit = np.nanmean(rows, axis=0)
    return Coverage(name, wrong, scales, machines, curves, float(rows[:, 0].std() / np.sqrt(machines)), tcp, misfit)


@cache
def _drawn_from(name: str, wrong: float, scales: str) -> tuple[Case, Simulator]:
    description, true = described(name, wrong, scales)
    return Case(description), Simulator(true, description.setups)


def held(trial: Trial) -> dict[str, float | None]:
    """Return the shares of one machine that its bands hold, and whether its report says that the prior does not fit.

    trial : machine, how many times too large its prior is stated, what is learnt, and seed
    """
    name, wrong, scales, seed = trial
    problem, simulator = _drawn_from(name, wrong, scales)
    machine, rng = simulator.drawn(seed), np.random.default_rng((seed, 9))
    estimation = concluded(problem, read_evenly(problem, machine, rng, READINGS[name]))
    low, high = np.array([axis.travel for axis in problem.description.machine.axes]).T
    poses = rng.uniform(low, high, (_POSES, len(low)))
    approaches = rng.choice([-1.0, 1.0], poses.shape)
    return {
        "curves": float(curves_held(estimation, machine)),
        "tcp": float(tcp_held(estimation, machine, poses, approaches)),
        "misfit": float(any(each.code == "prior-misfit" for each in findings(estimation))) if seed < _JUDGED else None,
    }


def curves_held(estimation: Estimation, machine: VirtualMachine) -> float:
    """Return the share of all error curves, at 101 positions each, that lies in their 95 % bands."""
    names = [term.name for term in machine.model.terms]
    inside = [
        _curve(estimation, name, machine.curves[names.index(name)])
        for name in estimation.case.errors.by_name
        if name in names
    ]
    return float(np.mean(np.concatenate(inside)))


def _curve(estimation: Estimation, name: str, truth: Curve) -> Array:
    function = estimation.case.errors.by_name[name]
    positions = np.linspace(function.spline.knots[0], function.spline.knots[-1], _POSITIONS)
    mean, std = estimation.estimate().curve(name, positions)
    return (np.abs(truth(positions) - mean) <= BAND * std).astype(float)


def tcp_held(estimation: Estimation, machine: VirtualMachine, poses: Array, approaches: Array) -> float:
    """Return the share of the TCP deviations along x, y, z at poses (m, q) that lies in their 95 % bands."""
    mean, std = tcp_prediction(estimation, poses, approaches)
    moves = std > 0
    inside = np.abs(machine.deviation(poses, approaches) - mean)[moves] <= BAND * std[moves]
    return float(inside.mean())


def read_evenly(problem: Case, machine: VirtualMachine, rng: np.random.Generator, readings: int) -> list[Reading]:
    """Return readings of a virtual machine that fill the space, each set-up in turn."""
    taken, setups = list[Reading](), problem.description.setups
    low, high = np.array([axis.travel for axis in problem.description.machine.axes]).T
    for number in range(readings):
        setup = setups[number % len(setups)]
        share = (number + rng.uniform(0, 1)) / readings if len(low) == 1 else rng.uniform(0, 1, len(low))
        pose = tuple((low + (high - low) * share).tolist())
        approach = tuple(int(sign) for sign in rng.choice([-1, 1], len(low)))
        taken.append(Reading(setup.name, pose, approach, machine.read_all(setup, pose, approach, rng)[0]))
    return taken


@dataclass(frozen=True)
class Moved:
    """How far one gross error moves the curves: the largest shift in units of the σ printed beside it, over all curves.

    worst : over all trials; typical : the median; rejected : share of the gross errors that were not believed
    naive : the worst shift when every reading is believed and U is printed
    within : share of the trials that move by at most σ/2
    withheld : share of the trials of which U is withheld when every reading is believed
    """

    size: float
    worst: float
    typical: float
    rejected: float
    naive: float
    within: float
    withheld: float


def gross(size: float, trials: int, tried: Tried = one_by_one) -> Moved:
    """Return what one reading that is wrong by `size` (m) among 30 does to the curves of the one-axis machine."""
    found = list(tried(moved, [(size, seed) for seed in range(trials)]))
    names = "shift", "naive", "found", "withheld"
    shifts, naive, rejected, withheld = (np.array([each[name] for each in found]) for name in names)
    return Moved(
        size=size,
        worst=float(shifts.max()),
        typical=float(np.median(shifts)),
        rejected=float(rejected.mean()),
        naive=float(naive[withheld == 0].max(initial=0.0)),
        within=float(np.mean(shifts <= 0.5)),
        withheld=float(withheld.mean()),
    )


def moved(trial: Trial) -> dict[str, float]:
    """Return how far one bad reading moves the curves of one machine.  trial : its size, m, and the machine's seed

    shift : beside the right reading; naive : where all are believed, withheld : 1 where they then contradict
    found : 1 where it is not believed
    """
    size, seed = trial
    problem, simulator = _drawn_from("one-axis", 1.0, "estimate")
    rng = np.random.default_rng((seed, 11))
    taken = read_evenly(problem, simulator.drawn(seed), rng, _AMONG)
    bad = int(rng.integers(_AMONG))
    wrong = [replace(r, value=r.value + size * (index == bad)) for index, r in enumerate(taken)]
    judged, believed = concluded(problem, wrong), concluded(problem, _vouched_for(wrong))
    return {
        "shift": _shift(concluded(problem, taken), judged),
        "naive": _shift(concluded(problem, _vouched_for(taken)), believed),
        "withheld": float(believed.agreement.withheld),
        "found": float(any(d.reading == bad for d in judged.outliers)),
    }


def _vouched_for(readings: Sequence[Reading]) -> list[Reading]:
    return [replace(reading, accepted=True) for reading in readings]


def _shift(clean: Estimation, other: Estimation) -> float:
    """Return the largest distance between two estimates, in units of the second one's σ."""
    largest = 0.0
    for function in clean.case.errors.curves:
        positions = np.linspace(function.spline.knots[0], function.spline.knots[-1], 101)
        was, now = (each.estimate().curve(function.name, positions) for each in (clean, other))
        largest = max(largest, float(np.max(np.abs(now.mean - was.mean) / now.std)))
    return largest
