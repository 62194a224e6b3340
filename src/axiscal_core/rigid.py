"""Rigid motions T_AB of many poses at once: rotations (m, 3, 3) and translations (m, 3)."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from axiscal_core.refusals import Array


class Motion(NamedTuple):
    """p_A = rotation p_B + translation.  rotation : (m, 3, 3); translation : (m, 3)."""

    rotation: Array
    translation: Array

    def then(self, rotation: Array) -> Motion:
        """Return T_AB T_BC where T_BC turns about the origin of B."""
        return Motion(self.rotation @ rotation, self.translation)

    def shifted(self, vector: Array) -> Motion:
        """Return T_AB T_BC where T_BC shifts by a vector in B.  vector : (m, 3) or (3,)."""
        return Motion(self.rotation, self.apply(vector))

    def apply(self, point: Array) -> Array:
        """Return the points of B in A.  point : (m, 3) or (3,)."""
        turned: Array = np.einsum("mij,...j->mi" if point.ndim == 1 else "mij,mj->mi", self.rotation, point)
        return turned + self.translation


class SmallMotions(NamedTuple):
    """The error motion of each axis frame at each pose, in the axis frame.

    displacement : (q, m, 3) m; rotation : (q, m, 3) rad
    tilt : (q, m, 3) rad, turn of the direction of travel of a linear axis
    """

    displacement: Array
    rotation: Array
    tilt: Array


def identity(count: int) -> Motion:
    """Return `count` motions that move nothing."""
    return Motion(np.broadcast_to(np.eye(3), (count, 3, 3)), np.zeros((count, 3)))


def rotation(vector: Array) -> Array:
    """Return exp([vector]×), the rotation about each vector by its length, analytic (Rodrigues).  vector : (m, 3)"""
    angle = np.sqrt(np.sum(vector * vector, axis=1))[:, None, None]
    cross = skew(vector)
    sinc = np.sinc(angle / np.pi)
    versine = 0.5 * np.sinc(angle / (2 * np.pi)) ** 2
    return np.asarray(np.eye(3) + sinc * cross + versine * (cross @ cross))


def turned(vectors: Array, by: Array) -> Array:
    """Return vectors turned by rotations, exp([by]×) v, analytic.  vectors, by : (m, 3), m and rad"""
    if not by.any():
        return vectors
    return np.asarray((rotation(by) @ vectors[:, :, None])[:, :, 0])


def turned_about(direction: Array, angles: Array) -> Array:
    """Return the rotations about one direction by many angles (Rodrigues).  direction : (3,) unit; angles : (m,) rad"""
    about, twice = _turning(*direction.tolist())
    at = angles[:, None, None]
    return np.eye(3) + np.sin(at) * about + 2 * np.sin(at / 2) ** 2 * twice


@cache
def _turning(x: float, y: float, z: float) -> tuple[Array, Array]:
    """Return [d]× and its square of a direction, each (3, 3)."""
    about = skew(np.array([[x, y, z]]))[0]
    return about, about @ about


def skew(vector: Array) -> Array:
    """Return [vector]×, the matrices of the cross product.  vector : (m, 3)."""
    x, y, z = vector.T
    zero = np.zeros_like(x)
    return np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=1).reshape(-1, 3, 3)


def cross(first: Array, second: Array) -> Array:
    """Return first × second.  Both (..., 3), broadcast against each other; several times as fast as numpy's."""
    a, b, c = first[..., 0], first[..., 1], first[..., 2]
    x, y, z = second[..., 0], second[..., 1], second[..., 2]
    result = np.empty(np.broadcast_shapes(first.shape, second.shape), np.result_type(first, second))
    result[..., 0] = b * z - c * y
    result[..., 1] = c * x - a * z
    result[..., 2] = a * y - b * x
    return result
