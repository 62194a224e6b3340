"""Where the controls come from: archives of their sources, unpacked and built once, and the Python that runs them."""

import fcntl
import hashlib
import os
import shutil
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path

ROOT = Path(__file__).parents[2]
HERE = Path(__file__).parent
PYTHON = ROOT / ".venv-controls" / "bin" / "python"


class MissingError(Exception):
    """Why a control is not here, in a sentence."""


def folder() -> Path:
    """Return where the archives lie."""
    return Path(os.environ.get("AXISCAL_CONTROLS", ROOT.parent / "shared" / "controls"))


def built(archive: str, own: Sequence[str], build: Callable[[Path], None]) -> Path:
    """Return the folder of an archive, unpacked and built under build/controls; made once, and anew after a change.

    own : files of this folder that the build needs
    Raises MissingError where the archive or a compiler is not there.
    """
    packed = folder() / archive
    if not packed.exists():
        raise MissingError(f"{packed} is not there")
    for tool in ("make", "gcc", "g++"):
        if shutil.which(tool) is None:
            raise MissingError(f"{tool} is not installed")
    seen = hashlib.sha256(packed.read_bytes() + b"".join((HERE / name).read_bytes() for name in own))
    made = ROOT / "build" / "controls" / f"{archive.partition('.')[0]}-{seen.hexdigest()[:12]}"
    made.parent.mkdir(parents=True, exist_ok=True)
    with made.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # tests beside each other ask for one control
        if not (made / "done").exists():
            shutil.rmtree(made, ignore_errors=True)
            made.mkdir()
            subprocess.run(["tar", "xJf", packed, "-C", made], check=True)
            for name in own:
                shutil.copy(HERE / name, made)
            build(made)
            (made / "done").touch()
    return made


def python() -> Path:
    """Return the Python that has what Klipper needs; raises MissingError."""
    if not PYTHON.exists():
        raise MissingError("the environment .venv-controls is not there: make .venv-controls/stamp")
    return PYTHON


def run(words: Sequence[str | Path], at: Path, seconds: float = 120.0) -> str:
    """Return what a command prints; raises AssertionError with all of it where it fails."""
    done = subprocess.run(words, cwd=at, capture_output=True, text=True, timeout=seconds, check=False)
    assert done.returncode == 0, f"{words}: {done.stdout[-2000:]}{done.stderr[-2000:]}"
    return done.stdout
