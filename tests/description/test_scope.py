"""Machines of another kind: robots are described as their page says; what is out of scope is refused with its page."""

import numpy as np
import pytest

from axiscal.machine import machine_from_text
from tests.docs.howtos import DOCS, files


def test_the_arm_of_the_page_reaches_where_its_joints_say() -> None:
    scara = machine_from_text(files(DOCS / "robots.md")["machine.toml"])
    shoulder, elbow = np.radians(30.0), np.radians(-70.0)
    at = scara.frames(np.array([[0.05, shoulder, elbow], [0.0, 0.0, 0.0]])).tcp
    reach = [-0.55 + 0.3 * np.cos(shoulder) + 0.25 * np.cos(shoulder + elbow)]
    reach += [0.3 * np.sin(shoulder) + 0.25 * np.sin(shoulder + elbow), 0.05]
    assert at == pytest.approx(np.array([reach, [0.0, 0.0, 0.0]]), abs=1e-12)
