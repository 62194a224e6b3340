"""Stations that nobody knows: four tracers on a three-axis machine, stated as far off as the row says."""

from __future__ import annotations

import re
from typing import NamedTuple

import numpy as np

from axiscal.description.campaign import campaign_from_texts
from axiscal.errors.volume import deviation_of
from axiscal.estimation.belief import Belief
from axiscal.estimation.case import Case
from axiscal.estimation.located import absorbed
from axiscal.estimation.stations import BentReadings, closed_form, polished
from axiscal.machine import load_machine
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator, VirtualMachine
from benchmarks.nonlinear.other_ways import gauss_newton, sigma_points

STATIONS = (("-900", "-700", "-500"), ("900", "-600", "-100"), ("-200", "900", "-600"), ("100", "100", "700"))
_POINTS, _POSES = 45, 150


def tracers(std: str, dead_path: str) -> Case:
    """Return the three-axis mill with few knots, and four tracers.  std : of each coordinate of a station"""
    text = re.sub(r", rest = [^}]*", " ", re.sub(r"knots = \d+", "knots = 4", load_machine("three-axis-mill").text))
    setups = [
        f"""[[setups]]
name = "tracer {number}"
instrument = "tracer"
station = [{", ".join(f'"{each} mm"' for each in station)}]
approach = "both"
[setups.unknowns]
zero = "{dead_path}"
station_x = "{std}"
station_y = "{std}"
station_z = "{std}"
"""
        for number, station in enumerate(STATIONS, 1)
    ]
    head = 'machine = "m"\n[target]\nreadings = 1\n'
    return Case(campaign_from_texts(head + "".join(setups), "c.toml", text, "m"))


def at_once(std: str, dead_path: str) -> Case:
    """Return the same machine with all four tracers in one set-up."""
    places = ", ".join("[" + ", ".join(f'"{each} mm"' for each in station) + "]" for station in STATIONS)
    known = ", ".join(f'station_{axis} = "{std}"' for axis in "xyz")
    setup = f'[[setups]]\nname = "beams"\ninstrument = "tracer"\nstations = [{places}]\napproach = "both"\n'
    text = f'machine = "m"\n[target]\nreadings = 1\n{setup}unknowns = {{ zero = "{dead_path}", {known} }}\n'
    return Case(campaign_from_texts(text, "c.toml", tracers(std, dead_path).description.machine.text, "m"))


CENTRES = (("150", "150", "100"), ("350", "150", "200"), ("250", "250", "100"))


def bars(std: str, radius: str) -> Case:
    """Return the same machine with a ball bar about three centres.  std : of each coordinate of a centre"""
    setups = [
        f"""[[setups]]
name = "centre {number}"
instrument = "ballbar"
length = "150 mm"
station = [{", ".join(f'"{each} mm"' for each in centre)}]
approach = "both"
unknowns = {{ zero = "{radius}", station_x = "{std}", station_y = "{std}", station_z = "{std}" }}
"""
        for number, centre in enumerate(CENTRES, 1)
    ]
    text = f'machine = "m"\n[target]\nreadings = 1\n{"".join(setups)}'
    return Case(campaign_from_texts(text, "c.toml", tracers(std, radius).description.machine.text, "m"))


def read(case: Case, seed: int) -> tuple[VirtualMachine, list[Reading]]:
    """Return a machine with stations drawn from the prior, and readings at random poses."""
    rng = np.random.default_rng(seed)
    machine = Simulator(case.description.machine, case.description.setups).drawn(seed)
    low, high = np.array([axis.travel for axis in case.description.machine.axes]).T
    readings = []
    for index, setup in enumerate(case.description.setups):
        for _ in range(_POINTS):
            pose, side = tuple(rng.uniform(low, high).tolist()), tuple(int(s) for s in rng.choice([-1, 1], len(low)))
            if setup.length is not None:
                poses, sides = case.lattice.in_setup(index)
                at = int(rng.integers(len(poses)))
                pose, side = tuple(poses[at].tolist()), tuple(int(s) for s in sides[at])
            readings.append(Reading(setup.name, pose, side, machine.read_all(setup, pose, side, rng)[0], time=0.0))
    return machine, readings


class Found(NamedTuple):
    """missed : RMS at the tool of truth less estimate, mean shift taken off, m; held : share within 95 % along an axis

    station : largest error of a station or dead path, m; nees : of all stations and dead paths together, per number
    """

    missed: float
    held: float
    station: float
    nees: float


def judged(case: Case, machine: VirtualMachine, belief: Belief) -> Found:
    """Return how right an estimate is."""
    axes, errors = case.description.machine.axes, case.errors
    low, high = np.array([axis.travel for axis in axes]).T
    poses = np.random.default_rng(7).uniform(low, high, (_POSES, len(low)))
    sides = np.ones_like(poses)
    rows = errors.rows(poses, sides)
    left = machine.deviation(poses, sides) - deviation_of(errors, belief.mean[: errors.size], poses, sides).displacement
    std = np.sqrt(np.sum((rows @ belief.factor[: errors.size]) ** 2, axis=2))
    about = left - left.mean(axis=0)
    truth = np.zeros(case.observation.size)
    for index, setup in enumerate(case.description.setups):
        truth[case.observation.unknowns_of(index)] = list(machine.offsets[setup.name].values())
    off, root = truth[errors.size :] - belief.mean[errors.size : len(truth)], belief.factor[errors.size : len(truth)]
    nees = float(off @ np.linalg.solve(root @ root.T, off)) / len(off)
    held = float(np.mean(np.abs(left) < 1.96 * std))
    return Found(float(np.sqrt(np.mean(np.sum(about**2, axis=1)))), held, float(np.abs(off).max()), nees)


class Row(NamedTuple):
    """What became of one machine; cost : of the optimum from the prior, over that from closed form."""

    linear: Found
    by_points: Found
    by_rounds: Found
    damped: Found
    cost: float


def compared(case: Case, seed: int) -> Row:
    """Return a machine estimated once about the stated stations, by sigma points, in three rounds and by damping."""
    machine, readings = read(case, seed)
    problem = BentReadings(case, readings)
    best, other = (
        polished(problem, start) for start in (case.prior.mean, closed_form(case, readings, case.prior.mean))
    )
    linear, found = (
        judged(case, machine, absorbed(each, readings, {}).knowledge.belief)
        for each in (case, case.linear_about(best.point))
    )
    by_points, by_rounds = (judged(case, machine, way(problem)) for way in (sigma_points, gauss_newton))
    return Row(linear, by_points, by_rounds, found, best.cost / other.cost)
