"""A bump in mid travel tells which way a control takes its tables: as assumed, or the other way round."""

from dataclasses import replace

import numpy as np
import pytest

from axiscal.exceptions import TableError
from axiscal.tables.bump import bumped, other_way
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.loaded import OldFile
from axiscal.tables.registry import export, exporter, unstated
from tests.tables.test_controllers import OPTIONS, known


@pytest.mark.parametrize(
    ("controller", "flips"),
    [("isg", False), *((name, flips) for name in ("heidenhain", "fanuc", "sinumerik") for flips in (False, True))],
)
def test_two_readings_tell_which_way_a_control_takes_its_tables(controller: str, flips: bool) -> None:
    estimate = known("small")[0]
    made = exporter(controller)
    bump, told = bumped(estimate, controller, made.unstated)
    options = OPTIONS.get(controller, ExportOptions())
    offered = export(bump, controller, options)
    machine, name = estimate.machine, told.split("Let ")[1][0]
    files = [OldFile(*file) for file in offered.files.items()]
    control = made.load(files, machine, replace(options, flip=flips)).control(machine)
    poses = np.tile(np.mean(np.array([axis.travel for axis in machine.axes]), axis=1), (2, 1))
    (axis,), places = [each for each in machine.axes if each.name == name], told.split(" come from below to ")[1]
    poses[:, machine.index(name)] = [float(place.split()[0]) / 1e3 for place in places.split(" and to ")[:2]]
    assert np.all(poses[:, machine.index(name)] - axis.overrun >= axis.travel[0])
    way = "XYZ"["xyz".index(told.split("along +")[1][0])]
    added = control(poses, np.ones_like(poses))[:, machine.index(way)]
    moved = float(added[1] - added[0]) * float(np.sum(machine.axis(way).direction))
    assert abs(moved) == pytest.approx(10e-6, abs=0.5e-6)
    assert other_way(moved) is flips


def test_a_control_whose_sign_is_stated_needs_no_bump_and_one_that_did_not_come_is_said() -> None:
    with pytest.raises(TableError, match="linuxcnc states which way it takes its tables"):
        unstated("linuxcnc")
    with pytest.raises(TableError, match=r"the bump moved the tool by 0\.2 um"):
        other_way(0.2e-6)
