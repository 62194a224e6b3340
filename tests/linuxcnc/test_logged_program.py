"""A program that touches spheres by itself, run by LinuxCNC, and its log read back."""

from pathlib import Path

import numpy as np
import pytest

from axiscal.description.placed_readings import logged_readings
from axiscal.programs import write_programs
from tests.generators import touched_table as table
from tests.linuxcnc import bench
from tests.linuxcnc.lab import Session, Settings
from tests.linuxcnc.needed import WITH_SPHERES

pytestmark = WITH_SPHERES
_LATE = "Queue is not empty after probing"


@pytest.mark.parametrize(("unit", "scale", "count"), [("mm", 1.0, 3), ("in", 25.4, 1)])
def test_the_log_of_the_running_control_is_read_back_as_what_the_machine_does(
    unit: str, scale: float, count: int, tmp_path: Path
) -> None:
    campaign = table.description()
    places = table.places(campaign, count)
    files = write_programs(campaign.machine, campaign.setups, places, "linuxcnc", tmp_path, log=True)
    text = bench.at_full_speed(files[0].read_text(encoding="ascii"))
    settings = Settings(
        bench.hal(scale), unit=unit, beside={"p.ngc": text}, sources={"axiscal_balls.comp": bench.BALLS}
    )
    (name,) = [line.split(",")[1][:-1] for line in text.splitlines() if line.startswith("(LOGAPPEND,")]
    errors: tuple[str, ...] = (_LATE,)
    for _ in range(3):  # a simulated control on a loaded computer may hear too late that its motion has ended
        if errors == (_LATE,):
            with Session(bench.joints(scale), settings, timeout=240) as session:
                session.move(["run p.ngc"])
                errors, written = session.errors, session.written(name)
    assert errors == ()
    (tmp_path / name).write_text(written, encoding="utf-8")
    readings, told = logged_readings(tmp_path / name, tmp_path, campaign)
    assert told == ()
    assert [reading.number for reading in readings] == list(range(1, len(places) + 1))
    for reading, place in zip(readings, places, strict=True):
        found = 1e6 * np.array([reading.value, *reading.others])
        np.testing.assert_allclose(found, table.expected_at(campaign, place), atol=1.2)
