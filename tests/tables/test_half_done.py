"""apply.sh and undo.sh of the component, ended anywhere: undo.sh puts back what was there."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from axiscal.ports.linuxcnc.patching import Configuration, scripts

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
    found = Configuration("mill.ini", AFTER | {"axiscal-load.hal": ADDED["axiscal-load.hal"]})
    for name, text in scripts(BEFORE, found, ["axiscal.vcomp"]).items():
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
