"""Runs Debian's LinuxCNC headless, apart from everything else on the machine, for one job of moves.

LinuxCNC is one per machine: fixed shared-memory keys, one port, and a stop script that ends others by name.  So it gets
namespaces of its own where the kernel allows them; elsewhere one run waits for the other and none starts beside a
LinuxCNC that is already there.
"""

from __future__ import annotations

import fcntl
import json
import os
import shutil
import signal
import subprocess
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from tests.linuxcnc.configuration import Joint, files

_DRIVER = Path(__file__).with_name("driver.py")
_SPACES = ("unshare", "--ipc", "--net", "--pid", "--mount", "--fork", "--kill-child", "--mount-proc")
_OWN_TMP = "mount -t tmpfs -o mode=1777 none /tmp && exec linuxcnc -r machine.ini"
_NOBODY = 65534
_BASE = Path("/var/tmp")  # not /tmp, which the run gets anew


class LinuxcncError(Exception):
    """LinuxCNC did not start, did not finish, or failed at the job."""


@dataclass(frozen=True, slots=True)
class Step:
    """What a move ended with, one number for each joint in mm or deg; settled: the correction had arrived."""

    motor: tuple[float, ...]
    command: tuple[float, ...]
    settled: bool


@dataclass(frozen=True, slots=True)
class Run:
    """A whole job: motor commands after homing, each move's end, and what the operator was told."""

    start: tuple[float, ...]
    steps: tuple[Step, ...]
    errors: tuple[str, ...]


def run(joints: Sequence[Joint], moves: Sequence[str], servo_period: float = 1e-3, timeout: float = 60) -> Run:
    """Start LinuxCNC, make the moves (G-code lines), stop it; raises LinuxcncError."""
    work = Path(tempfile.mkdtemp(prefix="axiscal-linuxcnc-", dir=_BASE))
    try:
        _fill(work, joints, moves, servo_period)
        _execute(work, timeout)
        return _result(work)
    finally:
        shutil.rmtree(work, ignore_errors=True)


def _fill(work: Path, joints: Sequence[Joint], moves: Sequence[str], servo_period: float) -> None:
    work.chmod(0o755)
    for name, text in files(joints, servo_period).items():
        (work / name).write_text(text, encoding="utf-8", newline="")
    (work / "job.json").write_text(json.dumps({"joints": len(joints), "moves": list(moves)}))
    shutil.copy(_DRIVER, work / "driver.py")
    (work / "driver.py").chmod(0o755)
    (work / "rt").mkdir()
    if os.geteuid() == 0:
        os.chown(work / "rt", _NOBODY, _NOBODY)


def _execute(work: Path, timeout: float) -> None:
    with _apart() as command, (work / "log.txt").open("wb") as log:
        process = subprocess.Popen(
            command,
            cwd=work,
            env=_environment(work),
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=log,
            start_new_session=True,
        )
        try:
            process.wait(timeout)
        except subprocess.TimeoutExpired:
            _ask_to_end(work, process)
            raise LinuxcncError(f"LinuxCNC did not finish in {timeout:g} s:\n{_log(work)}") from None
        finally:
            _end(process)


def _ask_to_end(work: Path, process: subprocess.Popen[bytes]) -> None:
    """End the DISPLAY program, whose end makes LinuxCNC stop in order; milder signals it heeds only after a move."""
    for entry in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            if (entry / "cwd").readlink() == work and b"driver.py" in (entry / "cmdline").read_bytes():
                os.kill(int(entry.name), signal.SIGKILL)
    with suppress(subprocess.TimeoutExpired):
        process.wait(10)


def _end(process: subprocess.Popen[bytes]) -> None:
    """End what is left of the run: its own session, nothing by name."""
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


@contextmanager
def _apart() -> Iterator[Sequence[str]]:
    """Yield the command that starts LinuxCNC without meeting another one."""
    if _spaces_allowed():
        yield (*_SPACES, "sh", "-c", _OWN_TMP)
        return
    with (_BASE / f"axiscal-linuxcnc-{os.geteuid()}.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        _wait_for_others(60)
        yield ("linuxcnc", "-r", "machine.ini")


def _spaces_allowed() -> bool:
    trial = subprocess.run([*_SPACES, "sh", "-c", "mount -t tmpfs none /tmp"], capture_output=True, check=False)
    return trial.returncode == 0


def _wait_for_others(seconds: float) -> None:
    end = time.monotonic() + seconds
    while others := _running():
        if time.monotonic() > end:
            raise LinuxcncError(f"a LinuxCNC runs on this machine ({others}) and cannot be kept apart: stop it first")
        time.sleep(0.2)


def _running() -> str:
    """Name the processes of a LinuxCNC that are alive, not those that only wait to be buried."""
    names = set()
    for entry in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            name, _, state = entry.read_text().partition("(")[2].rpartition(")")
            names |= {name} if state.split()[0] not in "ZX" else set()
    return ", ".join(sorted(names & {"milltask", "linuxcncsvr", "rtapi_app"}))


def _environment(work: Path) -> dict[str, str]:
    """The environment without a display and without our own Python's paths."""
    dropped = {"DISPLAY", "PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV"}
    kept = {name: value for name, value in os.environ.items() if name not in dropped}
    own = {"HOME": str(work), "PATH": "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"}
    root = {"RTAPI_UID": str(_NOBODY), "RTAPI_FIFO_PATH": str(work / "rt" / "f")} if os.geteuid() == 0 else {}
    return kept | own | root


def _result(work: Path) -> Run:
    try:
        result = json.loads((work / "result.json").read_text())
    except FileNotFoundError:
        raise LinuxcncError(f"LinuxCNC ended without a result:\n{_log(work)}") from None
    if result["failure"]:
        raise LinuxcncError(f"{result['failure']}\n{_log(work)}")
    steps = tuple(Step(tuple(s["motor"]), tuple(s["command"]), s["settled"]) for s in result["steps"])
    return Run(tuple(result["start"]), steps, tuple(result["errors"]))


def _log(work: Path) -> str:
    return "\n".join((work / "log.txt").read_text(errors="replace").splitlines()[-30:])
