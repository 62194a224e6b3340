"""The entry of the page in the menu of a desktop."""

from __future__ import annotations

import os
import shutil
import sys
from importlib import resources
from pathlib import Path

from axiscal.document.durable import write_whole
from axiscal.exceptions import SourceError
from axiscal.language.spoken import said

_ENTRY = """\
[Desktop Entry]
Type=Application
Name=axiscal
Comment={comment}
Exec={program} serve --start --browser
Path={home}
Icon=axiscal
Terminal=true
Categories=Engineering;Science;
"""
"""As freedesktop.org's Desktop Entry Specification has it; the terminal ends the page, and shows its address."""


def install_desktop() -> Path:
    """Write the entry and its picture where menus look for those of a person, and return it; raises SourceError.

    The page then keeps new campaigns in the home folder.
    """
    if sys.platform != "linux":
        what, remedy = "This system has no menu as freedesktop.org describes it", "Give axiscal alone in a terminal"
        raise SourceError(what, remedy)
    data, home = Path(os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share"), Path.home()
    picture = resources.files("axiscal.web").joinpath("static", "icon.svg").read_bytes()
    program = shutil.which("axiscal") or str(Path(sys.argv[0]).absolute())
    text = _ENTRY.format(program=_quoted(program), home=home, comment=said("Calibration of machine tools"))
    files = {data / "applications" / "axiscal.desktop": text.encode()}
    files[data / "icons" / "hicolor" / "scalable" / "apps" / "axiscal.svg"] = picture
    for file, content in files.items():
        file.parent.mkdir(parents=True, exist_ok=True)
        write_whole(file, content)
    return next(iter(files))


def _quoted(program: str) -> str:
    """Return a program as the key Exec takes it."""
    plain = program.replace("%", "%%")
    escaped = "".join(f"\\{letter}" if letter in '"`$\\' else letter for letter in plain)
    return f'"{escaped}"'
