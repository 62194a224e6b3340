"""What the main paths ask of the processor, beside what is aimed at.

    python benchmarks/bench_paths.py [--only plan] [--long] [--beside ../checkout]

Processor seconds of whole commands on one thread, and the calls of functions that a second run takes. --long adds the
records of 2,000 readings, estimates of 2,001, and 1,000 unknowns with 10,000 readings. --beside runs each path by the
sources of another checkout as well, right after: how fast a machine is, and what else it does, is then the same for
both, and the ratio is theirs.
"""

from __future__ import annotations

import argparse
import os
import pstats
import resource
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib import resources
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import numpy as np

from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import CampaignDescription, read_campaign
from axiscal.description.placed_readings import placed_readings
from axiscal.estimation.case import Case
from axiscal.measurement.readers.files import read_any
from axiscal.measurement.reading import Reading
from axiscal.planning.next_readings import posed
from axiscal.present.demo import SEED, description, hidden_machine
from axiscal.record.events import Asked
from benchmarks import bench_estimate

ROOT = Path(__file__).resolve().parents[1]
AXIS = """machine = "one-axis"
[target]
readings = 20
[[setups]]
name = "laser"
instrument = "interferometer"
direction = "x"
noise = "0.5 um"
approach = "both"
"""
COMMAND = "from axiscal.cli import main; raise SystemExit(main())"
PROFILED = (
    "import cProfile, sys; from axiscal.cli import main; kept, watched = sys.argv.pop(), cProfile.Profile(); "
    "status = watched.runcall(main); watched.dump_stats(kept); raise SystemExit(status)"
)
DENSE = """chain = "w-b-Z-Y-X-t"
[axes.X]
travel = ["0 mm", "1000 mm"]
[axes.Y]
travel = ["0 mm", "1000 mm"]
[axes.Z]
travel = ["0 mm", "1000 mm"]
[errors]
EXX = { std = "10 um", knots = 334 }
EYY = { std = "10 um", knots = 333 }
EZZ = { std = "10 um", knots = 333 }
"""


@dataclass(frozen=True)
class Measured:
    """What a path took.  seconds : of the processor; calls : of functions; megabytes : of memory at most"""

    path: str
    commit: str
    seconds: float
    calls: int
    megabytes: float


@dataclass(frozen=True)
class Road:
    """A main path.  target : seconds aimed at; arguments : of the command, made in a folder

    long : only with --long, and its calls are not counted; again : after the same command, which has written its plan
    """

    name: str
    target: str
    arguments: Callable[[Path], list[str]]
    long: bool = False
    again: bool = False


def demo_plan(readings: int, *more: str) -> Callable[[Path], list[str]]:
    """Return how a plan of the demo's campaign is asked for."""

    def arguments(folder: Path) -> list[str]:
        text = resources.files("axiscal.present.demo").joinpath("campaign.toml").read_text(encoding="utf-8")
        (folder / "demo.toml").write_text(text, encoding="utf-8")
        return ["plan", str(folder / "demo.toml"), "--readings", str(readings), *more]

    return arguments


def one_axis_plan(folder: Path) -> list[str]:
    """Return how 400 readings of one axis are planned."""
    (folder / "one.toml").write_text(AXIS, encoding="utf-8")
    return ["plan", str(folder / "one.toml"), "--readings", "400"]


def recorded(command: str, readings: int) -> Callable[[Path], list[str]]:
    """Return how a command looks at a record of so many readings of the demo's machine."""

    def arguments(folder: Path) -> list[str]:
        path = folder / f"{readings}.axiscal"
        if not path.exists():
            case = Case(description())
            with Campaign.create(path, case.description) as campaign:
                campaign.adopt(tuple(taken(case, readings)))
        return [command, str(path), *(["--out", str(folder / "results")] if command == "finish" else [])]

    return arguments


def typed(command: str, readings: int) -> Callable[[Path], list[str]]:
    """Return how the reading asked for after so many is typed by `record`, or the one after it is asked for."""

    def arguments(folder: Path) -> list[str]:
        path = Path(recorded(command, readings)(folder)[1])
        with Campaign.open(path) as campaign:
            asked, case = campaign.next(), campaign.case()
            assert isinstance(asked, Asked)
            setup, machine = campaign.description.setup(asked.place.setup), hidden_machine(case)
            shown = machine.read_all(setup, asked.place.pose, asked.place.approach, np.random.default_rng(readings))
            if command == "next":
                campaign.record(shown[0], others=tuple(shown[1:]))
                campaign.go_on()  # as the command does, once it has said what it has to
        return [command, str(path), *(f"{1e6 * value:.2f}um" for value in shown if command == "record")]

    return arguments


def taken(case: Case, count: int) -> Iterator[Reading]:
    """Yield readings of the demo's hidden machine at so many of its candidates, set-up by set-up."""
    machine, rng, setups = hidden_machine(case), np.random.default_rng(SEED), case.description.setups
    lattice = posed(case, case.knowledge, candidates=count).lattice
    columns = lattice.setups.tolist(), lattice.poses.tolist(), lattice.approaches.astype(int).tolist()
    for setup, pose, sides in list(zip(*columns, strict=True))[:count]:
        first, *others = machine.read_all(setups[setup], tuple(pose), tuple(sides), rng)
        yield Reading(setups[setup].name, tuple(pose), tuple(sides), first, others=tuple(others))


def estimated(count: int) -> Callable[[Path], list[str]]:
    """Return how so many readings of a mill of three axes are estimated, sizes and all."""

    def arguments(folder: Path) -> list[str]:
        mill = folder / "mill"
        mill.mkdir(exist_ok=True)
        described = bench_estimate.written(mill, "xyz", bare=False)
        bench_estimate.write_readings(mill / f"{count}.csv", described, count)
        return [
            "estimate",
            str(mill / "campaign.toml"),
            str(mill / f"{count}.csv"),
            "--out",
            str(mill / f"out-{count}"),
        ]

    return arguments


def dense(folder: Path) -> list[str]:
    """Return how 10,000 readings of 1,000 unknowns are estimated."""
    described_densely(folder)
    return ["estimate", str(folder / "dense.toml"), str(folder / "dense.csv"), "--out", str(folder / "dense-out")]


def dense_record(command: str) -> Callable[[Path], list[str]]:
    """Return how a command looks at a record of them."""

    def arguments(folder: Path) -> list[str]:
        path = folder / "dense.axiscal"
        if not path.exists():
            description = described_densely(folder)
            with Campaign.create(path, description) as campaign:
                campaign.adopt(placed_readings(read_any(folder / "dense.csv"), description, folder / "dense.csv"))
        return [command, str(path)]

    return arguments


def described_densely(folder: Path) -> CampaignDescription:
    """Write the campaign of 1,000 unknowns and 10,000 readings of it, and return its description."""
    (folder / "dense.machine.toml").write_text(DENSE, encoding="utf-8")
    head, setup = 'machine = "dense.machine.toml"\n[target]\nreadings = 1\n', bench_estimate.SETUP
    setup = setup.replace("400 mm", "1000 mm").replace("600 mm", "1000 mm")
    (folder / "dense.toml").write_text(head + "".join(setup.format(axis=axis) for axis in "xyz"), encoding="utf-8")
    read = read_campaign(folder / "dense.toml")
    bench_estimate.write_readings(folder / "dense.csv", read, 10_000)
    return read


ROADS = (
    Road("plan, demo, 60 readings", "5", demo_plan(60)),
    Road("plan, demo, 60 readings with bound", "8", demo_plan(60, "--json")),
    Road("plan, one axis, 400 readings", "3", one_axis_plan),
    Road("next, no reading, first time", "0.25", recorded("next", 0)),
    Road("next, no reading, again", "0.25", recorded("next", 0), again=True),
    Road("status, no reading", "0.25", recorded("status", 0)),
    Road("next, 60 readings, first time", "0.4", recorded("next", 60)),
    Road("record, after 60 readings", "0.5", typed("record", 60)),
    Road("next, after one typed", "0.5", typed("next", 60)),
    Road("status, 60 readings", "0.4", recorded("status", 60)),
    Road("status, 500 readings", "0.6", recorded("status", 500)),
    Road("finish, 60 readings", "1.5", recorded("finish", 60)),
    Road("finish, 500 readings", "3", recorded("finish", 500)),
    Road("status, 2,000 readings", "1", recorded("status", 2000), long=True),
    Road("finish, 2,000 readings", "8", recorded("finish", 2000), long=True),
    Road("estimate, three axes, learnt, 501", "5", estimated(501)),
    Road("estimate, three axes, learnt, 2,001", "12", estimated(2001), long=True),
    Road("estimate, 1,000 unknowns x 10,000", "30, 1 GB", dense, long=True),
    Road("status, 1,000 unknowns x 10,000", "2", dense_record("status"), long=True),
)


def measured(road: Road, checkout: Path) -> Measured:
    """Return what a path takes: one run for the processor's time, and another from the start that counts calls.

    checkout : whose sources are run
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        arguments = road.arguments(folder)
        if road.again:
            run([sys.executable, "-c", COMMAND, *arguments], checkout)
        used = run([sys.executable, "-c", COMMAND, *arguments], checkout)
        calls = 0 if road.long else counted(road, folder / "again", checkout)
    seconds, megabytes = used.ru_utime + used.ru_stime, used.ru_maxrss / 1024
    return Measured(road.name, commit_of(checkout), round(seconds, 2), calls, round(megabytes))


def counted(road: Road, folder: Path, checkout: Path) -> int:
    """Return how many functions a path calls."""
    folder.mkdir()
    arguments, calls = road.arguments(folder), folder / "calls"
    if road.again:
        run([sys.executable, "-c", COMMAND, *arguments], checkout)
    run([sys.executable, "-c", PROFILED, *arguments, str(calls)], checkout)
    return int(pstats.Stats(str(calls)).total_calls)  # type: ignore[attr-defined]


def run(command: list[str], checkout: Path) -> resource.struct_rusage:
    """Run a command of a checkout to its end, and return what it used; what it prints is not looked at."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    environment["PYTHONPATH"] = str(checkout / "src")
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment)
    _, status, used = os.wait4(process.pid, 0)
    if status:
        raise SystemExit(f"{' '.join(command[3:])} ended with status {os.waitstatus_to_exitcode(status)}")
    return used


def commit_of(checkout: Path) -> str:
    """Return the short name of the commit that is checked out, "" outside a repository."""
    asked = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True, cwd=checkout)
    return asked.stdout.strip()


def line(road: Road, now: Measured) -> str:
    """Return a row of the table."""
    calls = f"{now.calls / 1e6:7.2f} M {now.megabytes:6.0f} MB"
    return f"{road.name:38} {now.seconds:8.2f} s {calls}   (aim {road.target} s)"


def compared_with(now: Measured, before: Measured) -> str:
    """Return how much of the time, and of the calls, of another state a path takes."""
    ratio = f"{now.seconds / before.seconds:5.2f} of the time"
    if now.calls and before.calls:
        ratio += f", {now.calls / before.calls:5.2f} of the calls"
    return f"{ratio} at {before.commit}"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--only", default="", help="paths whose name begins so")
    parser.add_argument("--long", action="store_true", help="with those that take minutes")
    parser.add_argument("--beside", type=Path, help="folder of another checkout, by which each path is run as well")
    asked = parser.parse_args()
    for road in ROADS:
        if road.name.startswith(asked.only) and (asked.long or not road.long):
            found = measured(road, ROOT)
            print(line(road, found), flush=True)
            if asked.beside is not None:
                other = measured(road, asked.beside.resolve())
                print(f"{'':38} {other.seconds:8.2f} s   {compared_with(found, other)}, beside it", flush=True)


if __name__ == "__main__":
    main()
