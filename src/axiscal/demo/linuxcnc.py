"""The whole loop on a real control: LinuxCNC moves, hidden errors are added, tables go in, the error is gone.

    python -m axiscal.demo.linuxcnc --out DIR

A campaign drives a LinuxCNC through MDI, the tables made of it are loaded, LinuxCNC starts anew, and positions that
were never measured are visited with and without them: on a mill, on a gantry of two joints, on a mill that is set up in
inches, and on two swivelling tables with the kinematics that LinuxCNC brings, in tool centre point mode: one of them
touches three spheres itself, by G38.
"""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass, replace
from importlib import resources
from pathlib import Path

import numpy as np

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.milestones import Milestone
from axiscal.campaign.sources.linuxcnc import Build, LinuxcncMachine, LinuxcncSource, Tables
from axiscal.campaign.sources.simulated import SimulatedSource
from axiscal.compensation.effect import left_by, rms
from axiscal.compensation.export_options import ExportOptions
from axiscal.compensation.offer import Export
from axiscal.compensation.registry import export
from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.machine_estimate import Estimate
from axiscal.estimation.ruled import ruled
from axiscal.exceptions import AxiscalError
from axiscal.lab.linuxcnc.probing import Probe
from axiscal.numerics import Array
from axiscal.numerics.threads import one_thread
from axiscal.report.delivery import write_files
from axiscal.simulation import Simulator, VirtualMachine
from axiscal.units import to_unit

_TABLE = Build(tcp=True), ExportOptions(pivots=True)
EXAMPLES: dict[str, tuple[str, Build, ExportOptions]] = {
    "three-axis": ("three-axis", Build(), ExportOptions()),
    "gantry": ("gantry", Build(pairs="Y"), ExportOptions(numbers={"Y": (1, 2)})),
    "inch": ("three-axis", Build(unit="in"), ExportOptions(unit="in")),
    "xyzac": ("xyzac", Build(tcp=True, probe=Probe()), ExportOptions(pivots=True)),
    "xyzbc": ("xyzbc", *_TABLE),
}
"""Name -> whose description it is, how LinuxCNC is set up, what is exported."""
MACHINES = tuple(EXAMPLES)
_WHAT = {
    "three-axis": "mill in mm, trivkins",
    "gantry": "coordinates = XYYZ, trivkins",
    "inch": "the mill with LINEAR_UNITS = inch",
    "xyzac": "xyzac-trt-kins in TCP mode, spheres touched by G38",
    "xyzbc": "xyzbc-trt-kins in TCP mode",
}
SEED = 2005
"""Any seed: the demo is to be the same every time."""
POSITIONS = 60
"""An RMS over so many poses is known to a tenth; each takes time of a real LinuxCNC."""


@dataclass(frozen=True, slots=True)
class Loop:
    """What one closed loop came to: RMS of the TCP deviation over the verification positions, m, without the shift, of
    a part the shift and the turn, that setting it up takes off.

    before, after : as LinuxCNC goes there without and with the tables
    expected : what was expected to be left, the uncertainty of the estimate included
    missed : how far `after` is from the left deviation that was predicted position by position; std : how far it was
    said to be (RMS)
    messages : of LinuxCNC to the operator
    """

    readings: int
    before: float
    after: float
    expected: float
    missed: float
    std: float
    messages: tuple[str, ...]


def description(name: str) -> CampaignDescription:
    """Return the campaign on one of `MACHINES`."""
    folder = resources.files("axiscal.demo").joinpath("linuxcnc_machines")
    stem = EXAMPLES[name][0]
    machine, campaign = (
        folder.joinpath(f"{stem}.{kind}.toml").read_text(encoding="utf-8") for kind in ("machine", "campaign")
    )
    return campaign_from_texts(campaign, f"{stem}.campaign.toml", machine, f"{stem}.machine.toml")


@one_thread()
def close_loop(name: str, out: Path, seed: int = SEED) -> Loop:
    """Calibrate, compensate and verify one machine; raises ControlError, RecordError, OSError."""
    case, (_, build, options) = Case(description(name)), EXAMPLES[name]
    truth = Simulator(case.description.machine, case.description.setups).drawn(seed)
    record = out / f"{name}.axiscal"
    with Campaign.create(record, case.description) as campaign:
        source = LinuxcncSource(truth, lambda machine: SimulatedSource(machine, seed), build=build, seed=seed)
        try:
            campaign.run(source, _unwatched)
        finally:
            source.close()
        estimation, readings = ruled(campaign.concluded()), len(campaign.state.readings)
    tables = export(estimation.estimate(), "linuxcnc", options)
    write_files(tables, out / "tables" / name)
    return _verified(estimation, tables, truth, build, readings)


def _verified(estimation: Estimation, tables: Export, truth: VirtualMachine, build: Build, readings: int) -> Loop:
    estimate, yardstick = estimation.estimate(), estimation.case.yardstick
    poses, approaches = _positions(estimate, yardstick.sample)
    seen: list[Array] = []
    messages: list[str] = []
    for loaded in (None, Tables(tables.files)):
        with LinuxcncMachine(truth, loaded, replace(build, probe=None)) as machine:
            seen.append(machine.seen.deviation(poses, approaches))
            messages += machine.errors
    left = left_by(estimate.machine, estimate.deviation, tables.control, poses, approaches)

    def size(deviation: Array) -> float:
        return rms(deviation if yardstick.alignment is None else yardstick.alignment.left(poses, deviation))

    std = estimation.accuracy.rms
    expected = float(np.hypot(size(left), std))
    return Loop(readings, size(seen[0]), size(seen[1]), expected, size(seen[1] - left), std, tuple(messages))


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
    before, after, expected, missed, std = (
        to_unit(value, "um") for value in (loop.before, loop.after, loop.expected, loop.missed, loop.std)
    )
    return (
        f"{name} ({_WHAT[name]}): {loop.readings} readings through LinuxCNC, tables loaded, restarted, {POSITIONS} new "
        f"positions ({seconds:.0f} s)\n"
        f"  RMS deviation of the tool before    {before:6.2f} um\n"
        f"  after, with the tables in LinuxCNC  {after:6.2f} um   (expected {expected:.2f} um)\n"
        f"  off the prediction by               {missed:6.2f} um   (stated {std:.2f} um)"
    )


def main(arguments: list[str]) -> int:
    """Close the loop on every machine; returns the exit status."""
    out = Path(arguments[arguments.index("--out") + 1]) if "--out" in arguments[:-1] else Path("demo-linuxcnc-out")
    folder = out / time.strftime("%Y%m%d-%H%M%S")
    try:
        folder.mkdir(parents=True)
        for name in MACHINES:
            begun = time.monotonic()
            loop = close_loop(name, folder)
            _say(_report(name, loop, time.monotonic() - begun))
    except (AxiscalError, OSError) as failure:
        sys.stderr.write(f"{failure}\n")
        return 1
    _say(f"Records, tables and notes: {folder}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
