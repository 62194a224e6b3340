"""grblHAL's plugin, compiled for a host that moves as grblHAL does, against the table as Python applies it."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from axiscal.estimation.machine_estimate import Estimate
from axiscal.numerics import Array
from axiscal.ports.grblhal import GrblHal
from axiscal.tables.exporter import ExportOptions
from tests.generators.machines import random_machine
from tests.tables.core_library import NEEDS_GCC, passed, stated
from tests.tables.test_vcomp_core import drawn

pytestmark = NEEDS_GCC
HERE = Path(__file__).parent
HEADERS = ("grbl/machine_limits.h", "grbl/planner.h", "grbl/kinematics/interface.h")
SEGMENT = 2.0  # mm or deg
ROUNDING = 2e-4  # mm or deg, of a float at a metre, in two places


class Line(NamedTuple):
    """parts : (count, q) of the drives; rates : (count,); checked : (q,) where soft limits looked"""

    parts: Array
    rates: Array
    checked: Array


class Host:
    """A controller with the files of an export in its firmware; its axes are those of the chain, in joint order."""

    def __init__(self, files: Mapping[str, str], folder: Path, axes: int) -> None:
        for header in HEADERS:
            (folder / header).parent.mkdir(parents=True, exist_ok=True)
            (folder / header).touch()
        shutil.copy(HERE / "grblhal_hal.h", folder / "grbl" / "hal.h")
        for name, text in files.items():
            (folder / name).write_text(text)
        words = ["gcc", "-std=gnu11", "-O2", "-Wall", "-Wextra", "-Werror", "-Wno-unused-function", "-shared", "-fPIC"]
        made = folder / "host.so"
        subprocess.run([*words, f"-DN_AXIS={axes}", f"-I{folder}", HERE / "grblhal.c", "-o", made, "-lm"], check=True)
        self._library, self._axes = ctypes.CDLL(str(made)), axes
        self._library.start.restype = ctypes.c_char_p
        self.said = self._library.start(passed(np.full(axes, 1600.0))).decode().strip()

    def go(self, to: Array, rapid: bool = False, inverse: bool = False, cancel_after: int = 0) -> Line:
        """Go to a place of the machine, mm and deg."""
        most = 5000
        parts, rates, checked = np.zeros((most, self._axes)), np.zeros(most), np.zeros(self._axes)
        flags = (ctypes.c_int(each) for each in (rapid, inverse, cancel_after, most))
        count = self._library.go(passed(np.array(to, float)), *flags, *map(passed, (parts, rates, checked)))
        return Line(parts[:count], rates[:count], checked)

    def shown(self) -> Array:
        """Return the position that is shown."""
        place = np.zeros(self._axes)
        self._library.shown(passed(place))
        return place

    def home(
        self, mask: int, travel: float = -300.0, off: float = 0.0, down: bool = False, origin: bool = False
    ) -> int:
        """Home axes; return how many steps the others are sent, which no drive would make.  travel, off : mm or deg"""
        ends = ctypes.c_double(travel), ctypes.c_double(off)
        return int(self._library.home(mask, *ends, ctypes.c_int(down), ctypes.c_int(origin)))

    def passes(self, drives: Array, low: float, high: float) -> bool:
        """Return whether soft limits let a place of the drives pass."""
        return bool(self._library.passes(passed(np.array(drives, float)), ctypes.c_double(low), ctypes.c_double(high)))


class Machined(NamedTuple):
    """A host, what is known in it, and between which places its axes go, (q,), in joint order."""

    host: Host
    known: Estimate
    low: Array
    high: Array

    def drives(self, places: Array, ways: Array) -> Array:
        """Return where the drives are said to be sent, (m, q), of places and sides in joint order."""
        joint, added = in_order(self.known), np.zeros_like(places)
        added[:, joint] = stated(self.known.machine, self.known.mean, places[:, joint], ways[:, joint])
        return places + added


def in_order(estimate: Estimate) -> list[int]:
    """Return the number of the joint of each axis."""
    numbers = ExportOptions().joints(estimate.machine)
    return [numbers[axis.name][0] for axis in estimate.machine.axes]


def machined(estimate: Estimate, folder: Path) -> Machined:
    files = GrblHal().make(estimate, ExportOptions(origin="0" * 64)).files
    joint, ends = in_order(estimate), np.zeros((2, len(estimate.machine.axes)))
    for axis, own in zip(estimate.machine.axes, joint, strict=True):
        ends[:, own] = np.array(axis.travel) * (np.degrees(1.0) if axis.rotary else 1e3)
    return Machined(Host(files, folder, len(joint)), estimate, *ends)


def _spans(seed: int) -> bool:
    """Return whether no rotary axis turns one linear axis towards another."""
    linear = [k for k, axis in enumerate(random_machine(seed).axes) if not axis.rotary]
    return len(linear) == 3 and linear[-1] - linear[0] == 2


SPANNING = [seed for seed in range(100) if _spans(seed)][:4]


@pytest.fixture(params=SPANNING)
def own(request: pytest.FixtureRequest, tmp_path: Path) -> Machined:
    return machined(drawn(request.param, 100e-6)[0], tmp_path)


def test_each_part_of_a_line_ends_where_the_table_says(own: Machined) -> None:
    rng, place, ways = np.random.default_rng(1), np.zeros_like(own.low), np.zeros_like(own.low)
    assert own.host.said == "[KINEMATICS:axiscal 0000000000000000]"
    for number in range(12):
        to = own.low + rng.uniform(0.02, 0.98, len(own.low)) * (own.high - own.low)
        line = own.host.go(to, rapid=number % 3 == 0)
        ways = np.where(np.abs(to - place) > 5e-4, np.sign(to - place), ways)
        count = 1 if number % 3 == 0 else int(np.ceil(np.max(np.abs(to - place)) / SEGMENT - 1e-4))
        assert abs(len(line.parts) - count) <= 1  # the place is known to a float's rounding
        places = to - np.arange(len(line.parts))[::-1, None] * (to - place) / len(line.parts)
        expected = own.drives(places, np.tile(ways, (len(places), 1)))
        assert np.max(np.abs(line.parts - expected)) < 2 * ROUNDING
        assert np.max(np.abs(line.checked - expected[-1])) < 2 * ROUNDING
        assert np.max(np.abs(own.host.shown() - to)) < 1 / 1600 + 2 * ROUNDING
        place = to


def test_a_feed_by_time_is_that_of_each_part_and_a_jog_stops(own: Machined) -> None:
    middle = (own.low + own.high) / 2
    own.host.go(middle, rapid=True)
    far = np.where(np.arange(len(middle)) == 0, middle + 0.2 * (own.high - own.low), middle)
    line = own.host.go(far, inverse=True)
    assert line.rates == pytest.approx(100.0 * len(line.parts), rel=1e-6)
    assert len(own.host.go(middle, cancel_after=3).parts) == 3
    assert own.host.go(middle).rates == pytest.approx(100.0)


def test_homing_forgets_from_where_an_axis_came(own: Machined) -> None:
    middle, nowhere = (own.low + own.high) / 2, np.zeros((1, len(own.low)))
    own.host.go(middle + 1.0)
    from_above = own.host.go(middle).checked
    assert np.max(np.abs(from_above - own.drives(middle[None], nowhere - 1.0)[0])) < 2 * ROUNDING
    own.host.home(2 ** len(middle) - 1)
    shown = own.host.shown()[None]  # where all drives stand at zero
    assert np.max(np.abs(own.drives(shown, nowhere))) < 1 / 1600 + 2 * ROUNDING
    assert np.max(np.abs(own.drives(shown, nowhere - 1.0))) > 1e-3


def test_homing_sends_no_axis_that_stays_and_ends_where_the_firmware_says(own: Machined) -> None:
    """The planner counts each step, but in homing only axes of the cycle make one."""
    middle, others = (own.low + own.high) / 2, slice(1, None)
    own.host.go(middle + 1.0)
    before = own.host.go(middle).parts[-1]
    assert own.host.home(1, off=2.0) == 0
    for down, origin, end in ((False, False, -2.0), (True, False, -298.0), (True, True, 0.0)):
        assert own.host.home(1, -300.0, 2.0, down, origin) == 0
        shown = own.host.shown()
        drives = own.drives(shown[None], np.where(np.arange(len(middle)) == 0, 0.0, -1.0)[None])[0]
        assert drives[0] == pytest.approx(end, abs=1 / 1600 + 2 * ROUNDING)
        assert np.max(np.abs(drives[others] - before[others])) < 2 / 1600 + 2 * ROUNDING


def test_soft_limits_let_drives_pass_up_to_their_ends(own: Machined) -> None:
    drives = np.full(len(own.low), 10.0)
    assert own.host.passes(drives, -20.0, 10.0)
    assert not own.host.passes(drives, -20.0, 9.99)


def test_a_table_that_was_changed_corrects_nothing(tmp_path: Path) -> None:
    files = dict(GrblHal().make(drawn(SPANNING[0])[0], ExportOptions()).files)
    files["axiscal_table.h"] = files["axiscal_table.h"].replace("knot ", "knot 1", 1)
    axes = files["axiscal.vcomp"].count("\naxis ")
    host = Host(files, tmp_path, axes)
    assert host.said.startswith("[KINEMATICS:axiscal OFF: ")
    assert host.go(np.full(axes, 10.0)).parts[-1] == pytest.approx(10.0)
    (tmp_path / "fewer").mkdir()
    whole = GrblHal().make(drawn(SPANNING[0])[0], ExportOptions()).files
    assert Host(whole, tmp_path / "fewer", axes - 1).said == "[KINEMATICS:axiscal OFF: an axis is not built in]"
