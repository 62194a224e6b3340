"""How far the exact chain can be from its first order, for any machine whose errors are not larger than stated.

With Θ = Σ_k (|ε_k| + 2 |tilt_k|), D = Σ_k |δ_k| and L the largest of the |r_k| and of the travels from zero

    |remainder| ≤ (e^Θ − 1 − Θ) L + (e^Θ − 1) D

since every term of the expansion beyond the first order is a product of at least two of these motions. L comes from
intervals: the tool point seen from each axis, a rotary axis turning as far as it likes.
"""

from __future__ import annotations

import math

import numpy as np

from axiscal.errors.model import ErrorModel
from axiscal.errors.volume import Box
from axiscal.machine.description import Machine
from axiscal.machine.kinematics import tool_point
from axiscal.numerics import Array


def linear_to(model: ErrorModel, sizes: Array, box: Box) -> float:
    """Return the bound on the remainder of a TCP deviation, m.

    sizes : (terms,) m or rad, what no term exceeds; box : bounds per axis, m or rad
    """
    displaced, turned, tilted = motion_sizes(model, sizes)
    theta = float(np.sum(np.linalg.norm(turned, axis=1) + 2 * np.linalg.norm(tilted, axis=1)))
    shifts = float(np.sum(np.linalg.norm(displaced, axis=1)))
    return (math.expm1(theta) - theta) * longest_arm(model.machine, box) + math.expm1(theta) * shifts


def motion_sizes(model: ErrorModel, sizes: Array) -> tuple[Array, Array, Array]:
    """Return what no displacement, rotation and tilt of an axis exceeds, (axes, 3) each.  sizes : as above"""
    count = len(model.machine.axes)
    displaced, turned, tilted = (np.zeros((count, 3)) for _ in range(3))
    for term, size in zip(model.terms, sizes.tolist(), strict=True):
        straight = term.kind == "location" and not model.machine.axes[term.axis].rotary
        part = tilted if straight else turned if term.angular else displaced
        part[term.axis, term.component % 3] += size / 2 if term.kind == "reversal" else size
    return displaced, turned, tilted


def longest_arm(machine: Machine, box: Box) -> float:
    """Return a length that no arm from an axis frame to the TCP, and no travel from zero, exceeds in the box, m."""
    low = high = tool_point(machine)
    longest = 0.0
    for axis, (start, stop) in reversed(list(zip(machine.axes, box, strict=True))):
        if axis.rotary:
            origin = np.array(axis.origin)
            low, high = low - origin, high - origin
            longest = max(longest, _farthest(low, high))
            low, high = _turned(low, high, np.array(axis.direction))
            longest = max(longest, _farthest(low, high))
            low, high = low + origin, high + origin
            continue
        longest = max(longest, _farthest(low, high), abs(start), abs(stop))
        ways = np.outer([start, stop], np.array(axis.direction))
        low, high = low + ways.min(axis=0), high + ways.max(axis=0)
        longest = max(longest, _farthest(low, high))
    return longest


def _farthest(low: Array, high: Array) -> float:
    return float(np.linalg.norm(np.maximum(np.abs(low), np.abs(high))))


def _turned(low: Array, high: Array, direction: Array) -> tuple[Array, Array]:
    """Return a box around a box that turns about a direction through the origin."""
    across = _farthest(low, high)
    if np.max(np.abs(direction)) < 1 - 1e-12:
        return np.full(3, -across), np.full(3, across)
    along = np.abs(direction) > 0.5
    across = _farthest(np.where(along, 0.0, low), np.where(along, 0.0, high))
    return np.where(along, low, -across), np.where(along, high, across)
