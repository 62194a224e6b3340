"""Every plan, every next reading and every program of the examples, as printed: own kinematics look at each.

The command runs in a process of its own; what it prints is held to the text of campaign and machine alone.
"""

from __future__ import annotations

import json
import math
import re
import shlex
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from axiscal.description.campaign import CampaignDescription, read_campaign
from axiscal.exceptions import InputError, ProgramError
from axiscal.measurement.reading import Place
from axiscal.programs import controllers, dialect, programs
from tests.certify import silent_instrument
from tests.certify.kept import Kept
from tests.generators.printed_machine import PrintedMachine, printed_machine
from tests.generators.said_places import Said
from tests.generators.ways_said import WaysSaid

ROOT = Path(__file__).resolve().parents[2]
_LONGEST = 900
"""s of processor time, for one command: it ends the trial, not the plan."""
_BY_HAND = 3
"""Readings that are asked for one at a time and recorded, after each of which the rest of the plan is renewed."""


def campaigns(folder: Path) -> list[Path]:
    """Return the campaigns of examples, demo and tests, and those that pages print, written into a folder."""
    found = [
        path
        for part in ("src/axiscal/present/demo", "examples", "tests/linuxcnc/machines", "tests/golden/campaigns")
        for path in sorted((ROOT / part).rglob("*.toml"))
        if "[[setups]]" in path.read_text(encoding="utf-8") and path.parent.name != "refusals"
    ]
    for page in [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]:
        for number, text in enumerate(re.findall(r"```toml\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)):
            if re.search(r'^machine = "(?!.*\.toml)', text, re.MULTILINE) and "[[setups]]" in text:
                path = folder / f"{page.stem}-{number}.toml"
                path.write_text(text, encoding="utf-8")
                found.append(path)
    return found


def verdicts(most: int, first: int, kept: Kept) -> Iterator[tuple[str, bool]]:
    """Yield of each campaign how many readings and ways were looked at, and whether all of them can be.

    kept : what an earlier run has found, which goes on here
    """
    with tempfile.TemporaryDirectory() as folder:
        for path in campaigns(Path(folder))[first : first + most]:
            name = str(path.relative_to(ROOT)) if path.is_relative_to(ROOT) else path.name
            said, good = kept.get(name, partial(_verdict, path, Path(folder)))
            yield f"{name}: {said}", good


def _verdict(path: Path, folder: Path) -> tuple[str, bool]:
    try:
        return _looked_at(path, folder), True
    except AssertionError as failure:
        return str(failure)[:300] or "a reading or a way that cannot be", False


def _looked_at(path: Path, folder: Path) -> str:
    try:
        description = read_campaign(path, target_needed=False, asking=False)
    except InputError as refused:  # such as one that goes on from a record which its own scenario makes first
        return f"refused: {refused}"[:200]
    machine, text = printed_machine(description.machine.text), path.read_text(encoding="utf-8")
    said = Said(text, machine)
    target = [] if "[target]" in text else ["--readings", "12"]
    plan, sentence = _printed(["plan", str(path), "--json", *target])
    if plan is None:
        return f"refused: {sentence}"
    planned = [_place(machine, point) for point in plan["points"]]
    for place in planned:
        said.holds(place)
    ways = sum(_ways(description, said, planned, controller) for controller in controllers())
    asked = _asked(path, folder, machine) if not target else []
    by_hand = _by_hand(path, folder, machine) if not target else []
    for place in (*asked, *by_hand):
        said.holds(place)
    return (
        f"{len(planned)} readings planned, {len(asked)} asked for in a closed loop, {len(by_hand)} by hand, "
        f"{ways} ways in programs"
    )


def _printed(words: list[str]) -> tuple[Any, str]:
    """Return the document that a command prints, or None with what it says."""
    limit = f"ulimit -t {_LONGEST}; exec "
    command = ["sh", "-c", limit + shlex.join([sys.executable, "-m", "axiscal.cli", *words])]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    said = " ".join(done.stderr.split())
    assert done.returncode not in (-signal.SIGKILL, -signal.SIGXCPU), f"{words[0]} took {_LONGEST} s of processor time"
    assert done.returncode in (0, 1), said
    assert "Traceback" not in said, said
    return (json.loads(done.stdout), said) if done.stdout.strip() else (None, said[-160:])


def _place(machine: PrintedMachine, point: dict[str, Any]) -> Place:
    at, come = point["position"], point.get("approach") or {}
    pose = [math.radians(at[axis.name]) if axis.rotary else 1e-3 * at[axis.name] for axis in machine.axes]
    sides = [{"+": 1, "-": -1}.get(come.get(axis.name, ""), 0) for axis in machine.axes]
    return Place(point["setup"], tuple(pose), tuple(sides))


def _asked(path: Path, folder: Path, machine: PrintedMachine) -> list[Place]:
    """Return where readings are asked for in a whole campaign, renewed plans too, by what an instrument is told."""
    log = folder / "asked.jsonl"
    log.unlink(missing_ok=True)
    source = f"exec:{sys.executable} {Path(silent_instrument.__file__)} {log}"
    with tempfile.TemporaryDirectory() as out:
        _printed(["run", str(path), "--source", source, "--out", f"{out}/out", "--json"])
    lines = log.read_text(encoding="utf-8").splitlines() if log.is_file() else []
    return [_place(machine, json.loads(line)) for line in lines]


def _by_hand(path: Path, folder: Path, machine: PrintedMachine) -> list[Place]:
    """Return what `next` asks for, one reading recorded after another, and the rest of the plan renewed after each."""
    record, asked = str(folder / "by-hand.axiscal"), []
    Path(record).unlink(missing_ok=True)
    begun, _ = _printed(["start", str(path), record, "--json"])
    for _ in range(_BY_HAND if begun is not None else 0):
        question = _printed(["next", record, "--json"])[0]["question"]
        if question is None:
            break
        asked.append(_place(machine, question))
        unit = "urad" if question["instrument"] in ("level", "autocollimator") else "um"
        zeros = ", ".join([f"0 {unit}"] * (3 if question["instrument"] in silent_instrument.THREE else 1))
        _printed(["record", record, zeros, "--json"])
    return asked


def _ways(description: CampaignDescription, said: Said, places: list[Place], controller: str) -> int:
    try:
        made = programs(description.machine, description.setups, places, dialect(controller))
    except (ProgramError, InputError):
        return 0  # a control that has no name for an axis, or no kinematics for the chain, says so
    ways = 0
    for program in made:
        setup = program.readings[0].setup.name
        mine = {k: np.array(place.pose) for k, place in enumerate(places, start=1) if place.setup == setup}
        ways += WaysSaid(said, setup, controller).holds(program.text, mine)
    return ways
