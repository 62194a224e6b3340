"""Debian's LinuxCNC as processes of a run, apart from everything else on the machine, and modules that it alone sees.

LinuxCNC is one per machine: fixed shared-memory keys, one port, and a stop script that ends others by name.  So it gets
its own namespaces, and does not start where the kernel allows none.

LinuxCNC looks for modules in its own folder only. A copy of it, with a new module compiled by `halcompile`, is laid
over it inside the namespace of the run; nothing is installed.
"""

import os
import shutil
import signal
import subprocess
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path

from axiscal.exceptions import InputError


class ControlError(InputError):
    """LinuxCNC cannot be started, or refuses what it is asked to do."""


SPACES = ("unshare", "--ipc", "--net", "--pid", "--mount", "--fork", "--kill-child", "--mount-proc")
OWN_TMP = "mount -t tmpfs -o mode=1777 none /tmp"
_START_IT = "exec linuxcnc -r machine.ini"
NOBODY = 65534
"""The user `nobody` of Debian."""
BASE = Path("/var/tmp")  # not /tmp, which the run gets anew


@cache
def available() -> bool:
    """Return whether LinuxCNC is installed here, and gets namespaces of its own."""
    trial = [*SPACES, "sh", "-c", "mount -t tmpfs none /tmp"]
    return (
        shutil.which("linuxcnc") is not None and not subprocess.run(trial, capture_output=True, check=False).returncode
    )


def can_compile() -> bool:
    """Return whether realtime components can be compiled and tried here."""
    return available() and shutil.which("halcompile") is not None and shutil.which("gcc") is not None


def fill(work: Path, texts: Mapping[str, str]) -> None:
    work.chmod(0o755)
    for name, text in texts.items():
        (work / name).write_text(text, encoding="utf-8", newline="")
    (work / "driver.py").chmod(0o755)
    (work / "rt").mkdir()
    if os.geteuid() == 0:
        os.chown(work / "rt", NOBODY, NOBODY)


@contextmanager
def started(work: Path) -> Iterator[subprocess.Popen[bytes]]:
    """Yield the running LinuxCNC, and end it."""
    with (work / "log.txt").open("wb") as log:
        process = subprocess.Popen(
            [*SPACES, "sh", "-c", " && ".join([OWN_TMP, *mounted(work), _START_IT])],
            cwd=work,
            env=_environment(work),
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=log,
            start_new_session=True,
        )
        try:
            yield process
        finally:
            _ask_to_end(work, process)
            _end(process)


def _ask_to_end(work: Path, process: subprocess.Popen[bytes]) -> None:
    """Let LinuxCNC stop in order, which it does when its DISPLAY program, whose socket is closed, has ended."""
    with suppress(subprocess.TimeoutExpired):
        process.wait(1)
        return
    for entry in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            if (entry / "cwd").readlink() == work and b"driver.py" in (entry / "cmdline").read_bytes():
                os.kill(int(entry.name), signal.SIGKILL)
    with suppress(subprocess.TimeoutExpired):
        process.wait(10)


def _end(process: subprocess.Popen[bytes]) -> None:
    """End the processes of the run by its own session, none by name."""
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def _environment(work: Path) -> dict[str, str]:
    """The environment without a display and without our own Python's paths."""
    dropped = {"DISPLAY", "PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV"}
    kept = {name: value for name, value in os.environ.items() if name not in dropped}
    own = {"HOME": str(work), "PATH": "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"}
    root = {"RTAPI_UID": str(NOBODY), "RTAPI_FIFO_PATH": str(work / "rt" / "f")} if os.geteuid() == 0 else {}
    return kept | own | root


def log_of(work: Path) -> str:
    return "\n".join((work / "log.txt").read_text(errors="replace").splitlines()[-30:])


MODULES = Path("/usr/lib/linuxcnc/modules")
"""By Debian's package: where LinuxCNC looks."""
_OWN = "modules"
_REMEDY = "Install the Debian packages linuxcnc-uspace-dev and gcc"


def add_modules(work: Path, sources: Mapping[str, str]) -> None:
    """Put LinuxCNC's modules and one of these sources into a run's folder; raises ControlError."""
    name = next(Path(name).stem for name in sources if name.endswith(".comp"))
    shutil.copytree(MODULES, work / _OWN)
    (work / _OWN / f"{name}.so").write_bytes(compiled(*(part for pair in sorted(sources.items()) for part in pair)))
    (work / _OWN / f"{name}.so").chmod(0o644)


def mounted(work: Path) -> list[str]:
    """Return the shell commands that show the run its own modules, none where it has none."""
    return [f"mount --bind {work / _OWN} {MODULES}"] if (work / _OWN).exists() else []


@cache
def compiled(*names_and_texts: str) -> bytes:
    """Return the module of a component; name, text, name, text of its source and of what it includes.

    Raises ControlError.
    """
    if not can_compile():
        raise ControlError("realtime components cannot be compiled here", _REMEDY)
    with tempfile.TemporaryDirectory() as folder:
        for name, text in zip(names_and_texts[::2], names_and_texts[1::2], strict=True):
            Path(folder, name).write_text(text, encoding="ascii")
        source = next(name for name in names_and_texts[::2] if name.endswith(".comp"))
        kept = {key: value for key, value in os.environ.items() if key not in {"PYTHONPATH", "PYTHONHOME"}}
        words = ["halcompile", "--compile", source]
        run = subprocess.run(words, cwd=folder, env=kept, capture_output=True, text=True, check=False)
        made = Path(folder, source).with_suffix(".so")
        if run.returncode or not made.exists():
            what = "halcompile refused {source}:\n{output}"
            raise ControlError(what, _REMEDY, source=source, output=run.stderr[-2000:])
        return made.read_bytes()
