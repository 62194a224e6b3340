"""A program that touches spheres by itself, run by LinuxCNC, and its log read back."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from axiscal.description.logged import logged_readings
from axiscal.gcode import write_programs
from axiscal.lab.linuxcnc import Joint, Session, Settings, available, can_load
from tests.generators import touched_table as table

pytestmark = [
    pytest.mark.linuxcnc,
    pytest.mark.skipif(not available(), reason="Debian package linuxcnc-uspace is not installed"),
    pytest.mark.skipif(not can_load("axiscal_balls"), reason="needs Debian's linuxcnc-uspace-dev and gcc"),
]


def hal(scale: float = 1.0) -> str:
    """Return HAL with the spheres on the table, where the motors of X, Y, Z, A, C are.  scale : mm in its unit"""
    lines = ["loadrt axiscal_balls", "addf axiscal-balls servo-thread", f"setp axiscal-balls.tool {80 / scale}"]
    lines += [f"net j{n}m => axiscal-balls.{axis}" for n, axis in enumerate("xyzac")]
    lines += [f"setp axiscal-balls.{name} {value / scale}" for name, value in table.LINES.items()]
    lines += [f"setp axiscal-balls.radius {table.RADIUS / scale}"]
    for number, place in enumerate([*table.BALLS.values(), (1e6, 0.0, 0.0)]):
        lines += [f"setp axiscal-balls.b{axis}{number} {at / scale}" for axis, at in zip("xyz", place, strict=True)]
    return "\n".join([*lines, "net probe axiscal-balls.touched => motion.probe-input"]) + "\n"


def sources() -> dict[str, str]:
    return {"axiscal_balls.comp": Path(__file__).with_name("axiscal_balls.comp").read_text(encoding="ascii")}


@pytest.mark.parametrize(("unit", "scale", "count"), [("mm", 1.0, 3), ("in", 25.4, 1)])
def test_the_log_of_the_running_control_is_read_back_as_what_the_machine_does(
    unit: str, scale: float, count: int, tmp_path: Path
) -> None:
    campaign = table.description()
    places = table.places(campaign, count)
    files = write_programs(campaign.machine, campaign.setups, places, "linuxcnc", tmp_path, log=True)
    text = files[0].read_text(encoding="ascii").replace(" [300] ", " [2400] ").replace(" [600]", " [30000]")
    text = re.sub(r"(?<= F)\d+$", "60000", text, flags=re.MULTILINE)  # as fast as can be, but for the slow touch
    joints = [
        Joint(axis, *((-400.0, 400.0) if axis in "AC" else (-400 / scale, 400 / scale)), 2000.0, 5e4)
        for axis in "XYZAC"
    ]
    settings = Settings(hal(scale), unit=unit, beside={"p.ngc": text}, sources=sources())
    with Session(joints, settings, timeout=240) as session:
        session.move(["run p.ngc"])
        assert session.errors == ()
        (name,) = [line.split(",")[1][:-1] for line in text.splitlines() if line.startswith("(LOGAPPEND,")]
        (tmp_path / name).write_text(session.written(name), encoding="utf-8")
    logged = logged_readings(tmp_path / name, tmp_path, campaign)
    assert logged.said == ()
    assert [reading.number for reading in logged.readings] == list(range(1, len(places) + 1))
    for reading, place in zip(logged.readings, places, strict=True):
        found = 1e6 * np.array([reading.value, *reading.others])
        np.testing.assert_allclose(found, table.expected_at(campaign, place), atol=1.2)
