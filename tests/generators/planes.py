"""Machines with errors of two axes, and the plain twin of these: all control values, no basis, nothing cut."""

import numpy as np

from axiscal.machine import machine_from_text
from axiscal.measurement.instruments.displacement import Probe
from axiscal.measurement.setup import Setup, Unknown
from axiscal.numerics import Array
from axiscal_core.machine import Machine
from axiscal_core.splines import NaturalSpline, Spline
from tests.generators.texts import machine_text

BED = machine_text(
    "w-Y'-b-Z-X-t",
    {"X": (0, 300), "Y": (-50, 150), "Z": (0, 100)},
    {
        "EZX": 'std = "60 um", knots = 7, length = "100 mm", rest = "3 um"',
        "EZY": 'std = "50 um", knots = 5, length = "100 mm"',
        "EAX": 'std = "100 urad", knots = 4, length = "100 mm"',
        "EZXY": 'std = "40 um", knots = [6, 5], length = ["70 mm", "40 mm"], rest = "2 um"',
        "EAYZ": 'std = "40 urad", knots = [4, 5], length = "60 mm"',
    },
    tool=40,
)
TABLE = machine_text(
    "w-C'-b-X-Z-t",
    {"X": (0, 300), "Z": (0, 200), "C": (0, 360)},
    {
        "EZX": 'std = "60 um", knots = 7, length = "100 mm"',
        "EXC": 'std = "20 um", knots = 9, length = "60 deg", rest = "1 um"',
        "EXZC": 'std = "8 um", knots = [4, 7], length = ["150 mm", "60 deg"], rest = "1 um"',
        "EBXC": 'std = "20 urad", knots = [4, 7], length = ["150 mm", "60 deg"]',
        "EXX_reversal": "3 um",
    },
    tool=80,
    origins={"C": (40, 0, -100)},
)


def warped(knots: tuple[int, int]) -> str:
    """Return a table of two axes with heights that do not add up.  knots : along X and Y."""
    x, y = knots
    errors = {
        "EZX": f'std = "40 um", knots = {x}, length = "110 mm"',
        "EZY": f'std = "40 um", knots = {y}, length = "80 mm"',
        "EZXY": f'std = "20 um", knots = [{x}, {y}], length = ["110 mm", "80 mm"], rest = "2 um"',
    }
    return machine_text("w-b-X-Y-t", {"X": (0, 300), "Y": (0, 200)}, errors)


def bed() -> Machine:
    """Return a bed of three linear axes, two of its errors of two axes each."""
    return machine_from_text(BED)


def table() -> Machine:
    """Return a machine with a rotary table whose errors change with height."""
    return machine_from_text(TABLE)


def probe(machine: Machine) -> Setup:
    """Return a set-up along z in which every axis moves."""
    park = tuple(sum(axis.travel) / 2 for axis in machine.axes)
    moves = tuple(range(len(machine.axes)))
    raster = (0.0,) * len(moves)
    zero, up = (Unknown("zero", 1e-3),), (0.0, 0.0, 1.0)
    return Probe("probe", machine, up, moves, park, 1e-6, zero, 60, 1, 1, raster, "both")


def poses_of(machine: Machine, count: int) -> Array:
    """Return poses drawn anywhere in the travels, (count, axes)."""
    low, high = np.array([axis.travel for axis in machine.axes]).T
    return np.random.default_rng(0).uniform(low, high, (count, len(low)))


def matern(knots: Array, length: float) -> Array:
    """Return the correlation of a natural spline's control values, written down a second time."""
    far = np.sqrt(5.0) * np.abs(knots[:, None] - knots) / length
    correlation: Array = (1 + far + far**2 / 3) * np.exp(-far)
    return correlation


def centred(matrix: Array) -> Array:
    """Return P R P."""
    flat = np.eye(len(matrix)) - 1.0 / len(matrix)
    return flat @ matrix @ flat


def dense_rows(first: Spline, second: Spline, x: Array, y: Array) -> Array:
    """Return m_x ⊗ m_y over all control values, y fastest, (m, n k)."""
    rows: Array = np.einsum("mi,mj->mij", first.rows(x), second.rows(y)).reshape(len(x), -1)
    return rows


def natural(low: float, high: float, knots: int) -> NaturalSpline:
    """Return a spline on evenly spaced knots."""
    return NaturalSpline(np.linspace(low, high, knots))
