"""How long `axiscal estimate` takes with many readings: a probe along x, y and z at random places of a three-axis mill.

    python benchmarks/bench_estimate.py [--readings 501 2001] [--bare] [--along xyz]

Prints the processor time of the whole command, start and report included.
With --bare sizes are as stated: usual = "off", sure = "exactly".
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from axiscal.description.campaign import CampaignDescription, read_campaign
from axiscal.measurement.reading import approach_text
from axiscal.measurement.simulation import Simulator

CAMPAIGN = """
machine = "three-axis-mill"
[target]
readings = 1
"""
SETUP = """
[[setups]]
name = "probe along {axis}"
instrument = "probe"
direction = "{axis}"
reach = {{ X = ["0 mm", "600 mm"], Y = ["0 mm", "400 mm"], Z = ["0 mm", "400 mm"] }}
noise = "0.5 um"
unknowns = {{ zero = "100 um" }}
approach = "both"
"""
COMMAND = "from axiscal.cli import main; raise SystemExit(main())"


def written(folder: Path, along: str, bare: bool) -> CampaignDescription:
    """Write the campaign file and return what it describes."""
    head = 'usual = "off"\nsure = "exactly"\n' if bare else ""
    path = folder / "campaign.toml"
    path.write_text(head + CAMPAIGN + "".join(SETUP.format(axis=axis) for axis in along), encoding="utf-8")
    return read_campaign(path)


def write_readings(path: Path, description: CampaignDescription, count: int) -> None:
    """Write readings of a virtual machine at random places, from random sides."""
    rng = np.random.default_rng(count)
    machine = Simulator(description.machine, description.setups).drawn(count)
    low, high = np.array([axis.travel for axis in description.machine.axes]).T
    named = ",".join(f"{axis.name}_mm" for axis in description.machine.axes)
    lines = [f"setup,{named},approach,value_um"]
    for pose in np.round(low + (high - low) * rng.random((count, len(low))), 6):
        setup = description.setups[rng.integers(len(description.setups))]
        sides = rng.choice([-1, 1], len(low))
        value = machine.read_all(setup, tuple(pose.tolist()), tuple(sides.tolist()), rng)[0]
        said = approach_text(description.machine.axes, sides.tolist())
        lines.append(",".join([setup.name, *(f"{1e3 * at:.3f}" for at in pose), said, f"{1e6 * value:.4f}"]))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def seconds(folder: Path, description: CampaignDescription, count: int) -> float:
    """Return the processor seconds of one `axiscal estimate`."""
    readings = folder / f"{count}.csv"
    write_readings(readings, description, count)
    arguments = ["estimate", str(folder / "campaign.toml"), str(readings), "--out", str(folder / f"out-{count}")]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, "-c", COMMAND, *arguments], check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--readings", type=int, nargs="+", default=[501, 2001])
    parser.add_argument("--along", default="xyz", help="directions of the probes")
    parser.add_argument("--bare", action="store_true", help="sizes as stated, and nothing besides")
    asked = parser.parse_args()
    print(f"{'readings':>10} {'processor':>12}")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        description = written(folder, asked.along, asked.bare)
        for count in asked.readings:
            print(f"{count:10} {seconds(folder, description, count):10.1f} s", flush=True)


if __name__ == "__main__":
    main()
