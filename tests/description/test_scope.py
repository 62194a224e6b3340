"""Machines of another kind: robots are described as their page says; what is out of scope is refused with its page."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from axiscal.machine import machine_from_text
from axiscal.machine.kinematics import frames
from tests.docs.howtos import DOCS, files
from tests.zoo.running import given

INI = "[KINS]\nKINEMATICS = {}\nJOINTS = 6\n[TRAJ]\nCOORDINATES = XYZABC\n"
DELTA = "[printer]\nkinematics: {}\n[stepper_a]\narm_length: 333\n"


def test_the_arm_of_the_page_reaches_where_its_joints_say() -> None:
    scara = machine_from_text(files(DOCS / "robots.md")["machine.toml"])
    shoulder, elbow = np.radians(30.0), np.radians(-70.0)
    at = frames(scara, np.array([[0.05, shoulder, elbow], [0.0, 0.0, 0.0]])).tcp
    reach = [-0.55 + 0.3 * np.cos(shoulder) + 0.25 * np.cos(shoulder + elbow)]
    reach += [0.3 * np.sin(shoulder) + 0.25 * np.sin(shoulder + elbow), 0.05]
    assert at == pytest.approx(np.array([reach, [0.0, 0.0, 0.0]]), abs=1e-12)


@pytest.mark.parametrize(
    ("text", "page"),
    [
        *((DELTA.format(name), "scope.md") for name in ("delta", "polar", "rotary_delta")),
        *((INI.format(name), "scope.md") for name in ("genhexkins", "lineardeltakins")),
        *((INI.format(name), "robots.md") for name in ("scarakins", "pumakins", "genserkins")),
    ],
)
def test_init_names_the_page_for_what_is_no_chain_of_axes(tmp_path: Path, text: str, page: str) -> None:
    file = tmp_path / ("printer.cfg" if "[printer]" in text else "machine.ini")
    file.write_text(text)
    given("init", tmp_path / "new", "--from", file, "--instrument", "probe", "--target", "30 um").refused(
        f"{file.name}, line 2", f"docs/{page}"
    )
    assert (DOCS / page).is_file()
    assert not (tmp_path / "new").exists()
