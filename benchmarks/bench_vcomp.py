"""Time of one whole correction, two rounds over a five-axis chain, as LinuxCNC's servo thread runs it."""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import numpy as np

from tests.tables.core_library import Core
from tests.tables.test_controllers import known
from tests.tables.test_vcomp_file import text

COUNT = 20_000


def main() -> None:
    """Print microseconds of processor time per evaluation, along a path and at random places."""
    rng = np.random.default_rng(1)
    machine = known("dmu60")[0].machine
    low, high = np.array([np.array(a.travel) * (np.degrees(1) if a.rotary else 1e3) for a in machine.axes]).T
    tool = np.array([0.0, 0.0, -1e3 * machine.tool_length])
    random = np.ascontiguousarray(rng.uniform(low, high, (COUNT, len(low))))
    path = np.ascontiguousarray(np.linspace(low, high, COUNT))
    with tempfile.TemporaryDirectory() as folder:
        core = Core(Path(folder))
        core.load(text().encode())
        for name, joints in (("along a path", path), ("at random places", random)):
            times = []
            for _ in range(5):
                begun = time.process_time()
                core.correct(joints, np.ones_like(joints), tool)
                times.append((time.process_time() - begun) / COUNT * 1e6)
            print(f"whole correction {name}: {np.median(times):.2f} us of processor time (asked: under 2)")


if __name__ == "__main__":
    main()
