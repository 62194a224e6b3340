"""What printers' files say to the firmware and to their reader: against what the firmware's documents compute."""

import numpy as np
import pytest

from axiscal.ports.printers.contents import play_of
from axiscal.ports.printers.marlin import Marlin
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.loaded import Loaded
from axiscal.tables.sampling import axis_tables, backlash
from axiscal.tables.surface import skew_of
from tests.tables.test_controllers import known
from tests.tables.test_sampling import known as drawn_machine
from tests.tables.test_sampling import machine as linear_machine

SMALL = known("small")[0]
MACHINE = SMALL.machine


def test_one_backlash_is_the_mean_of_what_coming_from_above_is_more_than_from_below() -> None:
    tables = {table.axis: table for table in axis_tables(SMALL)}
    expected = {}
    for name, table in tables.items():
        apart = np.interp(np.linspace(*SMALL.box[MACHINE.index(name)], 20_001), table.positions, table.reverse)
        apart = apart - np.interp(np.linspace(*SMALL.box[MACHINE.index(name)], 20_001), table.positions, table.forward)
        expected[name] = float(np.mean(apart))
    found = backlash(SMALL)
    assert found == pytest.approx(expected, rel=2e-3)
    assert play_of(Marlin().content(SMALL, ExportOptions(mesh=5))) == pytest.approx(
        {name: value for name, value in found.items() if value > 0}
    )


def test_a_skew_is_the_slope_of_the_mean_of_both_sides_and_is_taken_away_as_printers_do() -> None:
    estimate = drawn_machine(linear_machine("w-b-X-Y-Z-t"), 55)[0]
    found, (low, high) = skew_of(estimate), np.array(estimate.box).T
    poses = np.random.default_rng(1).uniform(low, high, (40_000, 3))
    deviation = estimate.deviation(poses, np.zeros_like(poses))
    for moved, over, tangent in (("X", "Y", found["XY"]), ("X", "Z", found["XZ"]), ("Y", "Z", found["YZ"])):
        slope = np.polyfit(poses[:, estimate.machine.index(over)], deviation[:, "XYZ".index(moved)], 1)[0]
        assert tangent == pytest.approx(slope, abs=4e-6)
        assert abs(slope) > 4e-5  # each plane is skewed ten times what the slope may differ by
    x, y, z = (MACHINE.index(name) for name in "XYZ")
    poses = np.array([[0.1, 0.2, 0.3]])[:, np.argsort([x, y, z])]
    added = Loaded(skew={"XY": 0.01, "XZ": 0.02, "YZ": -0.03}).control(MACHINE)(poses, np.zeros((1, 3)))
    by_name = dict(zip("XYZ", poses[0, [x, y, z]].tolist(), strict=True))
    assert added[0, x] == pytest.approx(-by_name["Y"] * 0.01 - by_name["Z"] * (0.02 + 0.01 * 0.03))
    assert added[0, y] == pytest.approx(by_name["Z"] * 0.03)
    assert added[0, z] == 0.0
