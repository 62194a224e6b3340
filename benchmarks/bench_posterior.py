"""How long a posterior takes on the demo's five-axis machine: fit, 64 draws and answers, and a further reading.

    python benchmarks/bench_posterior.py [--readings 60 200 2000] [--profile] [--rests]

Prints processor seconds on one thread, and in brackets how many Cholesky factors of a 1,000 x 1,000 matrix that is.
With --rests: true over promised RMS over the volume where rests without a column count as noise, sizes as stated and
rests three times as large, rests of the volume included. It is exact, from a problem in which all rests have columns.
"""

from __future__ import annotations

import argparse
import cProfile
import pstats
import time
from collections.abc import Callable
from dataclasses import replace
from importlib import resources
from typing import TypeVar

import numpy as np

from axiscal.description.campaign import campaign_from_texts
from axiscal.description.usual import usual_machine
from axiscal.estimation.case import Case
from axiscal.estimation.promise import problem as estimate_problem
from axiscal.estimation.promise.posterior import sorted_out
from axiscal.estimation.promise.problem import problem
from axiscal.machine import load_machine
from axiscal.measurement.candidates import spread
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator
from axiscal.numerics import Array
from axiscal.present.demo import measured_truth
from axiscal_core.draws import draws, mode, weighed
from axiscal_core.problem import Problem
from axiscal_core.spaces import turned, variances_of
from axiscal_core.threads import one_thread
from axiscal_core.unknowns import Unknowns, space_of
from axiscal_core.usual import sizes_of

T = TypeVar("T")
_SEED = 2005
TARGETS = {60: (0.5, 0.02), 200: (1.5, 0.05), 2000: (1.0, 0.05)}
"""Processor seconds of a posterior and of a further reading."""


def case_and_readings(count: int) -> tuple[Case, list[Reading]]:
    """Return the demo's machine and readings of it by the first set-up, a minute apart."""
    text = resources.files("axiscal.present.demo").joinpath("campaign.toml").read_text(encoding="utf-8")
    described = campaign_from_texts(text, "campaign.toml", load_machine("dmu60").text, "dmu60")
    simulator = Simulator(described.machine, described.setups)
    machine = simulator.with_curves(measured_truth(Case(described).errors, _SEED), _SEED)
    described = replace(
        described, machine=usual_machine(described.machine, described.setups), setups=described.setups[:1]
    )
    case, setup, rng = Case(described), described.setups[0], np.random.default_rng(count)
    places = spread(described.machine, described.setups, count)
    readings = list[Reading]()
    for index in range(count):
        at = index % len(places)  # the raster of a set-up ends, and places are read again
        pose, sides = tuple(places.poses[at].tolist()), tuple(int(side) for side in places.approaches[at])
        value, *others = machine.read_all(setup, pose, sides, rng, 60.0 * index)
        readings.append(Reading(setup.name, pose, sides, value, others=tuple(others), time=60.0 * index))
    return case, readings


def posed(case: Case, readings: list[Reading]) -> Problem:
    """Return readings as a problem with all that usually goes wrong."""
    described = case.description
    sizes = sizes_of(
        described.machine, [setup.name for setup in described.setups], "roughly", usual=True, inherited=False
    )
    return problem(case.observation, readings, sizes)


def seconds_of(what: Callable[[], T]) -> tuple[float, T]:
    """Return the processor time of a call, and what it returns."""
    start = time.process_time()
    found = what()
    return time.process_time() - start, found


def cholesky_seconds() -> float:
    """Return the least processor time of five factors of a 1,000 x 1,000 matrix."""
    rng = np.random.default_rng(0)
    half = rng.standard_normal((1000, 1000))
    matrix = half @ half.T + 1000 * np.eye(1000)
    return min(seconds_of(lambda: np.linalg.cholesky(matrix))[0] for _ in range(5))


def measure(count: int) -> None:
    """Print the times of one number of readings."""
    unit = cholesky_seconds()
    case, readings = case_and_readings(count + 1)

    def said(name: str, seconds: float, more: str = "") -> None:
        print(f"    {name:28s} {seconds:8.3f} s ({seconds / unit:6.1f}) {more}", flush=True)

    took, first = seconds_of(lambda: posed(case, readings[:count]))
    numbers, columns = first.rows.shape
    print(f"{count} readings: {numbers} numbers, {columns} columns, {len(first.sizes)} sizes")
    said("problem", took)
    space = space_of(first)
    took, best = seconds_of(lambda: mode(space))
    said("  mode", took)
    took, drawn = seconds_of(lambda: draws(space, best))
    said("  draws", took)
    took, found = seconds_of(lambda: weighed(space, drawn))
    said("  weights", took)
    took, _ = seconds_of(lambda: [each.posterior() for each in found.given])
    said("  answers", took)
    whole, now = seconds_of(lambda: sorted_out(first).posterior())
    wanted, further = TARGETS.get(count, (np.nan, np.nan))
    said("posterior", whole, f"wanted {wanted:.2f} s; {now.effective:.0f} draws, {len(now.bad)} bad")
    said("a further reading", another(case, readings), f"wanted {further:.3f} s")


def another(case: Case, readings: list[Reading]) -> float:
    """Return the processor time of one reading more, its problem included."""
    return seconds_of(lambda: sorted_out(posed(case, readings)).posterior())[0]


def rests_left_out(count: int) -> None:
    """Print what it does to the answer that rests without a column count as noise."""
    case, readings = case_and_readings(count)
    few, most = posed(case, readings), estimate_problem.MOST_COLUMNS
    estimate_problem.MOST_COLUMNS = 100_000
    every = posed(case, readings)
    estimate_problem.MOST_COLUMNS = most
    kinds, volume = [size.kind for size in few.sizes.of], case.yardstick
    stated = volume.rest
    for factor in (1.0, 3.0):
        theta = np.log(factor) * np.array([kind == "rest" for kind in kinds])
        true, promised = _squares(every, few, theta, volume.root) + factor**2 * stated
        print(f"{count} readings, rests x {factor:.0f}, {few.rows.shape[1]} columns: {np.sqrt(true / promised):.3f}")


def _squares(every: Problem, few: Problem, theta: Array, root: Array) -> Array:
    """Return true and promised mean squares over the volume of the answer to one problem, (2,) m².

    every : the same readings as they are; root : of the volume, (r, n)
    """
    found = Unknowns(few).given(theta)
    assert found is not None
    values = np.eye(len(few.values))
    half = turned(few, few.rows, theta, found.roots, few.first).T @ found.precision(values)
    gain = root @ few.raw(half, theta, found.roots)[: root.shape[1]] / few.noise
    roots = [curves.roots(theta) for curves in every.curves]
    shown = turned(every, every.rows, theta, roots) * every.noise[:, None]
    own = np.zeros((root.shape[0], shown.shape[1]))
    own[:, every.first :] = root @ every.raw(np.eye(every.answered), theta, roots)[: root.shape[1]]
    true = np.sum((own - gain @ shown) ** 2) + np.sum(gain**2 * variances_of(every, theta) * every.noise**2)
    covariance = found.posterior().covariance[: root.shape[1], : root.shape[1]]
    return np.array([true, np.sum((root @ covariance) * root)])


def main() -> None:
    """Measure what the command line asks for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--readings", type=int, nargs="+", default=list(TARGETS))
    parser.add_argument("--rests", action="store_true", help="show what rests do that have no column")
    parser.add_argument("--profile", action="store_true", help="show where the time of the first posterior goes")
    chosen = parser.parse_args()
    with one_thread():
        for count in chosen.readings:
            if chosen.rests:
                rests_left_out(count)
                continue
            if chosen.profile:
                case, readings = case_and_readings(count)
                first, profile = posed(case, readings), cProfile.Profile()
                with profile:
                    sorted_out(first).posterior()
                pstats.Stats(profile).sort_stats("tottime").print_stats(25)
            measure(count)


if __name__ == "__main__":
    main()
