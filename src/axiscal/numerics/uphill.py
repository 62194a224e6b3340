"""Climbing from given places to where a sum of curves is longest nearby, axis by axis with ever shorter steps."""

from __future__ import annotations

import numpy as np

from axiscal.numerics import Array
from axiscal.numerics.bernstein import BezierCurve, bernstein

_FIRST = 1 / 12
"""Share of the travel of the first step; every sweep halves it."""
_SWEEPS = 10
"""Halvings: to a ten-thousandth of the travel, from where other steps go on."""
_OFFSETS = np.linspace(-1.0, 1.0, 9)
"""Parts of a step that are tried."""


def along(curve: BezierCurve, positions: Array) -> Array:
    """Return a curve at positions (m,): (m, w)."""
    piece = np.clip(np.searchsorted(curve.right, positions), 0, len(curve.right) - 1)
    share = (positions - curve.left[piece]) / (curve.right[piece] - curve.left[piece])
    values: Array = np.einsum("mk,mkw->mw", bernstein(curve.control.shape[1] - 1, share), curve.control[piece])
    return values


def uphill(fixed: Array, curves: list[BezierCurve], places: Array) -> Array:
    """Return where |fixed + Σ curves|² is largest near each place.  fixed : (w,); places : (m, q)."""
    places = places.copy()
    steps = [_FIRST * (curve.right[-1] - curve.left[0]) for curve in curves]
    for sweep in range(_SWEEPS):
        for k, (curve, step) in enumerate(zip(curves, steps, strict=True)):
            others = [along(c, places[:, m]) for m, c in enumerate(curves) if m != k]
            rest = np.sum([np.tile(fixed, (len(places), 1)), *others], axis=0)
            tried = np.clip(places[:, k, None] + _OFFSETS * step / 2**sweep, curve.left[0], curve.right[-1])
            seen = rest[:, None] + along(curve, tried.ravel()).reshape(*tried.shape, -1)
            best = np.einsum("mtw,mtw->mt", seen, seen).argmax(axis=1)
            places[:, k] = tried[np.arange(len(tried)), best]
    return places
