"""Machines from INI files of LinuxCNC: files that the real controller takes, Debian's own examples, and rubbish."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.description.first_files import machine_text, unread
from axiscal.description.ini_file import read_ini
from axiscal.description.ini_machine import IniMachine, machine_of
from axiscal.exceptions import AxiscalError
from axiscal.machine import load_machine, machine_from_text
from axiscal.measurement.readers.text_file import MOST_LINES
from axiscal_core.machine import Machine
from tests.linuxcnc.lab import Joint, Settings, files
from tests.refusals.reading import refusals

EXAMPLES = Path("/usr/share/doc/linuxcnc/examples/sample-configs")
SMALL = refusals("ini").texts["small"]


def found(folder: Path, text: str, others: Mapping[str, str] | None = None) -> IniMachine:
    """Return what is read of an INI file with other files beside it."""
    for name, content in {"machine.ini": text, **(others or {})}.items():
        (folder / name).write_text(content)
    return machine_of(read_ini(folder / "machine.ini"))


def built(read: IniMachine) -> Machine:
    """Return the machine of the text that is written."""
    return machine_from_text(machine_text(read, "machine.ini"))


def of_lab(folder: Path, joints: list[Joint], chosen: Settings | None = None) -> IniMachine:
    """Return what is read of the files with which the tests start the real LinuxCNC."""
    written = dict(files(joints, chosen or Settings()))
    return found(folder, written.pop("machine.ini"), written)


def test_it_reads_what_the_real_controller_takes(tmp_path: Path) -> None:
    joints = [Joint("X", 0, 24, 10, 50), Joint("Y", 0, 12, 10, 50), Joint("Z", -10, 0, 5, 20, table="0 0 0\n")]
    read = of_lab(tmp_path, joints, Settings(unit="in"))
    machine = built(read)
    np.testing.assert_allclose(machine.axis("X").travel, [0, 24 * 0.0254], rtol=1e-9)
    np.testing.assert_allclose(machine.axis("Z").acceleration, 20 * 0.0254, rtol=1e-9)
    assert (read.compensated, read.servo_period) == ((2,), 1e-3)


def test_an_axis_of_two_joints_is_a_bridge_that_carries_the_others(tmp_path: Path) -> None:
    read = of_lab(tmp_path, [Joint("X"), Joint("Y"), Joint("Z"), Joint("Y")])
    assert built(read).chain == "w-b-Y-X-Z-t"
    assert {axis.letter: axis.joints for axis in read.axes}["Y"] == (1, 3)
    assert any("which axes carry the workpiece" in each for each in unread(read))


@pytest.mark.parametrize(("swivel", "way", "unit"), [("A", "y", "mm"), ("B", "x", "in")])
def test_pivots_are_where_the_rotary_axes_lie(tmp_path: Path, swivel: str, way: str, unit: str) -> None:
    name, scale = f"xyz{swivel.lower()}c-trt-kins", {"mm": 1e-3, "in": 0.0254}[unit]
    pins = {"x-rot-point": 1.0, "y-rot-point": -2.0, "z-rot-point": 3.0, f"{way}-offset": 4.0}
    hal = "\n".join(f"setp {name}.{pin} {value}" for pin, value in pins.items())
    hal += f"\nnet :height {name}.z-offset other.pin\nsets :height 0.5\n"
    joints = [Joint(letter, -90, 90) for letter in f"XYZ{swivel}C"]
    machine = built(of_lab(tmp_path, joints, Settings(hal, name, unit)))
    assert machine.chain == f"w-C'-{swivel}'-X'-Y'-b-Z-t"
    assert [axis.name for axis in machine.axes if axis.reversed] == ["C", swivel]
    places = {axis.name: np.array(axis.origin) / scale for axis in machine.axes if axis.rotary}
    np.testing.assert_allclose(places["C"][:2], [1.0, -2.0], atol=1e-9)
    across = "xy".index(way)
    np.testing.assert_allclose(places[swivel][[across, 2]], [(1.0, -2.0)[across] + 4.0, 3.5], atol=1e-9)


def test_a_rotary_axis_without_end_has_a_turn_of_travel_and_its_limits(tmp_path: Path) -> None:
    machine = built(of_lab(tmp_path, [Joint("X"), Joint("Z"), Joint("C", -36000, 7200)]))
    np.testing.assert_allclose(machine.axis("C").travel, [0, 2 * np.pi])
    assert machine.chain == "w-C'-b-Z-X-t"


@pytest.mark.parametrize(
    ("kinematics", "moving", "joints"),
    [
        ("trivkins", "X Z", {"X": 0, "Z": 2}),
        ("trivkins coordinates=xz", "X Z", {"X": 0, "Z": 1}),
        ("trivkins", "X Y Z C", {"X": 0, "Y": 1, "Z": 2, "C": 5}),
    ],
)
def test_joints_are_numbered_as_the_kinematics_do(
    tmp_path: Path, kinematics: str, moving: str, joints: Mapping[str, int]
) -> None:
    """As kins(9) says: Debian's lathes of two axes have the sections JOINT_0 and JOINT_2."""
    text = SMALL.replace("trivkins", kinematics).replace("X Y Z\n", f"{moving}\n").replace("JOINTS = 3", "JOINTS = 6")
    read = found(tmp_path, text)
    assert {axis.letter: axis.joints for axis in read.axes} == {name: (n,) for name, n in joints.items()}


def test_what_an_included_file_includes_is_a_remark_as_it_is_to_linuxcnc(tmp_path: Path) -> None:
    text, others = SMALL.replace("MAX_LIMIT = 600", "#INCLUDE x.inc"), {"y.inc": "MAX_LIMIT = 700\n"}
    read = found(tmp_path, text, {"x.inc": "#INCLUDE y.inc\nMAX_LIMIT = 500\n#include y.inc\n", **others})
    assert built(read).axis("X").travel == pytest.approx((0.0, 0.5))


@pytest.mark.parametrize(
    ("linear", "unit", "metres"), [("1", "mm", 1e-3), ("0.03937007874", "in", 0.0254), ("inch", "in", 0.0254)]
)
def test_units_may_be_numbers(tmp_path: Path, linear: str, unit: str, metres: float) -> None:
    text = SMALL.replace("LINEAR_UNITS = mm", f"LINEAR_UNITS = {linear}\nANGULAR_UNITS = 1")
    read = found(tmp_path, text)
    assert read.unit == unit
    assert built(read).axis("X").travel == pytest.approx((0.0, 600 * metres))


def test_hal_files_that_are_not_there_set_no_pivot_and_one_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    axes = "".join(f"[AXIS_{letter}]\nMIN_LIMIT = -90\nMAX_LIMIT = 90\n" for letter in "BC")
    five = SMALL.replace("trivkins", "xyzbc-trt-kins").replace("X Y Z", "X Y Z B C").replace("JOINTS = 3", "JOINTS = 5")
    text = five + axes
    hal = "[HAL]\nHALFILE = LIB:basic_sim.tcl\nHALFILE = other.hal\nHALFILE =\n"
    assert found(tmp_path, text + hal).origins["B"] == (0.0, 0.0, 0.0)
    (tmp_path / "other.hal").write_text("\n" * (MOST_LINES + 1))
    with pytest.raises(AxiscalError, match=r"machine\.ini, line 27: .*other\.hal"):
        found(tmp_path, text + hal)


def test_what_an_ini_file_calls_itself_writes_nothing_else_into_ours(tmp_path: Path) -> None:
    evil = SMALL.replace('mill "of" mine', 'a"\\ [errors] \x07 \u2028 chain = "w-b-t"')
    assert built(found(tmp_path, evil)).chain == "w-X'-Y'-b-Z-t"


LINES = [*SMALL.splitlines(), "[JOINT_0]", "BACKLASH = 0.02", "MAX_LIMIT = 1e99", "KINEMATICS =", "= 5", "[", "A=\\"]


@given(st.lists(st.sampled_from(LINES) | st.text(max_size=30), max_size=40))
def test_rubbish_is_refused_in_words_or_is_a_machine(
    tmp_path_factory: pytest.TempPathFactory, lines: list[str]
) -> None:
    file = tmp_path_factory.getbasetemp() / "rubbish.ini"
    file.write_text("\n".join(lines), encoding="utf-8", errors="replace")
    try:
        read = machine_of(read_ini(file))
    except AxiscalError:
        return
    assert len(built(read).axes) >= 1


def test_debians_examples_are_read_or_refused_in_words(tmp_path: Path) -> None:
    examples = sorted(EXAMPLES.rglob("*.ini"))
    if not examples:
        pytest.skip("needs Debian's linuxcnc-uspace")
    taken, refused = 0, list[str]()
    for example in examples[::6]:  # every sixth: they are many alike
        try:
            text = machine_text(machine_of(read_ini(example)), example.name)
        except AxiscalError as failure:
            refused.append(str(failure))
            continue
        (tmp_path / "machine.toml").write_text(text)
        assert load_machine(tmp_path / "machine.toml").axes, example
        taken += 1
    assert taken > 4 * len(refused), refused
