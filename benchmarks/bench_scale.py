"""How a plan grows with unknowns, readings and candidates: processor seconds of one thread, memory, and exponents.

    python benchmarks/bench_scale.py [--largest]

Five stacked splines under the criterion `volume`; --largest adds 2,000 unknowns with 100,000 candidates. Each plan is
made by a process of its own, so that its memory is its own, too.
"""

from __future__ import annotations

import resource
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import numpy as np

from axiscal.planning.plan.plan import make_plan
from axiscal.planning.plan.task import Limits
from axiscal_core.threads import one_thread
from benchmarks.cases import stacked
from benchmarks.peers.problems import Stacked

AXES, COLUMNS = 5, ("unknowns", "candidates", "readings")
GROWING = {
    "unknowns": [(100, 4000, 40), (200, 4000, 40), (400, 4000, 40), (800, 4000, 40)],
    "candidates": [(200, 4000, 40), (200, 8000, 40), (200, 16_000, 40), (200, 32_000, 40)],
    "readings": [(200, 4000, 20), (200, 4000, 40), (200, 4000, 80), (200, 4000, 160)],
}
LARGEST = (2000, 100_000, 60)


def planned(unknowns: int, candidates: int, readings: int) -> None:
    """Print the seconds, J and gigabytes of a plan."""
    task = stacked(Stacked("", "", AXES, unknowns // AXES, 0.1, readings), candidates, volume=True)
    begun = time.process_time()
    plan = make_plan(task, Limits(readings=readings))
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    print(time.process_time() - begun, plan.value, memory)


def row(size: tuple[int, int, int]) -> float:
    """Print a row of the table, and return the seconds of its plan."""
    words = [sys.executable, __file__, *map(str, size)]
    seconds, value, memory = map(
        float, subprocess.run(words, check=True, capture_output=True, text=True).stdout.split()
    )
    print(f"| {size[0]} | {size[1]} | {size[2]} | {seconds:.1f} | {memory:.2f} | {value:.4g} |", flush=True)
    return seconds


def main() -> None:
    """Print the table and the exponents."""
    print("| unknowns | candidates | readings | s | GB | J |\n|---|---|---|---|---|---|")
    exponents = {}
    for name, sizes in GROWING.items():
        seconds = [row(size) for size in sizes]
        exponents[name] = np.polyfit(np.log([size[COLUMNS.index(name)] for size in sizes]), np.log(seconds), 1)[0]
    if "--largest" in sys.argv:
        row(LARGEST)
    print("Seconds grow with " + ", ".join(f"{name} to the power {each:.2f}" for name, each in exponents.items()) + ".")


if __name__ == "__main__":
    with one_thread():
        if len(sys.argv) == 4:
            planned(*map(int, sys.argv[1:]))
        else:
            main()
