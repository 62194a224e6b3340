"""Kinematics of their own for tests: homogeneous matrices of a chain, link by link, and nothing of the program's."""

from collections.abc import Iterable, Sequence
from typing import Protocol

import numpy as np

from axiscal.numerics import Array


class Joint(Protocol):
    """What of an axis counts here: the program's own, or one read from the text of a machine."""

    @property
    def name(self) -> str: ...
    @property
    def rotary(self) -> bool: ...
    @property
    def travel(self) -> tuple[float, float]: ...
    @property
    def overrun(self) -> float: ...
    @property
    def origin(self) -> tuple[float, float, float]: ...
    @property
    def counting(self) -> str | None: ...


class Nose(Protocol):
    """What is round the tool, m."""

    @property
    def radius(self) -> float: ...
    @property
    def stylus(self) -> float: ...
    @property
    def reach(self) -> float: ...
    @property
    def head(self) -> tuple[float, ...]: ...


class Chain(Protocol):
    """What of a machine counts here."""

    @property
    def axes(self) -> Sequence[Joint]: ...
    @property
    def tool_length(self) -> float: ...
    @property
    def nose(self) -> Nose: ...
    def index(self, axis_name: str, /) -> int: ...
    def axis(self, name: str, /) -> Joint: ...


def shifted(vector: Array) -> Array:
    """Return the matrix of a shift, (4, 4)."""
    result = np.eye(4)
    result[:3, 3] = vector
    return result


def turned(letter: str, angle: float) -> Array:
    """Return the matrix of a turn about x, y or z for A, B or C, (4, 4)."""
    c, s, result = np.cos(angle), np.sin(angle), np.eye(4)
    first, second = {"A": (1, 2), "B": (2, 0), "C": (0, 1)}[letter]
    result[first, first] = result[second, second] = c
    result[first, second], result[second, first] = -s, s
    return result


def tool_matrix(machine: Chain, pose: Array) -> Array:
    """Return where the tool is in the workpiece frame, (4, 4): third column from tip to spindle, last one the tip."""
    result = np.eye(4)
    for axis, shown in zip(machine.axes, pose, strict=True):
        letter, at = axis.name[0], -shown if axis.counting == "reversed" else shown
        if axis.rotary:
            about = np.array(axis.origin)
            result = result @ shifted(about) @ turned(letter, at) @ shifted(-about)
        else:
            result = result @ shifted(at * np.eye(3)["XYZUVWPQR".index(letter) % 3])
    return result @ shifted(np.array([0.0, 0.0, -machine.tool_length]))


def tip(machine: Chain, pose: Array) -> Array:
    """Return the tool point in the workpiece frame, (3,) m."""
    return np.asarray(tool_matrix(machine, pose)[:3, 3], dtype=np.float64)


def stem(machine: Chain, pose: Array) -> Array:
    """Return the direction from the tip to the spindle, (3,)."""
    return np.asarray(tool_matrix(machine, pose)[:3, 2], dtype=np.float64)


def first_met(begin: Array, end: Array, balls: Iterable[Array], radius: float) -> float | None:
    """Return after which share of a straight way a sphere about one of some places is met; None where none is."""
    ahead, shares = end - begin, list[float]()
    for ball in balls:
        a, b, c = ahead @ ahead, 2 * (begin - ball) @ ahead, (begin - ball) @ (begin - ball) - radius**2
        if a > 0 and b * b >= 4 * a * c and 0 <= (share := float((-b - np.sqrt(b * b - 4 * a * c)) / (2 * a))) <= 1:
            shares.append(share)
    return min(shares, default=None)


def in_travel(machine: Chain, pose: Array, slack: float = 1e-9) -> bool:
    """Whether every axis is within its travel."""
    return all(
        axis.travel[0] - slack <= at <= axis.travel[1] + slack for axis, at in zip(machine.axes, pose, strict=True)
    )


def pose_with_tip(machine: Chain, pose: Array, point: Array) -> Array:
    """Return the pose with the linear axes where the tool point is at a place, by differences of the matrices."""
    slides = [k for k, axis in enumerate(machine.axes) if not axis.rotary]
    base = tip(machine, pose)
    ways = np.stack([tip(machine, pose + np.eye(len(pose))[k]) - base for k in slides], axis=1)
    moved = pose.copy()
    moved[slides] += np.linalg.lstsq(ways, point - base, rcond=None)[0]
    return moved
