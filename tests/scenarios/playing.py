"""A campaign played in a folder of its own, each command in a process of its own."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from tests.scenarios.gathering import gathered
from tests.scenarios.scenario import Command, Scenario

PATIENCE = 600


@dataclass(frozen=True, slots=True)
class Said:
    """What a command answered: its exit status and both streams."""

    command: Command
    status: int
    out: str
    err: str

    @property
    def as_expected(self) -> bool:
        """Whether it was done or refused as the campaign's page says."""
        return (self.status != 0) == self.command.refused


@dataclass(frozen=True, slots=True)
class Outcome:
    """What people see of a campaign: the answers in turn, and the files that were written, by name."""

    scenario: Scenario
    said: tuple[Said, ...]
    files: Mapping[str, str]


def environment(sources: str) -> dict[str, str]:
    """Return the environment of a command: one width of the page, and the sources to run.

    sources : as PYTHONPATH, from the present folder; empty: the package that is installed
    """
    fixed = {"COLUMNS": "120", "NO_COLOR": "1", "TERM": "dumb", "TZ": "UTC"}
    fixed["AXISCAL_PROGRESS"] = "off"  # on a slow computer more stages would be said than on a fast one
    fixed["PYTHONDONTWRITEBYTECODE"] = ""  # compiled once, not with every command
    folders = [str(Path(folder).resolve()) for folder in sources.split(os.pathsep) if folder]
    tools = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", os.defpath)])
    return {**os.environ, **fixed, "PYTHONPATH": os.pathsep.join(folders), "PATH": tools}


def played(
    scenario: Scenario, sources: str, elsewhere: Mapping[str, str] | None = None, python: str = sys.executable
) -> Outcome:
    """Return what the campaign gives with these sources, see `environment`.

    elsewhere : variables that are not as usual;  python : the interpreter, with everything that the package needs
    """
    env = environment(sources) | dict(elsewhere or {})
    with tempfile.TemporaryDirectory() as parent:
        folder = Path(parent, scenario.name)
        shutil.copytree(scenario.folder, folder)
        said = tuple(_answer(command, folder, env, python) for command in scenario.commands)
        return Outcome(scenario, said, gathered(folder, scenario))


def _answer(command: Command, folder: Path, env: Mapping[str, str], python: str) -> Said:
    run = subprocess.run(
        [python, "-m", "axiscal.cli", *command.words],
        cwd=folder,
        env=env,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        encoding="utf-8",
        timeout=PATIENCE,
        check=False,
    )
    return Said(command, run.returncode, run.stdout, run.stderr)
