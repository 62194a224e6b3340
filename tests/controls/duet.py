"""RepRapFirmware's own height map, compiled, behind its axis transform and its backlash, which are formulas here.

`Move::AxisTransform` adds tanXY y + tanXZ z to x and tanYZ z to y, before the map; `M556` sets the tangents.
`Move::ApplyBacklashCompensation` takes the whole of `M425` off once an axis moves backwards.
"""

import re
import subprocess
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from axiscal.numerics import Array
from axiscal.units import from_unit, to_unit
from tests.controls.fetched import built, run

VERSION = "fc1cd16c"
_ARCHIVE, _MAIN = "reprapfirmware-bedprobing.tar.xz", "duet_grid.cpp"
_AROUND = ["RepRapFirmware.h", "ObjectModel/ObjectModel.h", "Platform/Platform.h", "Platform/RepRap.h"]
_AROUND += ["GCodes/GCodes.h", "Storage/FileStore.h", "Math/Deviation.h"]
"""Headers that it includes, which are empty here."""


def _build(folder: Path) -> None:
    for name in _AROUND:
        (folder / "around" / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / "around" / name).touch()
    words = ["-I", "around", "-I", "src/Movement/BedProbing", _MAIN, "-o", "grid"]
    run(["g++", "-std=c++17", "-O1", "-w", *words], folder)


def heights(text: str, places: Array) -> Array:
    """Return what a map adds to Z at places (m, 2), mm; raises AssertionError where the firmware refuses it."""
    program = built(_ARCHIVE, [_MAIN], _build) / "grid"
    with TemporaryDirectory() as folder:
        (at := Path(folder) / "heightmap.csv").write_text(text)
        asked = "".join("{:.7f} {:.7f}\n".format(*place) for place in places)
        done = subprocess.run([program, at], input=asked, capture_output=True, text=True, timeout=20, check=False)
    assert done.returncode == 0, done.stdout
    return np.array(done.stdout.split(), dtype=float)


def added(files: Mapping[str, str], poses: Array, ways: Array) -> Array:
    """Return what the firmware adds to X, Y, Z, (m, 3) m.  poses : (m, 3) m; ways : (m, 3), -1 for backwards"""
    at = np.asarray(to_unit(poses, "mm")).copy()
    moved, code = at.copy(), files.get("axiscal.g", "")
    lean = words_of(code, "M556")
    xy, yz, xz = (lean.get(letter, 0.0) / lean.get("S", 1.0) for letter in "XYZ")
    moved[:, 0] += xy * at[:, 1] + xz * at[:, 2]
    moved[:, 1] += yz * at[:, 2]
    if "heightmap.csv" in files:
        moved[:, 2] += heights(files["heightmap.csv"], moved[:, :2])
    for k, axis in enumerate("XYZ"):
        moved[:, k] -= words_of(code, "M425").get(axis, 0.0) * (ways[:, k] < 0)
    return np.asarray(from_unit(moved - at, "mm"))


def words_of(code: str, command: str) -> dict[str, float]:
    """Return the numbers of a command by their letters."""
    (found,) = re.findall(rf"^{command} (.*)$", code, re.MULTILINE) or [""]
    return {word[0]: float(word[1:]) for word in found.split()}
