"""The HAL text on a real LinuxCNC: no jump whatever homes when."""

import numpy as np
import pytest

from axiscal.ports.linuxcnc.tables import cross
from axiscal.tables.table import CompensationTable
from tests.linuxcnc.lab import Joint, Session, Settings
from tests.linuxcnc.needed import LONG

pytestmark = LONG

JOINTS = {"X": (0,), "Y": (1,), "Z": (2,)}
SPEEDS = {"X": 0.2, "Y": 0.2, "Z": 0.2}


def bend(axis: str, over: str, size: float) -> CompensationTable:
    """An axis that is off by a parabola over another: nothing at zero, `size` m at 200 mm."""
    at = np.linspace(-0.2, 0.2, 15)
    values = size * (at / 0.2) ** 2
    return CompensationTable(axis, at, values, values, np.full(15, 1e-7), over)


def watched(signals: list[str]) -> str:
    """HAL text that keeps the fastest that signals have moved, mm/s."""
    names = [f"{kind}-{i}" for kind in ("rate", "most") for i in range(len(signals))]
    rates, most = names[: len(signals)], names[len(signals) :]
    lines = [f"loadrt ddt names={','.join(rates)}", f"loadrt minmax names={','.join(most)}"]
    for signal, rate, peak in zip(signals, rates, most, strict=True):
        lines += [f"addf {rate} servo-thread", f"addf {peak} servo-thread", f"net {signal} => {rate}.in"]
        lines.append(f"net {rate}-speed {rate}.out => {peak}.in")
    return "\n".join(lines) + "\n"


def fastest(session: Session, count: int) -> list[float]:
    """The fastest that each watched signal has moved since the last `forget`."""
    ends = session.read([f"most-{i}.{end}" for i in range(count) for end in ("max", "min")])
    return [max(abs(high), abs(low)) for high, low in zip(ends[::2], ends[1::2], strict=True)]


def forget(session: Session, count: int) -> None:
    for value in (1, 0):
        session.move([f"setp most-{i}.reset {value}" for i in range(count)])


def test_a_correction_comes_and_goes_smoothly_with_homing() -> None:
    """X is off by 100 um where Y stands; Y's joint is homed there, and its coordinate becomes zero."""
    table = bend("X", "Y", 1e-4)
    text = cross.write([table, bend("X", "Z", 5e-5)], JOINTS, SPEEDS) + watched(["axiscal-x-correction"])
    limit = cross.fastest([table, bend("X", "Z", 5e-5)], SPEEDS) * 1e3
    joints = [Joint(axis, velocity=200.0, acceleration=2000.0) for axis in "XYZ"]
    with Session(joints, Settings(text)) as session:
        ramped = [session.read(["axiscal-x-correction", "axiscal-gain"]) for _ in range(40)]
        assert all(abs(value) < 1e-9 for value, _ in ramped)  # X is right where Y and Z are zero
        session.move(["G4 P1.1", "G0 Y200"])
        (there,) = session.read(["axiscal-x-correction"])
        assert there == pytest.approx(-0.1, abs=1e-6)
        forget(session, 1)
        session.move(["G0 Y-200", "G0 Y200"])
        assert 0.05 < fastest(session, 1)[0] <= limit  # on the way it follows, no faster than it may
        assert session.read(["axiscal-x-correction"])[0] == pytest.approx(-0.1, abs=1e-6)
        forget(session, 1)
        ending = session.move(["home 1", "G4 P1.5"])[-1]
        assert ending.command[1] == pytest.approx(0, abs=1e-9)
        assert session.read(["axiscal-x-correction"])[0] == pytest.approx(0, abs=1e-9)
        assert 0 < fastest(session, 1)[0] <= limit * 1.0001
        assert session.errors == ()


def test_before_all_joints_are_homed_nothing_is_added_and_then_it_is_ramped() -> None:
    """The curve is 50 um where the machine is switched on, and the DISPLAY program homes at once."""
    at = np.linspace(-0.2, 0.2, 3)
    table = CompensationTable("X", at, np.full(3, 5e-5), np.full(3, 5e-5), np.full(3, 1e-7), "Y")
    text = cross.write([table], JOINTS, SPEEDS) + watched(["axiscal-x-correction"])
    with Session([Joint(axis) for axis in "XYZ"], Settings(text)) as session:
        early = session.read(["axiscal-x-correction"])[0]
        session.move(["G4 P1.2"])
        assert early > -0.049
        assert session.read(["axiscal-x-correction"])[0] == pytest.approx(-0.05, abs=1e-9)
        assert fastest(session, 1)[0] == pytest.approx(0.05 / cross.RAMP, rel=0.01)
