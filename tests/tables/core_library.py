"""The component's core compiled as a library: what LinuxCNC's realtime thread runs, called from tests."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from axiscal import tables
from axiscal.numerics import Array
from axiscal.tables.vcomp_file import whole_control
from axiscal_core.machine import Machine

HERE = Path(__file__).parent
SOURCES = Path(tables.__file__).parent
NEEDS_GCC = pytest.mark.skipif(shutil.which("gcc") is None, reason="needs Debian's gcc")


class Core:
    """The library; arrays in, arrays out."""

    def __init__(self, folder: Path) -> None:
        made = folder / "core.so"
        words = ["gcc", "-std=gnu99", "-O2", "-Wall", "-Wextra", "-Werror", "-Wno-unused-function", "-shared", "-fPIC"]
        subprocess.run([*words, f"-I{SOURCES}", HERE / "vcomp_core.c", "-o", made, "-lm"], check=True)
        self._library = ctypes.CDLL(str(made))
        self._library.load.restype = ctypes.c_char_p

    def load(self, data: bytes) -> tuple[str | None, int]:
        """Return why a file is refused, None where it is not, and its line."""
        line = ctypes.c_int()
        why = self._library.load(data, len(data), ctypes.byref(line))
        return (None if why is None else why.decode()), line.value

    def correct(self, joints: Array, ways: Array, tool: Array, once: bool = False) -> tuple[Array, Any, Any]:
        """Return what is added (m, q), faults (m,) and bits of axes beyond their knots (m,)."""
        out, count = np.zeros(joints.shape), len(joints)
        fault, outside = np.zeros(count, np.intc), np.zeros(count, np.intc)
        self._library.correct(count, *map(passed, (joints, ways, tool)), int(once), *map(passed, (out, fault, outside)))
        return out, fault, outside

    def sides(self, at: Array, band: float, seconds: float, period: float, powered: Array | None = None) -> Array:
        """Return the side of an axis at each position.  powered : whether drives are on there"""
        out, on = np.zeros(len(at)), np.ones(len(at)) if powered is None else powered
        numbers = (ctypes.c_double(each) for each in (band, seconds, period))
        self._library.sides(len(at), passed(at), passed(on), *numbers, passed(out))
        return out

    def gains(self, targets: Array, length: float, period: float) -> Array:
        """Return the gain at each step."""
        out = np.zeros(len(targets))
        self._library.gains(
            len(targets), passed(targets), ctypes.c_double(length), ctypes.c_double(period), passed(out)
        )
        return out


def passed(values: Any) -> Any:
    kept = values if values.flags.c_contiguous else np.ascontiguousarray(values)
    assert kept is values, "give arrays row by row"
    return ctypes.c_void_p(kept.ctypes.data)


def stated(machine: Machine, mean: Array, joints: Array, ways: Array) -> Array:
    """Return what is said to be added to the joints of each axis, (m, q) mm or deg.  mean : control values of errors"""
    units = np.array([np.radians(1.0) if axis.rotary else 1e-3 for axis in machine.axes])
    return np.asarray(whole_control(machine, mean)(joints * units, ways) / units)
