"""Every failure of this package: one class, which names the function, the argument and, where there is one, the pose.

>>> whole("Case.plan", "readings", 2.5, least=1)
Traceback (most recent call last):
axiscal_core.refusals.InputError: Case.plan: readings = 2.5 is no whole number. Give 1 or more.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from axiscal_core.threads import hold_loaded_libraries

hold_loaded_libraries()  # those of numpy: a command opens its door before numpy is there
Array = NDArray[np.float64]
"""Numbers in m, rad and s. What `Instrument.sees` is given is complex while rows are found."""
Given = TypeVar("Given")
LARGEST = 1e100  # its square still is a number
_DEFECTS = ArithmeticError, AssertionError, AttributeError, LookupError, NameError, RuntimeError, TypeError, ValueError


class InputError(ValueError):
    """An argument that makes no sense.

    function, argument : where; pose : index of the pose, None where none is meant
    """

    def __init__(self, function: str, argument: str, what: str, remedy: str, pose: int | None = None) -> None:
        self.function, self.argument, self.pose = function, argument, pose
        at = "" if pose is None else f", pose {pose}"
        super().__init__(f"{function}: {argument}{at} {what}. {remedy}.")


def whole(function: str, argument: str, value: object, least: int) -> int:
    """Return a whole number that is not below `least`, and not beyond what any memory holds."""
    is_whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
    if not is_whole or not least <= cast("int", value) <= 1e8:
        what = f"is not from {least} to 1e8" if is_whole else "is no whole number"
        raise InputError(function, argument, f"= {value!r} {what}", f"Give {least} or more")
    return int(cast("int", value))


def one_of(function: str, argument: str, value: str, known: Sequence[str]) -> str:
    """Return a word that is known."""
    if not isinstance(value, str) or value not in known:
        raise InputError(function, argument, f"= {value!r} is unknown", f"Known are {', '.join(known)}")
    return value


def named(function: str, argument: str, value: object) -> str:
    """Return a name."""
    if not isinstance(value, str) or not value:
        raise InputError(function, argument, f"= {value!r} is no name", "Give a text that is not empty")
    return value


def each_once(function: str, argument: str, names: Sequence[str]) -> None:
    """Refuse a name that is there twice."""
    for name in names:
        if [*names].count(name) > 1:
            raise InputError(function, argument, f"hold {name!r} twice", "Give each its own name")


def listed(function: str, argument: str, value: Sequence[Given]) -> Sequence[Given]:
    """Return a list, or a tuple, of one or more."""
    if isinstance(value, str) or not isinstance(value, Sequence) or not value:
        raise InputError(function, argument, f"= {value!r} is no list", "Give a list of one or more")
    return value


def one(function: str, argument: str, value: Given, kind: type[Any] | tuple[type[Any], ...], remedy: str) -> Given:
    """Return what is of a class.  remedy : how such a one is made"""
    if not isinstance(value, kind):
        raise InputError(function, argument, f"= {value!r} is none", f"Give {remedy}")
    return value


def computed(function: str, argument: str, of: Callable[..., Given], *given: object) -> Given:
    """Return what a function of somebody's own gives; whatever goes wrong in it is its defect, said as such."""
    try:
        return of(*given)
    except InputError:
        raise
    except _DEFECTS as fault:
        what = f"cannot be computed ({type(fault).__name__}: {fault})"
        raise InputError(function, argument, what, "Repair the function") from fault


def within(function: str, argument: str, value: float, least: float, open_end: bool = False) -> float:
    """Return a number that is finite and not below `least`; above it where the end is open."""
    if not math.isfinite(value) or value < least or (open_end and value == least):
        bound = f"above {least:g}" if open_end else f"{least:g} or more"
        raise InputError(function, argument, f"= {value:g} makes no sense", f"Give {bound}")
    return value


def finite(function: str, argument: str, values: object, shape: tuple[int | None, ...], posed: bool = False) -> Array:
    """Return finite numbers as an array of a shape; None is any length.  posed : the first index is of poses"""
    sides = tuple(name if each is None else each for name, each in zip("mnk", shape, strict=False))
    wanted = str(sides).replace("'", "")
    try:
        given = np.asarray(values)
        numeric = given.dtype.kind in "iufOU" and not np.ma.is_masked(values)
        result = np.array(given if numeric else "none", dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(function, argument, "is no array of numbers", f"Give numbers of shape {wanted}") from None
    fits = result.ndim == len(shape) and all(n in (None, m) for n, m in zip(shape, result.shape, strict=True))
    if not fits:
        raise InputError(function, argument, f"has the shape {result.shape}", f"Give {wanted}")
    if len(wrong := np.argwhere(~(np.abs(result) < LARGEST))):
        where = wrong[0].tolist()
        what = f"holds {result[tuple(where)]} at {where}"
        raise InputError(function, argument, what, f"Give numbers below {LARGEST:g}", where[0] if posed else None)
    return result


def sided(function: str, sides: object, shape: tuple[int, ...]) -> Array:
    """Return from where axes come, (m, q)."""
    found = finite(function, "sides", sides, shape, posed=True)
    for i in np.flatnonzero(~np.isin(found, (-1, 0, 1)).all(axis=1)).tolist():
        raise InputError(function, "sides", f"are {found[i]}", "Give +1, -1 or 0 for each axis", i)
    return found


def spread(function: str, argument: str, values: object, size: int | None, front: tuple[int, ...] = ()) -> Array:
    """Return a covariance, (size, size), or several.  front : how many stand side by side"""
    result = finite(function, argument, values, (*front, size, size))
    scale = np.abs(result).max(axis=(-2, -1), initial=0.0, keepdims=True)
    square = result.shape[-2] == result.shape[-1] > 0
    if not square or not _positive(result / np.where(scale > 0, scale, 1.0)):
        remedy = "Give a matrix that is symmetric and has no variance below zero"
        raise InputError(function, argument, "is none", remedy)
    return result


def _positive(matrices: Array) -> bool:
    """Return whether these are symmetric and none has an eigenvalue below zero, to rounding.  (..., n, n)"""
    below = np.diagonal(matrices, axis1=-2, axis2=-1) < 0
    if below.any() or not np.allclose(matrices, matrices.swapaxes(-1, -2), atol=1e-12):
        return False
    try:
        np.linalg.cholesky(matrices + 1e-9 * np.eye(matrices.shape[-1]))
    except np.linalg.LinAlgError:
        return False
    return True
