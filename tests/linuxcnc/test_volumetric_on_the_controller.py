"""The whole correction in LinuxCNC's own servo thread: it sends motors where our reader says, smoothly, and refuses."""

import re
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from axiscal.numerics import Array
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.offer import Export
from axiscal.tables.registry import export
from axiscal.tables.surface import left_by, rms
from axiscal.tables.vcomp_file import fnv1a
from tests.figures import held
from tests.linuxcnc.lab import Joint, Session, Settings
from tests.linuxcnc.needed import WITH_COMPONENT
from tests.linuxcnc.running import ControlError
from tests.linuxcnc.test_closed_loop import known, spread
from tests.linuxcnc.virtual import EXAMPLES, LinuxcncMachine
from tests.tables.core_library import stated
from tests.tables.test_vcomp_file import signed

pytestmark = [*WITH_COMPONENT, pytest.mark.long]
IN_ORDER = True
"""One control goes on from where the last test left it: a start takes twenty seconds."""
JOINTS = "XYZAC"
SPEED, ACCELERATION = 500.0, 2500.0
PLACES = 12
HEAD = 1.3
"""The figures of the design were measured; a limit is so much above them."""


@pytest.mark.parametrize("name", ["gantry", "inch", "xyzac"])
def test_motors_go_where_our_reader_says_and_the_error_is_gone(name: str) -> None:
    """Two joints for an axis, inches, trt-kins in TCP mode: 1e-6 mm, at most 1.1 times what was foretold is left."""
    estimate, truth = known(name)
    _, build, options = EXAMPLES[name]
    made = export(estimate, "linuxcnc-volumetric", options)
    poses, approaches = (values[:PLACES] for values in spread(estimate))
    with LinuxcncMachine(truth, made.files, build) as machine:
        sent = machine.sent(poses, approaches)
        left = machine.seen.deviation(poses, approaches)
        assert machine.errors == ()
    apart = np.abs(sent - poses - made.control(poses, approaches)).max(axis=0)
    assert np.max(np.abs(sent - poses)) > 1e-6
    written = 0.6e-7 * (0.0254 if build.unit == "in" else 1e-3)  # half of the last digit of a command
    for axis, far in zip(estimate.machine.axes, apart, strict=True):
        unit, limit = ("deg", 1e-6) if axis.rotary else ("mm", 1e-6 + 1e3 * written)
        held(f"motors against we, {unit}", np.degrees(far) if axis.rotary else 1e3 * far, limit, unit)
    foretold = rms(left_by(estimate.machine, truth.deviation, made.control, poses, approaches))
    limit = 1.1 * foretold + np.sqrt(3) * written + 0.5e-9
    held("left over, of 1.1 times what was foretold and a digit", 1e6 * rms(left), 1e6 * limit, "um")
    assert rms(left) < 1e-3 * rms(truth.deviation(poses, approaches))


def exported() -> Export:
    return export(known("xyzac")[0], "linuxcnc-volumetric", ExportOptions())


def settings(files: dict[str, str], hal: str = "", unit: str = "mm") -> Settings:
    sources = {name: text for name, text in files.items() if name.startswith("axiscal_vcomp")}
    beside = {"axiscal.vcomp": files["axiscal.vcomp"]}
    return Settings(files["axiscal-volumetric.hal"] + hal, unit=unit, beside=beside, sources=sources)


def joints(**own: object) -> list[Joint]:
    return [
        Joint(axis, -400, 400, SPEED, ACCELERATION, **own)  # type: ignore[arg-type]
        for axis in JOINTS
    ]


NANO = {"moved": ("vc-drv-0", "vc-mot-0"), "correction": ("corrected", ""), "behind": ("following", "")}
"""Differences in nm, since the sampler writes six decimals: what the drive gets more, the correction, the error."""
SAMPLER = (
    "loadrt sampler depth=16000 cfg=ffffff\n"
    f"loadrt sum2 names={','.join(NANO)}\n"
    "net corrected axiscal-vcomp.correction-0\nnet following joint.0.f-error\nnet gained axiscal-vcomp.gain\n"
    + "".join(
        f"addf {name} servo-thread\nsetp {name}.gain0 1e6\nsetp {name}.gain1 -1e6\nnet {plus} => {name}.in0\n"
        + (f"net {minus} => {name}.in1\n" if minus else "")
        + f"net nano-{name} {name}.out => sampler.0.pin.{i}\n"
        for i, (name, (plus, minus)) in enumerate(NANO.items(), 2)
    )
    + "net vc-mot-0 => sampler.0.pin.0\nnet vc-drv-0 => sampler.0.pin.1\nnet gained => sampler.0.pin.5\n"
    "addf sampler.0 servo-thread\nsetp sampler.0.enable 0\n"
)
TOOL = "".join(f"net vc-tool-{d} motion.tooloffset.{d} => axiscal-vcomp.tool-{d}\n" for d in "xyz")


@pytest.fixture(scope="module")
def running() -> Iterator[Session]:
    """One LinuxCNC for what follows: trivkins, and X is homed 7 mm from zero."""
    every = [replace(joint, home_offset=7.0 * (joint.axis == "X")) for joint in joints()]
    with Session(every, settings(dict(exported().files), SAMPLER + TOOL)) as session:
        yield session


def on(session: Session) -> None:
    session.move(["setp axiscal-vcomp.enable 1", "G4 P1.2"])
    assert session.read(["axiscal-vcomp.gain", "axiscal-vcomp.active", "axiscal-vcomp.fault"]) == (1, 1, 0)


def watched(session: Session, codes: list[str]) -> tuple[Array, Array, float, float]:
    """Return commands and corrections of X (n,), and the largest speed and acceleration of the correction, mm/s."""
    taken = np.array(session.sample(codes))
    moved, correction, behind = (taken[:, i] for i in (2, 3, 4))
    held("the drive gets command and correction in one cycle", np.max(np.abs(moved - correction)), 1e-3, "nm")
    held("following error of a perfect drive", np.max(np.abs(behind)), 1.0, "nm")
    correction = correction * 1e-6
    speed, acceleration = np.diff(correction) * 1e3, np.diff(correction, 2) * 1e6
    return taken[:, 0], correction, float(np.max(np.abs(speed))), float(np.max(np.abs(acceleration)))


def test_off_at_the_start_it_only_counts(running: Session) -> None:
    running.move(["G53 G0 X60 Y-40 Z30 A20 C70"])
    names = [f"axiscal-vcomp.{name}" for name in ("gain", "correction-0", "correction-3", "active", "fault")]
    assert running.read(names) == (0, 0, 0, 0, 0)
    largest, checksum = running.read(["axiscal-vcomp.largest", "axiscal-vcomp.checksum"])
    assert largest > 0.005
    body, _, said = exported().files["axiscal.vcomp"].rpartition("end ")
    assert checksum == fnv1a(body.encode()) == int(said, 16)


def test_it_comes_and_goes_by_the_quintic_while_the_axes_move(running: Session) -> None:
    running.move(["G53 G0 X60 Y-40 Z30 A20 C70"])
    on(running)
    there = abs(running.read(["axiscal-vcomp.correction-0"])[0])
    codes = ["F6000", "G53 G1 X160", "setp axiscal-vcomp.enable 0", "G53 G1 X60", "G4 P1.1"]
    _, correction, speed, acceleration = watched(running, codes)
    assert correction[-1] == 0
    held("on and off at F6000: speed", speed, HEAD * 0.14 * max(1.0, there / 0.092) + 0.1, "mm/s")
    held("on and off at F6000: acceleration, a reversal in it", acceleration, 340.0, "mm/s²")
    _, correction, speed, acceleration = watched(running, ["setp axiscal-vcomp.enable 1", "G4 P1.2"])
    there = abs(correction[-1])  # from the other side
    assert there > 0.001
    held("on at rest: speed (the quintic's 15/8 in a second)", speed, 1.9 * there + 1e-9, "mm/s")
    held("on at rest: acceleration", acceleration, HEAD * 5.8 * there + 1e-6, "mm/s²")


def test_what_moves_with_the_axes_is_gentle(running: Session) -> None:
    """A fast diagonal, and turns of A and C: within the design's figures for an error three times as large."""
    on(running)
    running.move(["G53 G0 X-100 Y-90 Z10 A0 C0", "G53 G0 X-98"])  # the side of X is settled
    _, _, speed, acceleration = watched(running, ["G53 G0 X120 Y110 Z120"])
    held("G0 diagonal at 500 mm/s: speed", speed, HEAD * 0.34, "mm/s")
    held("G0 diagonal: acceleration, the side of Y turns in it", acceleration, 30, "mm/s²")
    _, _, speed, acceleration = watched(running, ["G53 G0 A55 C200"])
    held("A and C by 55 and 200 deg: speed", speed, HEAD * 0.34, "mm/s")
    _, _, speed, acceleration = watched(running, ["G53 G0 X145", "G53 G0 X190"])  # across the end of the travel
    held("across the end of the calibrated range: speed", speed, HEAD * 0.29, "mm/s")
    held("across the end of the calibrated range: acceleration", acceleration, HEAD * 21, "mm/s²")
    assert running.read(["axiscal-vcomp.outside"]) == (1,)


def test_a_reversal_is_a_parabola_each_way(running: Session) -> None:
    on(running)
    text = exported().files["axiscal.vcomp"].partition("axis X ")[2]
    seconds = float(text.partition(" reversal 1 ")[2].split("\n")[0])
    running.move(["G53 G0 X20", "G53 G0 X30"])
    _, correction, _, acceleration = watched(running, ["G53 G1 F600 X29.99", "G4 P0.1"])
    step = abs(float(text.partition("knot ")[2].split("\n")[7].split()[0]))  # behind a knot and its six motions
    assert abs(correction[-1] - correction[0]) == pytest.approx(step, rel=0.05)
    held("reversal of X: acceleration, 1.05 of 4 J/T²", acceleration, 1.05 * 4 * step / seconds**2, "mm/s²")
    still = np.array(running.sample(["G4 P0.2"]))[:, 3]
    assert np.ptp(still) == 0  # at a standstill nothing moves
    _, correction, _, _ = watched(running, ["G53 G1 F600 X29.9902", "G53 G1 X29.99", "G4 P0.1"])
    assert np.ptp(correction) < 1e-6  # within the dead band no side turns


def test_another_tool_is_followed_slowly_and_counts(running: Session) -> None:
    """The correction at rest for 100 mm more tool is that of we, and came at 100 mm/s of tool."""
    on(running)
    running.move(["G53 G0 X60 Y-40 Z30 A20 C70"])
    _, correction, speed, _ = watched(running, ["G43.1 Z180", "G4 P1.5"])
    estimate, at = known("xyzac")[0], dict(zip(JOINTS, (60.0, -40.0, 30.0, 20.0, 70.0), strict=True))
    longer = replace(estimate.machine, tool=(0.0, 0.0, -0.18))
    pose = np.array([[at[axis.name] for axis in longer.axes]])
    motors = running.read([f"axiscal-vcomp.correction-{n}" for n in range(5)])
    z = motors[2] - stated(longer, estimate.mean, pose, np.ones_like(pose))[0, longer.index("Z")]
    assert z == pytest.approx(0, abs=1e-6)  # Z has no reversal on this machine
    assert abs(correction[-1] - correction[0]) > 1e-5
    held("a tool 100 mm longer, at rest: speed", speed, 0.02, "mm/s")
    running.move(["G49"])


def test_over_the_limit_it_fades_on_the_way_and_there_is_a_way_out() -> None:
    """A limit that is met at F12000: clamped, then ramped off; the move goes on, and after a reset it comes again."""
    files, estimate = dict(exported().files), known("xyzac")[0]
    axes = estimate.machine.axes
    places = np.random.default_rng(3).uniform([0, -50, -140, -140, 0], [300, 50, 140, 140, 150], (300, 5))
    linear = [k for k, axis in enumerate(axes) if not axis.rotary]
    sizes = np.abs(stated(estimate.machine, estimate.mean, places, np.zeros_like(places)))[:, linear].max(axis=1)
    start, end = (
        " ".join(f"{axis.name}{at:.3f}" for axis, at in zip(axes, places[choose(sizes)], strict=True))
        for choose in (np.argmin, np.argmax)
    )
    limit = f"{(sizes.min() + sizes.max()) / 2:.6f}"
    files["axiscal.vcomp"] = signed(re.sub(r"(?m)^limits \S+", f"limits {limit}", files["axiscal.vcomp"]))
    with Session(joints(), settings(files, SAMPLER)) as session:
        session.move([f"G53 G0 {start}"])
        on(session)
        _, correction, speed, _ = watched(session, [f"G53 G1 F12000 {end}", "G4 P1.2"])
        assert np.max(np.abs(correction)) <= float(limit) + 1e-12
        assert session.read(["axiscal-vcomp.fault", "axiscal-vcomp.fault-code", "axiscal-vcomp.gain"]) == (1, 1, 0)
        held("fault at F12000, clamped and faded: speed", speed, HEAD * (0.34 + 1.9 * float(limit)), "mm/s")
        assert f"X{session.read(['joint.0.pos-cmd'])[0]:.3f}" in end  # the move itself went on
        session.move([f"G53 G0 {start}", "setp axiscal-vcomp.enable 0", "setp axiscal-vcomp.reset 1", "G4 P0.1"])
        assert session.read(["axiscal-vcomp.fault", "axiscal-vcomp.fault-code"]) == (0, 0)
        on(session)


def test_homing_again_changes_nothing_at_once(running: Session) -> None:
    """The coordinate of X jumps by 93 mm while it is homed; the drive only goes the 7 mm home, without a step."""
    on(running)
    running.move(["G53 G0 X100 Y60 Z30 A20 C70"])
    taken = np.array(running.sample(["home 0", "G4 P1.3"]))
    step = np.max(np.abs(np.diff(taken[:, 1], 2)))
    held("homed again: change of the drive's step in a cycle", step, 1.5e-6 * ACCELERATION, "mm")
    assert np.min(taken[:, 5]) == 0.0
    assert taken[-1, 5] == 1.0


def test_a_table_beside_it_is_a_fault() -> None:
    """COMP_FILE and the component would correct twice: fault 3 as soon as the table works, nothing is applied."""
    table = "".join(f"{at:.6f} {at + 0.01:.6f} {at - 0.01:.6f}\n" for at in (-300.0, 300.0))
    with Session(joints(table=table), settings(dict(exported().files))) as session:
        session.move(["setp axiscal-vcomp.enable 1", "G53 G0 X10", "G4 P1.2"])
        names = [f"axiscal-vcomp.{name}" for name in ("fault", "fault-code", "gain", "correction-0")]
        assert session.read(names) == (1, 3, 0, 0)


REFUSALS: dict[str, tuple[tuple[str, str], str, str]] = {
    "unit": (("", ""), "in", "the file is in mm, LINEAR_UNITS is inch"),
    "joints": (("joints 4 -1", "joints 4 5"), "mm", "the file has joint 5, JOINTS is 5"),
    "axes": (("axis C z", "axis B z"), "mm", "the file has joint 4 for B, COORDINATES is XYZAC"),
}


@pytest.mark.parametrize("what", REFUSALS)
def test_what_does_not_fit_keeps_linuxcnc_from_starting(what: str) -> None:
    """One sentence says why; what stands in the file itself is tried in test_vcomp_file without a LinuxCNC."""
    change, unit, sentence = REFUSALS[what]
    files = dict(exported().files)
    files["axiscal.vcomp"] = signed(files["axiscal.vcomp"].replace(*change))
    with pytest.raises(ControlError, match=sentence):
        Session(joints(), settings(files, unit=unit))
