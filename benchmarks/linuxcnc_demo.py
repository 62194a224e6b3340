"""The whole loop on a real control: LinuxCNC moves, hidden errors are added, tables go in, the error is gone.

    python -m benchmarks.linuxcnc_demo --out DIR

A campaign drives a LinuxCNC through MDI, what it makes is loaded, LinuxCNC starts anew, and positions that were never
measured are visited as found, with the tables, and with the realtime component that corrects everything at once: on a
mill, on a gantry of two joints, on a mill that is set up in inches, and on swivelling tables with the kinematics that
LinuxCNC brings, in tool centre point mode: one of them has every error that ISO 230-1 names.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ending import Milestone
from axiscal.campaign.sources.source import SimulatedSource
from axiscal.estimation.case import Case
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import AxiscalError
from axiscal.measurement.simulation import Simulator, VirtualMachine
from axiscal.numerics import Array
from axiscal.present.delivery import write_files
from axiscal.tables.offer import Export
from axiscal.tables.registry import export
from axiscal.tables.surface import left_by, rms
from axiscal.units import to_unit
from axiscal_core.threads import one_thread
from tests.linuxcnc.lab import can_compile
from tests.linuxcnc.virtual import EXAMPLES, Build, LinuxcncMachine, description

_WHAT = {
    "three-axis": "mill in mm, trivkins",
    "gantry": "coordinates = XYYZ, trivkins",
    "inch": "the mill with LINEAR_UNITS = inch",
    "xyzac": "xyzac-trt-kins in TCP mode, three spheres",
    "xyzbc": "xyzbc-trt-kins in TCP mode",
    "xyzac-all": "xyzac-trt-kins in TCP mode, all 30 error motions",
}
SEED = 2005
"""Any seed: the demo is to be the same every time."""
_AT_ONCE = 2
"""Machines: while one of them moves, another one is planned for; each LinuxCNC is kept apart."""
POSITIONS = 60
"""An RMS over so many poses is known to a tenth; each takes time of a real LinuxCNC."""


@dataclass(frozen=True, slots=True)
class Loop:
    """What one closed loop came to: RMS of the TCP deviation over the verification positions, m, without the shift, of
    a part the shift and the turn, that setting it up takes off.

    before : as LinuxCNC goes there without anything; tables : with the tables
    std : how far off the prediction they were said to be (RMS)
    whole : with the realtime component, None where it cannot be compiled; messages : of LinuxCNC to the operator
    """

    readings: int
    before: float
    tables: Left
    std: float
    whole: Left | None
    messages: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Left:
    """What is left with files loaded, m.

    after : as LinuxCNC goes there; expected : what was expected, the uncertainty of the estimate included
    missed : how far `after` is from the left deviation that was predicted position by position
    within : in which 95 % of the positions are; certain : U, in which they were said to be
    """

    after: float
    expected: float
    missed: float
    within: float
    certain: float


@one_thread()
def close_loop(name: str, out: Path, seed: int = SEED) -> Loop:
    """Calibrate, compensate and verify one machine; raises ControlError, RecordError, OSError."""
    case, (_, build, options) = Case(description(name)), EXAMPLES[name]
    truth = Simulator(case.description.machine, case.description.setups).drawn(seed)
    record = out / f"{name}.axiscal"
    with Campaign.create(record, case.description) as campaign:
        with LinuxcncMachine(truth, None, build) as control:
            campaign.run(SimulatedSource(control.seen, seed), _unwatched)
        estimation, readings = campaign.estimate(ended=True), len(campaign.state.readings)
    offers = [export(estimation.estimate(), "linuxcnc", options)]
    if can_compile():
        offers.append(export(estimation.estimate(), "linuxcnc-volumetric", options))
    for offered in offers:
        write_files(offered, out / offered.controller / name)
    return _verified(estimation, offers, truth, build, readings)


def _verified(
    estimation: Estimation, offers: Sequence[Export], truth: VirtualMachine, build: Build, readings: int
) -> Loop:
    estimate, yardstick = estimation.estimate(), estimation.case.yardstick
    poses, approaches = _positions(estimate, yardstick.volume.sample)
    std, messages = estimation.accuracy.rms, list[str]()

    def off(deviation: Array) -> Array:
        centred: Array = deviation - deviation.mean(axis=0)
        return centred if yardstick.volume.alignment is None else yardstick.volume.alignment.left(poses, deviation)

    def size(deviation: Array) -> float:
        return rms(off(deviation))

    def seen(offered: Export | None) -> Array:
        with LinuxcncMachine(truth, None if offered is None else offered.files, build) as machine:
            deviation = machine.seen.deviation(poses, approaches)
            messages.extend(machine.errors)
        return deviation

    def judged(offered: Export, found: Array) -> Left:
        foretold = left_by(estimate.machine, estimate.deviation, offered.control, poses, approaches)
        within = float(np.quantile(np.linalg.norm(off(found), axis=1), 0.95))
        expected = float(np.hypot(size(foretold), std))
        return Left(size(found), expected, size(found - foretold), within, offered.certain)

    with ThreadPoolExecutor() as side_by_side:  # each LinuxCNC moves in its own time
        bare, *corrected = side_by_side.map(seen, [None, *offers])
    tables, *whole = (judged(offered, found) for offered, found in zip(offers, corrected, strict=True))
    return Loop(readings, size(bare), tables, std, whole[0] if whole else None, tuple(messages))


def _positions(estimate: Estimate, sample: Array | None) -> tuple[Array, Array]:
    """Return poses (POSITIONS, q) in the volume that no plan has chosen, and directions of approach.

    sample : (m, q) poses of the volume where it is a part
    """
    rng = np.random.default_rng(SEED + 1)
    low, high = np.array(estimate.box).T
    shape = (POSITIONS, len(low))
    inside = low + (high - low) * rng.uniform(size=shape)
    poses: Array = inside if sample is None else sample[rng.choice(len(sample), POSITIONS, replace=False)]
    approaches: Array = rng.choice([-1.0, 1.0], size=shape)
    return poses, approaches


def _unwatched(_: Milestone) -> None:
    """Nobody looks at the single readings."""


def _say(text: str) -> None:
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def _report(name: str, loop: Loop, seconds: float) -> str:
    before, missed, std = (to_unit(value, "um") for value in (loop.before, loop.tables.missed, loop.std))
    return (
        f"{name} ({_WHAT[name]}): {loop.readings} readings through LinuxCNC, files loaded, restarted, {POSITIONS} new "
        f"positions ({seconds:.0f} s)\n"
        f"  RMS deviation of the tool as found  {before:6.2f} um\n"
        f"  with the tables in LinuxCNC         {_left(loop.tables)}\n"
        f"  with the realtime component         {_left(loop.whole)}\n"
        f"  off the prediction by               {missed:6.2f} um   with the tables (stated {std:.2f} um)"
    )


def _left(left: Left | None) -> str:
    if left is None:
        return "not tried, Debian's linuxcnc-uspace-dev and gcc are not installed"
    after, expected, within, certain = (
        to_unit(value, "um") for value in (left.after, left.expected, left.within, left.certain)
    )
    return f"{after:6.2f} um   (expected {expected:.2f} um; 95 % within {within:.2f}, U {certain:.2f} um)"


def _timed(name: str, folder: Path) -> str:
    """Return what a loop came to; raises AxiscalError that goes from one process to another."""
    begun = time.monotonic()
    try:
        return _report(name, close_loop(name, folder), time.monotonic() - begun)
    except AxiscalError as failure:
        raise AxiscalError(f"{name}: {failure}") from None


def main(arguments: list[str]) -> int:
    """Close the loop on every machine; returns the exit status."""
    out = Path(arguments[arguments.index("--out") + 1]) if "--out" in arguments[:-1] else Path("demo-linuxcnc-out")
    folder = out / time.strftime("%Y%m%d-%H%M%S")
    try:
        folder.mkdir(parents=True)
        with ProcessPoolExecutor(_AT_ONCE, get_context("spawn")) as pool:
            for report in pool.map(_timed, EXAMPLES, [folder] * len(EXAMPLES)):
                _say(report)
    except (AxiscalError, OSError) as failure:
        sys.stderr.write(f"{failure}\n")
        return 1
    _say("The realtime component was never run on real drives or on a realtime kernel, and it is no safety function.")
    _say(f"Records, tables and notes: {folder}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
