"""Realtime components for a LinuxCNC that is kept apart: compiled by `halcompile`, and seen by this run alone.

LinuxCNC looks for modules in its own folder only. A copy of it, with the new module, is laid over it inside the
namespace of the run; nothing is installed.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from collections.abc import Mapping
from functools import cache
from pathlib import Path

from axiscal.exceptions import ControlError

MODULES = Path("/usr/lib/linuxcnc/modules")
"""By Debian's package: where LinuxCNC looks."""
_OWN = "modules"
_REMEDY = "Install the Debian packages linuxcnc-uspace-dev and gcc"


def can_compile() -> bool:
    """Return whether components can be compiled here."""
    return shutil.which("halcompile") is not None and shutil.which("gcc") is not None


def add_modules(work: Path, sources: Mapping[str, str], apart: bool) -> None:
    """Put LinuxCNC's modules and one of these sources into a run's folder; raises ControlError.

    apart : whether the run has namespaces of its own; if not, the component has to be installed
    """
    name = next(Path(name).stem for name in sources if name.endswith(".comp"))
    if not apart:
        if not (MODULES / f"{name}.so").exists():
            remedy = "sudo halcompile --install {name}.comp"
            raise ControlError("the component {name} is not installed here", remedy, name=name)
        return
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
