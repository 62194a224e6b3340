"""The judge of programs that LinuxCNC runs sees what is off, and a few of them are run."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from axiscal.numerics import Array
from tests.certify.kept import Kept
from tests.certify.simulated import Simulated, random_simulated
from tests.certify.simulator import Judge, Trace, verdicts
from tests.generators.program_ways import words
from tests.linuxcnc.lab import available

SEED = 4


@cache
def driven(seed: int) -> tuple[Simulated, Trace]:
    """Return a machine, and what it does when its drives follow its first program as it is written."""
    simulated = random_simulated(seed)
    names = [axis.name for axis in simulated.machine.axes]
    at, poses, lines = dict.fromkeys(names, 0.0), list[list[float]](), list[int]()
    for number, line in enumerate(simulated.jobs[0].text.splitlines(), start=1):
        if line.startswith("G53 G1"):
            to, feed = words(line), float(line.rsplit("F", 1)[1]) / 60
            written = re.findall(r"([XYZABC])(-?[\d.]+)", line)
            before = {name: np.degrees(at[name]) if name in "ABC" else 1e3 * at[name] for name, _ in written}
            way = float(np.linalg.norm([float(value) - before[name] for name, value in written]))
            count = max(1, int(np.ceil(way / (feed * 1e-3))))
            for share in np.linspace(0, 1, count + 1)[1:]:
                between = {name: at[name] + share * (to.get(name, at[name]) - at[name]) for name in names}
                poses.append(list(between.values()))
            lines += [number] * count
            at |= to
        waits = float(line[4:]) if line.startswith("G4 P") else 0.01
        poses += [list(at.values())] * round(waits * 1e3)
        lines += [0] * round(waits * 1e3)
    return simulated, Trace(np.array(poses), np.array(lines))


def faults(seed: int, poses: Array | None = None, kept: NDArray[np.bool_] | None = None) -> str:
    """Return what is said of a trace whose poses are others, or of whose cycles only some are kept."""
    simulated, trace = driven(seed)
    chosen = np.ones(len(trace.lines), dtype=bool) if kept is None else kept
    other = Trace((trace.poses if poses is None else poses)[chosen], trace.lines[chosen])
    return "; ".join(Judge(simulated, simulated.jobs[0], other).judged())


def test_a_program_that_is_followed_is_right() -> None:
    assert faults(SEED) == ""


def test_a_reading_that_is_off_is_seen() -> None:
    _, trace = driven(SEED)
    assert "reading 1" in faults(SEED, trace.poses + 2e-7)


def test_a_reading_without_its_pause_is_seen() -> None:
    _, trace = driven(SEED)
    still = np.zeros(len(trace.lines), dtype=bool)
    still[1:] = np.all(trace.poses[1:] == trace.poses[:-1], axis=1)
    assert "stands for" in faults(SEED, kept=~still)


def test_an_axis_that_is_too_fast_or_leaves_its_travel_is_seen() -> None:
    simulated, trace = driven(SEED)
    assert "moves at" in faults(SEED, kept=(trace.lines == 0) | (np.arange(len(trace.lines)) % 3 == 0))
    low = np.array([axis.travel[0] for axis in simulated.machine.axes])
    assert "goes to" in faults(SEED, np.where(trace.poses == trace.poses.min(axis=0), low - 1e-6, trace.poses))


def test_an_axis_that_does_not_come_is_seen() -> None:
    _, trace = driven(SEED)
    assert "comes over" in faults(SEED, np.tile(trace.poses[-1], (len(trace.poses), 1)))


@pytest.mark.long
@pytest.mark.linuxcnc
@pytest.mark.skipif(not available(), reason="Debian package linuxcnc-uspace is not installed")
def test_a_running_linuxcnc_goes_where_its_program_says(tmp_path: Path) -> None:
    (said,) = verdicts(1, SEED, Kept("simulator", tmp_path))
    assert said[1], said[0]
    assert re.match(r"1 programs of 1 machines with [3-5] readings in [\d,]+ servo cycles, 0 faults", said[0])
