"""An owner's INI and HAL files with the component in them: started on a real LinuxCNC, put in, taken out again."""

import re
from pathlib import Path

import numpy as np
import pytest

from axiscal.exceptions import InputError
from axiscal.numerics import Array
from axiscal.ports.linuxcnc.configuring import export_into
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.offer import Export
from axiscal.units import from_unit, to_unit
from tests.linuxcnc.lab import Joint, Session, Settings
from tests.linuxcnc.lab import files as lab_files
from tests.linuxcnc.needed import WITH_COMPONENT
from tests.linuxcnc.test_closed_loop import known

HAL = """\
loadrt [KINS]KINEMATICS
loadrt [EMCMOT]EMCMOT servo_period_nsec=[EMCMOT]SERVO_PERIOD num_joints=[KINS]JOINTS
loadrt lowpass names=lag
addf motion-command-handler servo-thread  # as in many a file
addf motion-controller servo-thread
addf lag servo-thread
setp lag.gain 1.0
net estop-loop iocontrol.0.user-enable-out => iocontrol.0.emc-enable-in
net tool-prep iocontrol.0.tool-prepare => iocontrol.0.tool-prepared
net tool-chg iocontrol.0.tool-change => iocontrol.0.tool-changed
net x-to-drive joint.0.motor-pos-cmd => lag.in
net x-is-at joint.0.motor-pos-fb <= lag.out
net y-both joint.1.motor-pos-cmd => joint.1.motor-pos-fb
net everything-homed <= motion.is-all-homed
net x-shown joint.0.pos-cmd
"""
BELTS = """\
delsig x-to-drive
delsig x-is-at
delsig y-both
loadrt corexy_by_hal names=belts
addf belts servo-thread
net x-to-belts joint.0.motor-pos-cmd => belts.j0-motor-pos-cmd
net y-to-belts joint.1.motor-pos-cmd => belts.j1-motor-pos-cmd
net x-of-belts belts.j0-motor-pos-fb => joint.0.motor-pos-fb
net y-of-belts belts.j1-motor-pos-fb => joint.1.motor-pos-fb
net belt-a belts.alpha-cmd => belts.alpha-fb
net belt-b belts.beta-cmd => belts.beta-fb
"""
"""A corexy as LinuxCNC's sample corexy_by_hal has it."""


def owned(folder: Path, hal: str = HAL) -> Path:
    """A mill's folder, as its owner may have it: two HAL files, and a backlash."""
    made = lab_files([Joint(axis, -400, 700) for axis in "XYZ"], Settings())
    ini = made["machine.ini"].replace("HALFILE = machine.hal", "HALFILE = mill.hal\nHALFILE = z.hal  # of Z")
    ini = ini.replace("COORDINATES = XYZ\n", "COORDINATES = X Y Z\n")  # as most people write it
    assert "X Y Z" in ini
    ini = ini.replace("[JOINT_0]\n", "[JOINT_0]\nBACKLASH = 0.01\n").replace("./driver.py", "axis")
    (folder / "mill.ini").write_text(ini)
    (folder / "mill.hal").write_text(hal)
    (folder / "z.hal").write_text("net z-both joint.2.motor-pos-cmd => joint.2.motor-pos-fb\n")
    (folder / "sim.tbl").write_text(made["sim.tbl"])
    return folder / "mill.ini"


_INCLUDE = re.compile(r"^#INCLUDE (\S+)$", re.MULTILINE)
_SCREEN = re.compile(r"^DISPLAY = .*$", re.MULTILINE)


def run_as_foretold(ini: Path, made: Export, axes: Array = np.eye(3)) -> None:  # noqa: B008
    """Start the patched files without motors, and hold that they correct every joint as the export says.

    axes : X, Y, Z of what joints 0, 1, 2 say, (3, 3)
    """
    text = _INCLUDE.sub(lambda found: (ini.parent / found[1]).read_text(), made.files["mill.ini"])
    beside = {name: each for name, each in made.files.items() if name.endswith((".hal", ".vcomp"))}
    beside["machine.ini"] = _SCREEN.sub("DISPLAY = ./driver.py", text)
    sources = {name: each for name, each in made.files.items() if name.startswith("axiscal_vcomp")}
    machine = known("three-axis")[0].machine
    with Session([Joint(axis) for axis in "XYZ"], Settings(beside=beside, sources=sources)) as session:
        session.move(["setp axiscal-vcomp.enable 1", "G53 G0 X90 Y-60 Z40", "G4 P1.2"])
        assert session.read(["axiscal-vcomp.gain", "axiscal-vcomp.fault-code"]) == (1, 0)
        assert session.errors == ()
        pins = [[f"axiscal-vcomp.{pin}-{n}" for n in range(3)] for pin in ("pos", "correction")]
        shown, added = (axes @ session.read(each) for each in pins)
    np.testing.assert_allclose(shown, [90, -60, 40], atol=1e-9)
    order = ["XYZ".index(axis.name) for axis in machine.axes]
    pose = np.array([[float(from_unit(shown[joint], "mm")) for joint in order]])
    either = np.sort([made.control(pose, np.full_like(pose, side))[0] for side in (1.0, -1.0)], axis=0)
    low, high = (np.asarray(to_unit(end, "mm")) for end in either)
    room = 1e-6 + 0.1 * (high - low)  # after homing it is the mean of both sides
    found = np.array([added[joint] for joint in order])
    assert np.any(found)
    assert np.all((found >= low - room) & (found <= high + room))


@pytest.fixture(scope="module")
def exported(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Export]:
    """The owner's INI file, and the export."""
    ini = owned(tmp_path_factory.mktemp("theirs"))
    return ini, export_into(ini, known("three-axis")[0], ExportOptions())


STARTED = [*WITH_COMPONENT, pytest.mark.long]


class TestStarted:
    pytestmark = STARTED

    def test_the_patched_files_correct_every_joint(self, exported: tuple[Path, Export]) -> None:
        run_as_foretold(*exported)

    def test_belts_that_hal_moves_behind_the_joints_are_corrected(self, tmp_path: Path) -> None:
        ini = owned(tmp_path, HAL + BELTS)
        run_as_foretold(ini, export_into(ini, known("three-axis")[0], ExportOptions(active=False)))

    def test_belts_that_the_kinematics_move_are_corrected_as_the_axes_they_are(self, tmp_path: Path) -> None:
        ini = owned(tmp_path)
        ini.write_text(ini.read_text().replace("KINEMATICS = trivkins coordinates=XYZ", "KINEMATICS = corexykins"))
        made = export_into(ini, known("three-axis")[0], ExportOptions(active=False))
        run_as_foretold(ini, made, np.array([[0.5, 0.5, 0], [0.5, -0.5, 0], [0, 0, 1]]))

    def test_what_it_includes_is_started_with_it(self, tmp_path: Path) -> None:
        ini = owned(tmp_path)
        first, *sections = ini.read_text().split("\n[")
        (drives,) = (each for each in sections if each.startswith("JOINT_2"))
        (tmp_path / "parts").mkdir()
        (tmp_path / "parts" / "z.inc").write_text(f"[{drives}\n")
        kept = ["", *(each for each in sections if each is not drives)]
        ini.write_text(first + "\n[".join(kept) + "\n#INCLUDE parts/z.inc\n")
        run_as_foretold(ini, export_into(ini, known("three-axis")[0], ExportOptions()))


def test_another_machine_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"the INI file has axes X Y Z, machine.toml A C X Y Z"):
        export_into(owned(tmp_path), known("xyzac")[0], ExportOptions())
    ini = owned(tmp_path)
    made = lab_files([Joint(axis) for axis in "XYZAC"], Settings(kinematics="xyzac-trt-kins"))
    hal = HAL + "setp xyzac-trt-kins.conventional-directions 1\n"
    ini.write_text(made["machine.ini"].replace("HALFILE = machine.hal", "HALFILE = mill.hal"))
    (tmp_path / "mill.hal").write_text(hal)
    with pytest.raises(InputError, match=r"turns [AC] by ISO 841, and machine.toml says the other way"):
        export_into(ini, known("xyzac")[0], ExportOptions())
