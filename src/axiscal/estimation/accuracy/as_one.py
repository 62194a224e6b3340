"""What of the unseen acts on the whole volume as one: a common scale of X, Y and Z, and how the part lies.

Unseen deviations at poses p are X = H F. They split along S = p − p̄, a uniform strain, and along the turns −(p − p̄)×.
Both are orthogonal to each other and to shifts, since S·(ω × S) = 0.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from axiscal.errors.gauge import Hidden
from axiscal.estimation.accuracy.yardstick import Yardstick
from axiscal.language.spoken import said
from axiscal.machine.kinematics import frames
from axiscal.numerics import Array, rigid
from axiscal.numerics.spread import even_points
from axiscal.units import said_quantity

_POSES = 500
"""The share of a strain or turn is then known to a few percent."""
_SAID = 0.3
"""Share of what cannot be seen from which it is said by itself."""
_LEAST = 1e-8
"""m; less is rounding."""


def seen_as_one(yardstick: Yardstick) -> Iterator[Hidden]:
    """Yield what the unseen is as a whole, where it is a good part of it: the common scale, and how the part lies."""
    unseen = yardstick.unseen_rms
    if not all(yardstick.counted):
        return
    if unseen < _LEAST or len({axis.letter for axis in yardstick.errors.machine.axes} & set("XYZ")) < 3:
        return
    scale, turn = uniform_parts(yardstick)
    if scale > _SAID * unseen:
        text = (
            "Your instruments cannot see the common scale of X, Y and Z: a bar of known length, or a laser, shows it. "
            "It makes {size} of the {whole} that cannot be seen."
        )
        yield Hidden(("EXX", "EYY", "EZZ"), said(text, **_part(scale, unseen)), scale)
    if turn > _SAID * unseen and yardstick.alignment is None:
        text = (
            "Your instruments cannot see how the part lies: it is aligned by probing, which aligned = true takes off. "
            "It makes {size} of the {whole} that cannot be seen."
        )
        yield Hidden((), said(text, **_part(turn, unseen)), turn)


def uniform_parts(yardstick: Yardstick) -> tuple[float, float]:
    """Return what a common scale and a turn of the whole make of the unseen, RMS over the volume, m."""
    poses = _places(yardstick)
    machine, sides = yardstick.errors.machine, np.zeros_like(poses)
    rows = yardstick.errors.rows(poses, sides)
    if yardstick.alignment is not None:
        rows = rows - yardstick.alignment.taken_off(poses)
    hidden = rows.reshape(-1, yardstick.errors.size) @ yardstick.unseen
    away = frames(machine, poses).tcp
    away = away - away.mean(axis=0)
    turned = np.asarray(-rigid.skew(away), dtype=np.float64).reshape(-1, 3)
    return _rms(away.reshape(-1, 1), hidden), _rms(turned, hidden)


def _rms(shape: Array, hidden: Array) -> float:
    """Return the RMS of what of hidden (3 m, r) is of a shape (3 m, k), m."""
    basis = np.linalg.qr(shape).Q
    return float(np.sqrt(3 * np.sum((basis.T @ hidden) ** 2) / len(shape)))


def _places(yardstick: Yardstick) -> Array:
    if yardstick.sample is not None:
        return yardstick.sample[:_POSES]
    low, high = np.array(yardstick.box).T
    poses: Array = low + (high - low) * even_points(_POSES, len(low))
    return poses


def _part(size: float, whole: float) -> dict[str, str]:
    return {"size": said_quantity(size, "um", 2), "whole": said_quantity(whole, "um", 2)}
