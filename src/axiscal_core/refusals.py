"""Every failure of this package: one class, which names the function, the argument and, where there is one, the pose.

>>> whole("Case.plan", "readings", 2.5, least=1)
Traceback (most recent call last):
axiscal_core.refusals.InputError: Case.plan: readings = 2.5 is no whole number. Give 1 or more.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""Numbers in m, rad and s. What `Instrument.sees` is given is complex while rows are found."""


class InputError(ValueError):
    """An argument that makes no sense.

    function, argument : where; pose : index of the pose, None where none is meant
    """

    def __init__(self, function: str, argument: str, what: str, remedy: str, pose: int | None = None) -> None:
        self.function, self.argument, self.pose = function, argument, pose
        at = "" if pose is None else f", pose {pose}"
        super().__init__(f"{function}: {argument}{at} {what}. {remedy}.")


def whole(function: str, argument: str, value: object, least: int) -> int:
    """Return a whole number that is not below `least`."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        raise InputError(function, argument, f"= {value!r} is no whole number", f"Give {least} or more")
    if value < least:
        raise InputError(function, argument, f"= {value} is below {least}", f"Give {least} or more")
    return int(value)


def one_of(function: str, argument: str, value: str, known: Sequence[str]) -> str:
    """Return a word that is known."""
    if value not in known:
        raise InputError(function, argument, f"= {value!r} is unknown", f"Known are {', '.join(known)}")
    return value


def within(function: str, argument: str, value: float, least: float, open_end: bool = False) -> float:
    """Return a number that is finite and not below `least`; above it where the end is open."""
    if not math.isfinite(value) or value < least or (open_end and value == least):
        bound = f"above {least:g}" if open_end else f"{least:g} or more"
        raise InputError(function, argument, f"= {value:g} makes no sense", f"Give {bound}")
    return value


def finite(function: str, argument: str, values: object, shape: tuple[int | None, ...]) -> Array:
    """Return finite numbers as an array of a shape; None is any length.  Lists are as good as arrays."""
    wanted = (
        "(" + ", ".join("m" if each is None else str(each) for each in shape) + ("," if len(shape) == 1 else "") + ")"
    )
    try:
        result = np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(function, argument, "is no array of numbers", f"Give numbers of shape {wanted}") from None
    fits = result.ndim == len(shape) and all(n in (None, m) for n, m in zip(shape, result.shape, strict=True))
    if not fits:
        raise InputError(function, argument, f"has the shape {result.shape}", f"Give {wanted}")
    if not np.isfinite(result).all():
        where = int(np.argwhere(~np.isfinite(result))[0, 0])
        raise InputError(function, argument, "holds a value that is no number", "Give finite numbers", where)
    return result
