"""Random machines of any chain, with every error that ISO 230-1 knows, and the kinematics written a second time.

The second writing starts at the bed and goes out to tool and workpiece on separate branches, carriage by carriage in
4 × 4 matrices, straight from docs/conventions.md; it works in complex numbers too, which gives exact derivatives.
"""

from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from axiscal.machine.axis import iso_axis
from axiscal.numerics import Array
from axiscal_core.axes import Axis, Counting
from axiscal_core.errors import COMPONENTS, Error
from axiscal_core.machine import Machine

Matrix = NDArray[Any]
LETTERS = "XYZABC"


def random_machine(seed: int, count: int | None = None, smooth: bool = False) -> Machine:
    """Return a machine of random axes on both sides of the bed; travels of decimetres, rotary axes off centre."""
    rng = np.random.default_rng(seed)
    names = [str(letter) for letter in rng.permutation(list(LETTERS))[: count or rng.integers(1, 6)]]
    bed = int(rng.integers(0, len(names) + 1))
    axes = tuple(_axis(name, place < bed, _counting(name, seed), rng) for place, name in enumerate(names))
    entries = tuple(entry for axis in axes for entry in every_error(axis, rng, smooth))
    return Machine(axes, entries, float(rng.uniform(0, 0.3)), name=f"random {seed}")


def _counting(name: str, seed: int) -> Counting | None:
    """One axis in three counts against ISO 841."""
    return "reversed" if (LETTERS.index(name) + seed) % 3 == 0 else None


def _axis(name: str, workpiece_side: bool, counting: Counting | None, rng: np.random.Generator) -> Axis:
    if name not in "ABC":
        start = rng.uniform(-0.5, 0.1)
        return iso_axis(name, workpiece_side, (start, start + rng.uniform(0.2, 0.8)), counting=counting)
    start, length = rng.uniform(-np.pi, 0), rng.choice([0.7, 2.5, 2 * np.pi])
    origin = tuple(map(float, rng.uniform(-0.3, 0.3, 3)))
    place = (origin[0], origin[1], origin[2])
    return iso_axis(name, workpiece_side, (start, start + float(length)), origin=place, counting=counting)


def every_error(axis: Axis, rng: np.random.Generator, smooth: bool = False) -> list[Error]:
    """Return all six error motions, their reversals, and the location errors of an axis, with a rest here and there."""
    length = axis.length / 3 if smooth else None
    motions = [
        Error(f"E{c}{axis.name}", 1e-5, knots=int(rng.integers(4, 7)), length=length, rest=float(rest))
        for c, rest in zip(COMPONENTS, rng.choice([0.0, 1e-6], 6), strict=True)
    ]
    reversals = [Error(f"E{c}{axis.name}_reversal", 1e-6) for c in COMPONENTS]
    reversals[0] = replace(reversals[0], knots=5, rest=1e-6)
    return motions + reversals + [Error(f"{c}0{axis.name}", 1e-5) for c in COMPONENTS if axis.rotary or c in "ABC"]


def random_poses(machine: Machine, count: int, rng: np.random.Generator) -> tuple[Array, Array]:
    """Return poses within the travel and directions of approach, 0 among them."""
    low, high = np.array([axis.travel for axis in machine.axes]).T
    return rng.uniform(low, high, (count, len(low))), rng.integers(-1, 2, (count, len(low))).astype(float)


def twin_tool(machine: Machine, pose: Array, errors: Matrix) -> Matrix:
    """Return the 4 × 4 pose of the tool in the workpiece frame.

    errors : (q, 9) of every carriage: displacement, rotation, turn of its direction of travel
    """
    tool: Matrix = np.eye(4, dtype=complex)
    workpiece: Matrix = np.eye(4, dtype=complex)
    carriages = list(zip(machine.axes, pose, errors, strict=True))
    for axis, coordinate, error in carriages:
        if not axis.workpiece_side:
            tool = tool @ _carriage(axis, coordinate, error)
    for axis, coordinate, error in reversed(carriages):
        if axis.workpiece_side:
            workpiece = workpiece @ _carriage(axis, -coordinate, error)
    return np.linalg.inv(workpiece) @ tool @ _shift(np.array([0.0, 0.0, -machine.tool_length]))


def _carriage(axis: Axis, motion: float, error: Matrix) -> Matrix:
    """Where a carriage is that has moved by so much: its own frame, then what is mounted on it."""
    strayed = _shift(error[:3]) @ _turn(error[3:6])
    way = -1.0 if axis.counting == "reversed" else 1.0
    along, origin = way * np.eye(3)[LETTERS.index(axis.name[0]) % 3], np.array(axis.origin)
    if axis.rotary:
        turned: Matrix = _shift(origin) @ strayed @ _turn(along * motion) @ _shift(-origin)
        return turned
    travelled: Matrix = _shift(_turn(error[6:])[:3, :3] @ (along * motion)) @ strayed
    return travelled


def _shift(vector: Matrix) -> Matrix:
    result = np.eye(4, dtype=complex)
    result[:3, 3] = vector
    return result


def _turn(vector: Matrix) -> Matrix:
    return _exponential(*map(complex, vector))


@lru_cache(maxsize=1024)
def _exponential(x: complex, y: complex, z: complex) -> Matrix:
    return np.asarray(expm(np.array([[0, -z, y, 0], [z, 0, -x, 0], [-y, x, 0, 0], [0, 0, 0, 0]], dtype=complex)))


def twin_errors(model: Machine, values: Matrix, approach: Array) -> Matrix:
    """Return what every carriage does beside its motion, (q, 9), from the value of every error and its name alone."""
    result = np.zeros((len(model.axes), 9), dtype=complex)
    for function, value in zip(model.curves, values, strict=True):
        bare, location = function.name.removesuffix("_reversal"), "0" in function.name
        k = next(i for i, axis in enumerate(model.axes) if axis.name == bare[2:])
        place = COMPONENTS.index(bare[0 if location else 1])
        straight = location and not model.axes[k].rotary
        result[k, place + 3 * straight] += value * (approach[k] / 2 if bare != function.name else 1)
    return result


def twin_derivative(model: Machine, pose: Array, approach: Array) -> tuple[Array, Array]:
    """Return d(position)/dA and d(rotation)/dA at A = 0 by complex steps, each (3, size)."""
    nominal = twin_tool(model, pose, np.zeros((len(pose), 9)))[:3, :3]
    position, turned = np.empty((3, model.size)), np.empty((3, model.size))
    for i, function in enumerate(model.curves):
        tiny = 1e-30j * np.eye(len(model.curves))[i]
        found = twin_tool(model, pose, twin_errors(model, tiny, approach))
        row = function.spline.rows(pose[function.axis])[0] * 1e30
        spin = (found[:3, :3] @ nominal.T).imag
        position[:, function.columns] = np.outer(found[:3, 3].imag, row)
        turned[:, function.columns] = np.outer([spin[2, 1], spin[0, 2], spin[1, 0]], row)
    return position, turned
