"""The file of the component: what is changed, cut or does not fit is refused; apply.sh and undo.sh ended anywhere."""

from __future__ import annotations

import re
import subprocess
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest

from axiscal.exceptions import TableError
from axiscal.ports.linuxcnc.configuring import scripts
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.registry import export
from axiscal.tables.vcomp_file import fnv1a, refuse_changed
from tests.tables.core_library import NEEDS_GCC, Core
from tests.tables.test_controllers import known


@pytest.fixture(scope="module")
def core(tmp_path_factory: pytest.TempPathFactory) -> Core:
    return Core(tmp_path_factory.mktemp("core"))


@lru_cache
def text(name: str = "dmu60") -> str:
    return export(known(name)[0], "linuxcnc-volumetric", ExportOptions(origin="0123456789abcdef99")).files[
        "axiscal.vcomp"
    ]


def signed(body: str) -> str:
    """A file whose checksum is right, whatever it holds."""
    kept = body.rpartition("end ")[0]
    return f"{kept}end {fnv1a(kept.encode()):08x}\n"


def changed(old: str, new: str, count: int = 1) -> str:
    assert old in text()
    return signed(text().replace(old, new, count))


def test_fnv1a_is_the_published_one() -> None:
    """Vectors of the hash's authors, 32 bits."""
    assert [fnv1a(each) for each in (b"", b"a", b"foobar")] == [0x811C9DC5, 0xE40C292C, 0xBF9CF968]


@NEEDS_GCC
def test_what_is_written_is_taken_by_the_component(core: Core) -> None:
    for name in ("dmu60", "small"):
        assert core.load(text(name).encode()) == (None, len(text(name).splitlines()))


@NEEDS_GCC
def test_no_changed_character_gets_through(core: Core) -> None:
    """1,500 characters anywhere, each changed to another, and every cut at a line and some between."""
    data, rng = text().encode(), np.random.default_rng(8)
    for at in rng.integers(0, len(data), 1500):
        other = bytes([data[at] ^ int(rng.integers(1, 128))])
        assert core.load(data[:at] + other + data[at + 1 :])[0] is not None, (at, other)
    for at in [*rng.integers(0, len(data), 150), 0, 1, len(data) - 1]:
        assert core.load(data[:at])[0] is not None
    assert core.load(data + b"\n")[0] is not None
    assert core.load(data.replace(b"\n", b"\r\n"))[0] is not None


def test_a_changed_file_is_refused_by_us_too() -> None:
    data = text("small")
    refuse_changed(data, "axiscal.vcomp")
    for broken in (data.replace("0", "1", 1), data[:-1], data[: len(data) // 2], data + "\n", ""):
        with pytest.raises(TableError, match="the checksum is wrong"):
            refuse_changed(broken, "axiscal.vcomp")


BROKEN = {
    "this is another form": ("axiscal-vcomp 1", "axiscal-vcomp 2"),
    "units": ("units mm", "units cm"),
    "two words": ("campaign 0123456789abcdef", "campaign 01 23"),
    "two axes": ("axes 5", "axes 2"),
    "ten axes": ("axes 5", "axes 10"),
    "a limit of nothing": ("limits 0.", "limits -0."),
    "not finite": ("tool 0 0 -", "tool 0 nan -"),
    "infinite": ("tool 0 0 -", "tool 0 1e999 -"),
    "hexadecimal": ("tool 0 0 -", "tool 0 0x1p3 -"),
    "too few numbers": ("tool 0 0 -", "tool 0 -"),
    "too many numbers": ("tool 0 0 -", "tool 0 0 0 -"),
    "two blanks": ("tool 0 0 -", "tool 0  0 -"),
    "no such axis": ("axis C z", "axis CC z"),
    "a small letter": ("axis C z", "axis c z"),
    "no such direction": ("axis C z", "axis C w"),
    "no side": ("side -1", "side 0"),
    "half a sense": ("sense 1", "sense 0.5"),
    "a joint twice": ("joints 4 -1", "joints 3 -1"),
    "joint 9": ("joints 4 -1", "joints 9 -1"),
    "four linear axes": ("axis C z rotary 1", "axis C z rotary 0"),
    "a tilted rotary axis": ("travel-tilt 0 0 0", "travel-tilt 0 1 0"),
    "knots": ("knot 30\n", "knot 60\n"),
    "one knot more": ("knots 13", "knots 14"),
    "too many knots": ("knots 13", "knots 97"),
    "one knot": ("knots 13", "knots 1"),
    "an endless reversal": ("reversal 1 0.", "reversal 1 90."),
    "no turn": ("knot 360\n", "knot 300.5\n" + 6 * "0 0 0 0\n" + "knot 350\n"),
}


@NEEDS_GCC
@pytest.mark.parametrize("what", BROKEN)
def test_the_component_refuses_nonsense_with_a_good_checksum(core: Core, what: str) -> None:
    why, line = core.load(changed(*BROKEN[what]).encode())
    assert why is not None
    assert line > 0


@NEEDS_GCC
def test_an_axis_may_have_two_joints_and_joints_that_the_chain_does_not_have_are_passed_over(core: Core) -> None:
    options = ExportOptions(numbers={"X": (7,), "Y": (1, 2), "Z": (3,)})
    made = export(known("small")[0], "linuxcnc-volumetric", options)
    assert core.load(made.files["axiscal.vcomp"].encode())[0] is None
    assert re.findall(r" joints (.*)$", made.files["axiscal.vcomp"], re.MULTILINE) == ["7 -1", "1 2", "3 -1"]
    assert all(f"axiscal-vcomp.drive-{n}\n" in made.files["axiscal-volumetric.hal"] for n in (1, 2, 3, 7))


BEFORE = {"mill.ini": "[HAL]\nHALFILE = mill.hal\n", "mill.hal": "loadrt trivkins\n", "it's mine.hal": "# nothing\n"}
AFTER = {**BEFORE, "mill.ini": "[HAL]\nHALFILE = axiscal-load.hal\n", "it's mine.hal": "# something\n"}
ADDED = {"axiscal-load.hal": "loadrt axiscal_vcomp\n", "axiscal.vcomp": "axiscal-vcomp 1\n"}


@pytest.fixture
def folders(tmp_path: Path) -> tuple[Path, Path]:
    """Return the owner's folder and that of the export."""
    theirs, ours = tmp_path / "theirs", tmp_path / "ours"
    for folder, files in ((theirs, BEFORE), (ours, AFTER | ADDED)):
        folder.mkdir()
        for name, text in files.items():
            (folder / name).write_text(text)
    after = AFTER | {"axiscal-load.hal": ADDED["axiscal-load.hal"]}
    for name, text in scripts(BEFORE, after, ["axiscal.vcomp"]).items():
        (ours / name).write_text(text)
    return theirs, ours


def given(script: Path, folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(["sh", script, folder], capture_output=True, text=True, check=False)


def ended_after(script: Path, lines: int) -> Path:
    """Return a script that is killed after so many lines."""
    cut = script.with_name(f"cut-{script.name}")
    cut.write_text("\n".join([*script.read_text().splitlines()[:lines], "kill -9 $$", ""]))
    return cut


def files(folder: Path) -> dict[str, str]:
    return {path.name: path.read_text() for path in folder.iterdir() if path.is_file() and path.suffix != ".part"}


def begun(script: Path) -> int:
    """Return the line from which a script changes something."""
    lines = script.read_text().splitlines()
    return max(number for number, line in enumerate(lines) if "sha256sum" in line) + 1


def test_wherever_apply_is_ended_undo_puts_back_what_was_there(folders: tuple[Path, Path]) -> None:
    theirs, ours = folders
    apply, undo = ours / "apply.sh", ours / "undo.sh"
    for lines in range(begun(apply), len(apply.read_text().splitlines())):
        assert given(ended_after(apply, lines), theirs).returncode == -9
        undone = given(undo, theirs)
        assert undone.returncode == 0 or "There is no backup" in undone.stderr
        assert not [path.name for path in theirs.glob("*.part") if path.is_file()], lines
        assert files(theirs) == BEFORE, lines
    assert given(apply, theirs).returncode == 0
    assert files(theirs) == AFTER | ADDED
    for lines in range(begun(undo), len(undo.read_text().splitlines())):
        assert given(ended_after(undo, lines), theirs).returncode == -9
        again = given(undo, theirs)
        assert again.returncode == 0 or "There is no backup" in again.stderr
        assert files(theirs) == BEFORE, lines
        assert given(apply, theirs).returncode == 0
    assert given(undo, theirs).returncode == 0
    assert {path.name for path in theirs.iterdir()} == set(BEFORE)


def test_a_file_that_somebody_changed_is_left_alone(folders: tuple[Path, Path]) -> None:
    theirs, ours = folders
    (theirs / "mill.hal").write_text("# not looked at: nothing of it changes\n")
    (theirs / "mill.ini").write_text("[HAL]\n")
    before = files(theirs)
    assert "not the one that was read" in given(ours / "apply.sh", theirs).stderr
    assert files(theirs) == before
    (theirs / "mill.ini").write_text(BEFORE["mill.ini"])
    assert given(ours / "apply.sh", theirs).returncode == 0
    assert "There is a backup already" in given(ours / "apply.sh", theirs).stderr
    (theirs / "it's mine.hal").write_text("# mine\n")
    assert "not the one that was read" in given(ours / "undo.sh", theirs).stderr
    assert (theirs / "it's mine.hal").read_text() == "# mine\n"
