"""Programs that a real LinuxCNC runs, held to their plans by where its motors were sent in every servo cycle."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from axiscal.machine.axis import Axis
from axiscal.measurement.reading import Place
from axiscal.numerics import Array
from tests.certify.kept import Kept
from tests.certify.simulated import ACCELERATION, PROGRAMS, Job, Simulated, random_simulated
from tests.linuxcnc.lab import Session, Settings, available

_FINE = 1000.0
"""The sampler writes six decimals; positions come to it in thousandths of mm and deg, so that it writes nine."""
_STEP = 1e-4
"""mm or deg, the last decimal of a coordinate in the machine's own coordinates."""
_SMOOTHED = 4
"""Cycles for which two moves may overlap: LinuxCNC smooths them."""
_LATE = 0.05
"""s, of a pause: it is timed by the clock, and a busy computer misses servo cycles, which are not sampled."""
_CYCLE = 1e-3
"""s"""
_CORNER = ACCELERATION * _CYCLE**2 / 2
"""mm or deg, by which a corner may be passed between two cycles: a move begins in the cycle in which another ends."""


def hal(count: int) -> str:
    """Return HAL text that samples where so many motors are sent, and the line of the program that moves them."""
    names = ",".join(f"fine{n}" for n in range(count))
    lines = [f"loadrt scale names={names}", f"loadrt sampler depth=100000 cfg={'f' * count}s"]
    for n in range(count):
        lines += [f"addf fine{n} servo-thread", f"setp fine{n}.gain {_FINE}", f"net j{n}m => fine{n}.in"]
        lines += [f"net f{n} fine{n}.out => sampler.0.pin.{n}"]
    lines += [f"net line motion.program-line => sampler.0.pin.{count}", "addf sampler.0 servo-thread"]
    return "\n".join([*lines, "setp sampler.0.enable 0"]) + "\n"


@dataclass(frozen=True)
class Trace:
    """What a LinuxCNC did with a program.

    poses : (n, q) of every servo cycle, m and rad, in the order of the machine's axes; lines : (n,) of the program,
    from 1, that moves there, 0 where none does
    """

    poses: Array
    lines: NDArray[np.int_]

    def ends(self) -> dict[int, tuple[int, int]]:
        """Return of each line that moves the last cycle of its move, and the last one before the next move."""
        moving = np.flatnonzero(self.lines)
        last = [*(k for k, n in pairwise(moving) if self.lines[k] != self.lines[n]), moving[-1]]
        begins = [int(moving[np.searchsorted(moving, k) + 1]) for k in last[:-1]]
        stops = [begin - 1 for begin in begins] + [len(self.lines) - 1]
        return {int(self.lines[k]): (int(k), stop) for k, stop in zip(last, stops, strict=True)}


class Judge:
    """Knows a plan, and collects what its program should not have done."""

    def __init__(self, simulated: Simulated, job: Job, trace: Trace) -> None:
        self._simulated, self._job, self._trace = simulated, job, trace
        self._axes, self.faults = simulated.machine.axes, list[str]()

    def judged(self) -> list[str]:
        """Return what is wrong."""
        self._within()
        at = self._readings()
        for number, place in enumerate(self._job.places, start=1):
            if number not in at:
                self.faults.append(f"reading {number} is not in the program")
                continue
            end, stop = at[number]
            self._stands(number, place, stop)
            self._waits(number, end, stop)
            self._comes(number, place, stop)
        return self.faults

    def _readings(self) -> dict[int, tuple[int, int]]:
        """Return of each reading the last cycle of the way to it, and the last one before the next way."""
        ends, found = self._trace.ends(), dict[int, tuple[int, int]]()
        for line, text in enumerate(self._job.text.splitlines(), start=1):
            if mark := re.fullmatch(r"\(READING (\d+)\)", text):
                found[int(mark[1])] = ends[max(moved for moved in ends if moved < line)]
        return found

    def _within(self) -> None:
        """Nothing leaves its travel, is faster than it may be, or moves beside an axis of another family."""
        poses, steps = self._trace.poses, np.abs(np.diff(self._trace.poses, axis=0))
        for k, axis in enumerate(self._axes):
            slack = _unit(axis) * 1e-6
            low, high = axis.travel
            if poses[:, k].min() < low - slack or poses[:, k].max() > high + slack:
                self.faults.append(f"{axis.name} goes to {poses[:, k].min()}, {poses[:, k].max()}; {axis.travel}")
            if steps[:, k].max(initial=0.0) > axis.speed * _CYCLE * (1 + 1e-6) + slack:
                self.faults.append(f"{axis.name} moves at {steps[:, k].max() / _CYCLE}")
        turning = np.any(steps[:, [axis.rotary for axis in self._axes]] > 0, axis=1)
        going = np.any(steps[:, [not axis.rotary for axis in self._axes]] > 0, axis=1)
        if _longest(np.logical_and(turning, going)) > _SMOOTHED:
            self.faults.append("linear and rotary axes move together")

    def _stands(self, number: int, place: Place, stop: int) -> None:
        pose = self._trace.poses[stop]
        for axis, here, planned in zip(self._axes, pose, place.pose, strict=True):
            off = abs(here - planned)
            off = min(off, abs(off - math.tau)) if axis.cyclic else off
            ends = min(planned - axis.travel[0], axis.travel[1] - planned) < _STEP * _unit(axis)
            rounded = _STEP if ends else _STEP / 2  # the next number may be outside of the travel
            if off > _unit(axis) * (rounded + 1e-6):
                self.faults.append(f"reading {number}: {axis.name} is {off / _unit(axis)} off")

    def _waits(self, number: int, end: int, stop: int) -> None:
        still = np.all(self._trace.poses[end + 1 : stop + 1] == self._trace.poses[stop], axis=1)
        moved = np.flatnonzero(~still)
        stood = (len(still) - (moved[-1] + 1 if len(moved) else 0)) * _CYCLE
        setup = self._job.setup
        wanted = setup.settle + (setup.reading_time if setup.driving.dwell else 0.0)
        if stood < wanted - _LATE:
            self.faults.append(f"reading {number}: stands for {stood} s instead of {wanted}")

    def _comes(self, number: int, place: Place, stop: int) -> None:
        """Each axis comes from its side over its overrun, as far as the travel leaves room."""
        for k, (axis, side) in enumerate(zip(self._axes, place.approach, strict=True)):
            if side == 0:
                continue
            path = side * (self._trace.poses[stop, k] - self._trace.poses[: stop + 1, k])[::-1]
            turned = np.flatnonzero(np.diff(path) < -_unit(axis) * 1e-7)
            come = path[turned[0] if len(turned) else -1]
            low, high = axis.travel
            here = self._trace.poses[stop, k]
            room = here - low if side > 0 else high - here
            if come < min(axis.overrun, room) - (3 * _STEP + _CORNER) * _unit(axis):
                self.faults.append(f"reading {number}: {axis.name} comes over {come} instead of {axis.overrun}")


def _longest(marked: NDArray[np.bool_]) -> int:
    """Return how many cycles in a row are marked at the most."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], marked, [False]]).astype(int)))
    return int((edges[1::2] - edges[::2]).max(initial=0))


def _unit(axis: Axis) -> float:
    """Return a mm in m, or a degree in rad."""
    return math.radians(1.0) if axis.rotary else 1e-3


@dataclass(frozen=True)
class Found:
    """programs, readings, cycles : how many; faults : what should not have been done"""

    programs: int
    readings: int
    cycles: int
    faults: tuple[str, ...]


def found_on(simulated: Simulated, most: int) -> Found:
    """Return what a LinuxCNC made of the first programs of a machine."""
    jobs = simulated.jobs[:most]
    beside = {f"p{n}.ngc": job.text for n, job in enumerate(jobs)}
    settings = Settings(hal(len(simulated.joints)), beside=beside)
    readings, cycles, faults = 0, 0, list[str]()
    with Session(simulated.joints, settings, timeout=600) as session:
        for n, job in enumerate(jobs):
            rows = np.array(session.sample([f"run p{n}.ngc"]))
            if session.errors or not rows[:, -1].any():
                unrun = f"program {n + 1} was not run: {'; '.join(session.errors)}"
                return Found(n, readings, cycles, (*faults, unrun))
            units = np.array([_unit(axis) for axis in simulated.machine.axes])
            trace = Trace(rows[:, list(simulated.order)] / _FINE * units, rows[:, -1].astype(int))
            faults += [f"program {n + 1}: {fault}" for fault in Judge(simulated, job, trace).judged()]
            readings, cycles = readings + len(job.places), cycles + len(rows)
    return Found(len(jobs), readings, cycles, tuple(faults))


def verdicts(most: int, first: int, kept: Kept) -> Iterator[tuple[str, bool]]:
    """Yield of each machine what a LinuxCNC made of its programs, then the sum, and whether nothing was wrong.

    kept : what an earlier run has found, which goes on here
    """
    if not available():
        yield "Debian's linuxcnc-uspace is not installed", False
        return
    found = list[Found]()
    for seed in range(first, first + math.ceil(most / PROGRAMS)):
        left = min(PROGRAMS, most - sum(each.programs for each in found))
        said = Found(**kept.get(f"machine {seed}, {left}", partial(_found, seed, left)))
        found.append(said)
        if said.faults:
            yield f"machine {seed}: {'; '.join(said.faults[:3])}", False
    counts = [(each.programs, each.readings, each.cycles, len(each.faults)) for each in found]
    ran, readings, cycles, wrong = map(sum, zip(*counts, strict=True))
    text = f"{ran:,} programs of {len(found)} machines with {readings:,} readings in {cycles:,} servo cycles"
    yield f"{text}, {wrong} faults", not wrong


def _found(seed: int, most: int) -> dict[str, Any]:
    return asdict(found_on(random_simulated(seed), most))
