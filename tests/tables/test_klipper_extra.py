"""The extra of Klipper by itself: it adds what our reader says, and refuses files that are not whole or not of it."""

from __future__ import annotations

import os
import subprocess
import sys
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from axiscal.ports.printers.klipper_extra import Correction
from axiscal.tables.offer import Export
from axiscal.tables.vcomp_applying import fnv1a
from tests.controls.known import BED, OWN, PLANE, SQUARE, STRAIGHT, TURNS, Known, known


@pytest.fixture(scope="module")
def printer() -> Known:
    return known(OWN, STRAIGHT, SQUARE, TURNS, BED, PLANE)


@pytest.fixture(scope="module")
def export(printer: Known) -> Export:
    return printer.exported("klipper-volumetric")


def test_the_extra_adds_what_the_reader_says_also_beyond_the_travel(printer: Known, export: Export) -> None:
    extra, machine = Correction(export.files["axiscal.vcomp"]), printer.estimate.machine
    low, high = np.array(printer.estimate.box).T
    poses = np.random.default_rng(2).uniform(low - 8e-3, high + 8e-3, (60, 3))
    order = [machine.index(name) for name in "XYZ"]
    found = [extra.at([float(at) for at in place]) for place in 1e3 * poses[:, order]]
    said = 1e3 * export.control(poses, np.ones_like(poses))[:, order]
    assert np.max(np.abs(np.array(found) - said)) < 1e-9
    assert np.max(np.abs(said)) > 0.05
    assert export.effect.after < 1e-6 < 60e-6 < export.effect.before


def test_a_piece_of_a_move_takes_few_calls(export: Export) -> None:
    """Calls are most of the time that Python takes; without the tables made at load there were four times as many."""
    extra, calls = Correction(export.files["axiscal.vcomp"]), Counter[str]()
    sys.setprofile(lambda frame, event, what: calls.update([event]))
    try:
        extra.at([100.0, 80.0, 5.0])
    finally:
        sys.setprofile(None)
    assert calls["call"] <= 12
    assert calls["c_call"] <= 37


@pytest.mark.parametrize(
    ("wrong", "why"),
    [
        (lambda t: t.replace("e-05", "e-04", 1), "the checksum is wrong"),
        (lambda t: t[: len(t) // 2], "the checksum is wrong"),
        (lambda t: _summed(t.replace("units mm", "units inch")), "counts in mm"),
        (lambda t: _summed(t.replace("axis X", "axis U")), "none of a printer"),
        (lambda t: _summed(t.partition("bed ")[0]), "a line bed is expected"),
    ],
)
def test_a_file_that_is_not_whole_or_of_another_machine_is_refused(export: Export, wrong: object, why: str) -> None:
    with pytest.raises(ValueError, match=why):
        Correction(wrong(export.files["axiscal.vcomp"]))  # type: ignore[operator]


def _summed(text: str) -> str:
    """Return a text with the checksum that is right for it."""
    body = text.rpartition("end ")[0] or text
    return f"{body}end {fnv1a(body.encode()):08x}\n"


def test_one_line_installs_it_and_does_so_once(export: Export, tmp_path: Path) -> None:
    home, here, programs = (tmp_path / name for name in ("home", "here", "programs"))
    for folder in (home / "klipper/klippy/extras", home / "printer_data/config", here, programs):
        folder.mkdir(parents=True)
    for name in ("axiscal.py", "axiscal.vcomp"):
        (here / name).write_text(export.files[name])
    config = home / "printer_data/config/printer.cfg"
    config.write_text("[mcu]\nserial: /dev/ttyACM0\n")
    (programs / "sudo").write_text('#!/bin/sh\necho "$@"\n')
    (programs / "sudo").chmod(0o755)
    line = export.readme.partition("these files: ")[2].splitlines()[0]
    env = {"HOME": str(home), "PATH": f"{programs}:{os.environ['PATH']}"}
    for _ in range(2):
        done = subprocess.run(line, shell=True, cwd=here, env=env, capture_output=True, text=True)
        assert done.stdout == "systemctl restart klipper\n", done.stderr
    assert config.read_text() == "[axiscal]\n[mcu]\nserial: /dev/ttyACM0\n"
    assert (home / "klipper/klippy/extras/axiscal.py").read_text() == export.files["axiscal.py"]
    assert (home / "printer_data/config/axiscal.vcomp").read_text() == export.files["axiscal.vcomp"]
