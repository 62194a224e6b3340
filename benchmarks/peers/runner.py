"""Every library in its own process, with a limit of time and of memory; what goes wrong becomes a sentence."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import IO, Any

import numpy as np

from benchmarks.peers.field import Rival
from benchmarks.peers.problems import Array, Posed

ROOT = Path(__file__).resolve().parents[2]
ENVIRONMENTS = ROOT / ".venv-peers"
_ONE_THREAD = dict.fromkeys(
    (
        "OPENBLAS_NUM_THREADS",
        "OMP_NUM_THREADS",
        "MKL_NUM_THREADS",
        "NUMBA_NUM_THREADS",
        "TF_NUM_INTRAOP_THREADS",
        "TF_NUM_INTEROP_THREADS",
    ),
    "1",
)
_LOOK = 0.2
_PATIENCE = 4.0
"""So many times the limit may pass on a busy computer."""
_LONGEST = 160


@dataclass(frozen=True, slots=True)
class Bounds:
    """What a library may take for one problem.  seconds : of the processor; memory : bytes"""

    seconds: float = 600.0
    memory: float = 8e9


@dataclass(frozen=True, slots=True)
class Outcome:
    """What a library made of a problem, or why it made nothing.

    positions : (m, q); processor, passed : seconds of each call; memory : bytes at most; sorry : a sentence
    """

    key: str
    letter: str
    criterion: str
    positions: list[list[float]] = field(default_factory=list)
    processor: list[float] = field(default_factory=list)
    passed: list[float] = field(default_factory=list)
    memory: float = 0.0
    versions: dict[str, str] = field(default_factory=dict)
    sorry: str = ""

    @property
    def places(self) -> Array:
        """The positions as an array."""
        return np.array(self.positions, dtype=np.float64)


def interpreter(rival: Rival) -> Path:
    """Return the Python of a library's environment."""
    return ENVIRONMENTS / rival.environment / "bin" / "python" if rival.environment else Path(sys.executable)


def run(rival: Rival, posed: Posed, bounds: Bounds) -> Outcome:
    """Return what a library makes of a problem within its limits."""
    python = interpreter(rival)
    key, letter, criterion = rival.key, posed.case.letter, posed.criterion
    if not python.exists():
        return Outcome(key, letter, criterion, sorry=f"not installed (no .venv-peers/{rival.environment})")
    with tempfile.TemporaryFile("w+") as said, tempfile.TemporaryFile("w+") as complained:
        sorry, code = _watched(
            [str(python), "-m", "benchmarks.peers.worker", key, letter, criterion], said, complained, bounds
        )
        said.seek(0)
        complained.seek(0)
        if sorry or code:
            return Outcome(key, letter, criterion, sorry=sorry or _reason(complained.read(), code))
        found: dict[str, Any] = json.loads(said.read().strip().splitlines()[-1])
    return Outcome(key, letter, criterion, **found)


def _watched(command: Sequence[str], said: IO[str], complained: IO[str], bounds: Bounds) -> tuple[str, int]:
    """Run a command to its end or to a limit; return why it was ended, and its exit code."""
    environment = {**os.environ, **_ONE_THREAD}
    process = subprocess.Popen(
        command, cwd=ROOT, env=environment, stdout=said, stderr=complained, start_new_session=True
    )
    try:
        sorry = _ended(process, bounds)
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
    return sorry, process.wait()


def _ended(process: subprocess.Popen[bytes], bounds: Bounds) -> str:
    """Wait for the end of a process, or for a limit that it reaches; return which."""
    began = time.monotonic()
    while process.poll() is None:
        time.sleep(_LOOK)
        if max(spent(process.pid), (time.monotonic() - began) / _PATIENCE) > bounds.seconds:
            return f"ended after {bounds.seconds:.0f} s"
        if resident(process.pid) > bounds.memory:
            return f"ended beyond {bounds.memory / 1e9:.3g} GB"
    return ""


def spent(pid: int) -> float:
    """Return the seconds of the processor that a process has taken; 0 where the system does not say."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
    except OSError:
        return 0.0
    return (float(fields[11]) + float(fields[12])) / os.sysconf("SC_CLK_TCK")


def resident(pid: int) -> float:
    """Return the bytes that a process holds in memory; 0 where the system does not say."""
    try:
        status = Path(f"/proc/{pid}/status").read_text(encoding="ascii")
    except OSError:
        return 0.0
    kilobytes = [line.split()[1] for line in status.splitlines() if line.startswith("VmRSS:")]
    return 1024.0 * float(kilobytes[0]) if kilobytes else 0.0


def _reason(complaint: str, code: int) -> str:
    lines = [line.strip() for line in complaint.splitlines() if line.strip()]
    last = lines[-1] if lines else f"ended with code {code}"
    if last.startswith("ModuleNotFoundError"):
        return f"not installed ({last.split(': ', 1)[-1]})"
    return f"failed: {last[:_LONGEST]}"


def kept(path: Path) -> dict[tuple[str, str, str], Outcome]:
    """Return the outcomes that a file keeps, one line of JSON each."""
    if not path.exists():
        return {}
    found = [Outcome(**json.loads(line)) for line in path.read_text(encoding="utf-8").splitlines() if line]
    return {(outcome.key, outcome.letter, outcome.criterion): outcome for outcome in found}


def keep(path: Path, outcome: Outcome) -> None:
    """Add an outcome to a file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("a", encoding="utf-8") as file:
        file.write(json.dumps(asdict(outcome)) + "\n")
