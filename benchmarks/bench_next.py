"""How long the next measurement takes: one spline of 7 knots, three stacked splines, the five-axis machine.

    python benchmarks/bench_next.py

Prints the median over the readings of a campaign, of wall and of processor time: the second holds on a busy computer.
"""

from __future__ import annotations

import statistics
import time

from axiscal.errors.model import ErrorModel
from axiscal.errors.volume import volume_moments, whole_travel
from axiscal.estimation.accuracy import criterion
from axiscal.estimation.knowledge import Knowledge
from axiscal.machine import Machine, load_machine, machine_from_text
from axiscal.measurement.candidates import spread
from axiscal.measurement.observation import Observation
from axiscal.measurement.setup import Approach, Setup
from axiscal.numerics.threads import one_thread
from axiscal.planning.step.best_step import best_step

ONE_SPLINE = """
chain = "w-b-X-t"
[axes.X]
travel = ["0 mm", "10 mm"]
[errors]
EXX = { std = "1 mm", knots = 7 }
"""
CASES = (
    ("one spline of 7 knots", machine_from_text(ONE_SPLINE, "one spline"), (1.0, 0.0, 0.0), 1e-4, 10, "1 ms"),
    ("three stacked splines of 7 knots", load_machine("paper-three-stacked"), (0.0, 0.0, 1.0), 1e-5, 15, "10 ms"),
    ("five-axis machine, all error motions", load_machine("dmu60"), (0.0, 1.0, 0.0), 1e-6, 10, "1 s"),
)


def setup_of(machine: Machine, direction: tuple[float, float, float], noise: float) -> Setup:
    """Return a probe that may read anywhere, from both sides where there is a reversal to see."""
    sides: Approach = "both" if any(error.kind == "reversal" for error in machine.errors) else "+"
    count = len(machine.axes)
    middle = tuple(sum(axis.travel) / 2 for axis in machine.axes)
    return Setup(
        "probe", "probe", direction, tuple(range(count)), middle, noise, (), 0.0, 0.0, 0.0, (0.0,) * count, sides
    )


def picks(
    machine: Machine, direction: tuple[float, float, float], noise: float, readings: int
) -> list[tuple[float, float]]:
    """Return wall and processor seconds of each choice of a campaign."""
    model = ErrorModel(machine)
    setup = setup_of(machine, direction, noise)
    observation = Observation(model, (setup,))
    knowledge = Knowledge.before(observation)
    root = criterion.Root.of_gram(volume_moments(model, whole_travel(model)).gram)
    lattice = spread(machine, (setup,), 1000)
    times = []
    for _ in range(readings):
        wall, processor = time.perf_counter(), time.process_time()
        step = best_step(knowledge, root, lattice)
        times.append((time.perf_counter() - wall, time.process_time() - processor))
        knowledge = knowledge.read([step.reading(observation)])
    return times


def main() -> None:
    """Print the table."""
    print(f"{'next measurement':40} {'wall':>10} {'processor':>10}   asked")
    for name, machine, direction, noise, readings, asked in CASES:
        wall, processor = zip(*picks(machine, direction, noise, readings), strict=True)
        shown = [f"{1e3 * statistics.median(times):8.2f} ms" for times in (wall, processor)]
        print(f"{name:40} {shown[0]:>10} {shown[1]:>10}   {asked}")


if __name__ == "__main__":
    with one_thread():
        main()
