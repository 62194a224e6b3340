"""What stands on the table to be read: balls, and what is not known of where they are.

Ball i is stated at b_i, d_i = b_i − c from the middle c of its artefact. It is off by s + ω × d_i + κ d_i + e_i. These
are place, turn and scale of the whole, and the calibration of each ball. Balls that nobody calibrated stand alone: each
is off by its own place only. What is put down at a, turned by R, has b = a + R b₀ and e = R e₀: in each placement place
and turn are others, b₀ and e₀ the same (reversal, and self-calibration by turning: Evans, Hocken and Estler 1996).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from axiscal.numerics import Array
from axiscal.units import format_quantity
from axiscal_core import rigid

Vector = tuple[float, float, float]
PLACED, TURNED, SCALE, CONE = 1e-3, 1e-3, 0.5e-6, float(np.radians(100.0))


@dataclass(frozen=True, slots=True)
class Ball:
    """A ball by name.  place : m, workpiece frame"""

    name: str
    place: Vector


@dataclass(frozen=True)
class Artefact:
    """Balls that stand together.

    free : unit vector away from the stems; cone : rad, within which of it the tool stays
    keep_out : boxes ((low, high) along x, y, z), m, workpiece frame
    placed : m, std of where a ball, or the whole, stands; turned : rad, std of its turn, of what is calibrated
    calibrated : m, std of each ball's place in the artefact, None where balls stand alone; scale : std of its strain
    mounted : which mounting it is, from 1: another one has another place, and the same calibration
    at, turned_by : m and rad about z, where it was put down, as `put` does
    diameter : of each ball, m; None where nobody says
    """

    name: str
    balls: tuple[Ball, ...]
    free: Vector = (0.0, 0.0, 1.0)
    cone: float = CONE
    keep_out: tuple[tuple[tuple[float, float], ...], ...] = ()
    placed: float = PLACED
    turned: float = TURNED
    calibrated: float | None = None
    scale: float = SCALE
    mounted: int = 1
    at: Vector = (0.0, 0.0, 0.0)
    turned_by: float = 0.0
    diameter: float | None = None

    @cached_property
    def points(self) -> Array:
        """The stated places of the balls, (n, 3) m."""
        return np.array([ball.place for ball in self.balls])

    @cached_property
    def _levers(self) -> Array:
        levers: Array = self.points - self.points.mean(axis=0)
        return levers

    @property
    def standing(self) -> str:
        """What owns its place: the artefact as it is mounted."""
        where = ""
        if any((*self.at, self.turned_by)):
            at = ", ".join(format_quantity(each, "mm", 6) for each in self.at)
            where = f" at {at}, turned {format_quantity(self.turned_by, 'deg', 4)}"
        return self.name + where + ("" if self.mounted == 1 else f", mounting {self.mounted}")

    @cached_property
    def _turned(self) -> Array:
        turned: Array = rigid.turned_about(np.array([0.0, 0.0, 1.0]), np.array([self.turned_by]))[0]
        return turned

    def put(self, at: Vector, turn: float, mounted: int) -> Artefact:
        """Return it put down with its own zero at a place, m, turned about z, rad.  mounted : which mounting it is"""
        put = replace(self, at=at, turned_by=turn, mounted=mounted)
        places = (self.points @ put._turned.T + at).tolist() if self.balls else []
        balls = tuple(Ball(ball.name, (x, y, z)) for ball, (x, y, z) in zip(self.balls, places, strict=True))
        x, y, z = (put._turned @ self.free).tolist()
        return replace(put, balls=balls, free=(x, y, z))

    def nearest(self, points: Array, among: tuple[int, ...]) -> NDArray[np.intp]:
        """Return which of some balls each point (m, 3) is next to, (m,)."""
        apart = np.linalg.norm(points[:, None] - self.points[list(among)], axis=2)
        nearest: NDArray[np.intp] = np.array(among, dtype=np.intp)[apart.argmin(axis=1)]
        return nearest

    def displacements(self, own: Mapping[str, float], balls: NDArray[np.intp]) -> Array:
        """Return where balls are against their stated places, nothing linearised, (m, 3) m."""
        turn = rigid.rotation(np.array([[own.get(f"turn_{axis}", 0.0) for axis in "xyz"]]))[0]
        each = np.array([[own.get(f"{ball.name}_{axis}", 0.0) for axis in "xyz"] for ball in self.balls])[balls]
        levers = self._levers[balls] * (1.0 + own.get("scale", 0.0)) + each @ self._turned.T
        place = np.array([own.get(f"place_{axis}", 0.0) for axis in "xyz"])
        moved: Array = levers @ turn.T - self._levers[balls] + place
        return moved
