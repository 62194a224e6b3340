"""What candidates gain beside chosen readings, kept up to date while these enter, leave and change places.

A number h has G = h C Vᵀ and K = h C Hᵀ with those that were chosen, P = (H C Hᵀ + R)⁻¹. Of all numbers are kept

    A = P Kᵀ,    U = P G_H,    g = G − AᵀG_H,    D = U gᵀ,    M = h C hᵀ + R − K A,    N = g gᵀ

A candidate gains tr(M⁻¹ N). Without the numbers b of a chosen reading, with E = P_bb⁻¹, it is that of M + A_bᵀ E A_b
and N + A_bᵀ E D_b + D_bᵀ E A_b + A_bᵀ E U_b U_bᵀ E A_b. Each change is a step of Gauss and Jordan, and takes as many
operations as there are numbers, times those that were chosen.
"""

from __future__ import annotations

from copy import copy
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from axiscal_core.from_scipy import take_off
from axiscal_core.model import Numbers
from axiscal_core.refusals import Array
from axiscal_core.state import State, joint_gains

_ALONE = 1e-7  # of the noise of a reading: where its own variance is nearer to the noise, it alone holds an unknown


class _Rows(NamedTuple):
    """Numbers of m readings, the first of each, then the second: what they feel of C and V C, of rests, and noise.

    felt : H R (k m, r); far : G (k m, w); reach, cell : (k m, e) of rests not read before; noise : (k m,) variances
    """

    felt: Array
    far: Array
    reach: Array
    cell: Array
    noise: Array

    @classmethod
    def of(cls, state: State, n: Numbers, each: NDArray[np.intp]) -> _Rows:
        """Return those of readings.  each : (m, k) which of the numbers are theirs, −1 where one has fewer"""
        at = each.T.ravel()
        felt, reach, noise = (state.wide(n) @ state.root)[at], state.unread(n)[at], n.noise[at] ** 2
        felt[at < 0], reach[at < 0], noise[at < 0] = 0.0, 0.0, 1.0
        return cls(felt, felt @ state.weighted.T, reach, n.cell[at], noise)

    def at(self, which: NDArray[np.intp]) -> _Rows:
        """Return some of them."""
        return _Rows(*(part[which] for part in self))


def own_numbers(place: NDArray[np.intp], count: int) -> NDArray[np.intp]:
    """Return which numbers are those of each place, (count, k), −1 where one has fewer.  place : (n,) rising"""
    first, last = (np.searchsorted(place, np.arange(count), side) for side in ("left", "right"))
    at = first[:, None] + np.arange(max((last - first).max(initial=1), 1))
    return np.where(at < last[:, None], at, -1)


class Gains:
    """The gains of candidates beside readings that were chosen, slot by slot.

    state : before the first of them; value : J after them; count : of the candidates; width : numbers of each at most
    above, below : N and M (k, k, count)
    """

    def __init__(self, state: State, n: Numbers, each: NDArray[np.intp]) -> None:
        self.state, self.value, (self.count, self.width) = state, state.value, each.shape
        self._all = _Rows.of(state, n, each)
        self._mine = self._all.at(np.zeros(0, dtype=np.intp))
        self._k, self._p, self._a, self._d = (np.zeros((0, n), dtype=float) for n in (0, 0, each.size, each.size))
        self._u = self._mine.far
        self.below, self.above = self._own(self._all, self.count)

    @property
    def slots(self) -> int:
        """The number of chosen readings."""
        return int(len(self._p) // self.width)

    def fork(self) -> Self:
        """Return a copy that goes its own way."""
        other = copy(self)
        for name in ("_k", "_a", "_d", "_u"):
            setattr(other, name, getattr(self, name).copy())
        other._mine = _Rows(*(part.copy() for part in self._mine))
        return other

    @property
    def gains(self) -> Array:
        """What each candidate gains, (count,)."""
        return _gains(self.above, self.below)

    def enter(self, what: int | Numbers) -> None:
        """Take in a candidate, or a reading anywhere."""
        k, before = self.width, len(self._k)
        self._k = np.pad(self._k, ((0, k), (0, k)))
        self._a, self._d, self._u = (_lengthened(each, k) for each in (self._a, self._d, self._u))
        self._mine = _Rows(*(_lengthened(part, k) for part in self._mine))
        self._fill(slice(before, before + k), what)

    def exchange(self, slot: int, what: int | Numbers) -> None:
        """Put a candidate, or a reading anywhere, where another stands."""
        self._vacate(own := self._slice(slot))
        self._fill(own, what)

    def leave(self, slot: int) -> None:
        """Take a reading out."""
        self._vacate(own := self._slice(slot))
        self._k, self._p = (np.delete(np.delete(each, own, axis=0), own, axis=1) for each in (self._k, self._p))
        self._a, self._d, self._u = (np.delete(each, own, axis=0) for each in (self._a, self._d, self._u))
        self._mine = _Rows(*(np.delete(part, own, axis=0) for part in self._mine))

    def without(self, slot: int) -> tuple[Array, float]:
        """Return the gains (count,) of the candidates were a reading not taken, and that of the reading itself."""
        own = self._slice(slot)
        held, u = np.linalg.inv(self._p[own, own]), self._u[own]
        scaled, d = held @ self._a[own], self._d[own]
        gains = _gains(*self._after(scaled, d + (u @ u.T) @ scaled / 2, self._a[own], 1.0))
        return gains, float(np.sum(held * (u @ u.T)))

    def losses(self) -> Array:
        """Return by how much J would rise were each reading not taken, (slots,)."""
        each, u = self._blocks(), self._u.reshape(self.slots, self.width, self._u.shape[1])
        return np.asarray(np.sum(np.linalg.inv(each) * (u @ u.swapaxes(1, 2)), axis=(1, 2)))

    def held_alone(self, slot: int) -> bool:
        """Whether unknowns would open beyond the digits of a double without a reading of several numbers."""
        own = self._slice(slot)
        std = np.sqrt(self._mine.noise[own])
        return self.width > 1 and bool(np.linalg.eigvalsh(self._p[own, own] * np.outer(std, std))[0] < _ALONE)

    def _blocks(self) -> Array:
        slots, k = self.slots, self.width
        each = self._p.reshape(slots, k, slots, k)[np.arange(slots), :, np.arange(slots)]
        return np.asarray(each)

    def _slice(self, slot: int) -> slice:
        return slice(slot * self.width, (slot + 1) * self.width)

    def _fill(self, own: slice, what: int | Numbers) -> None:
        """Put a reading into an empty slot."""
        if isinstance(what, Numbers):
            numbers = np.arange(self.width)
            new = _Rows.of(self.state, what, np.where(numbers < len(what.rows), numbers, -1)[None])
            self._k[own, own] = np.eye(self.width)
            felt = np.linalg.solve(self._k, k := self._seen(self._mine, new))  # P K would lose what is less than a zero
        else:
            at = what + self.count * np.arange(self.width)
            new, felt = self._all.at(at), self._a[:, at]
            k = self._seen(self._mine, new)
        far = self._mine.far @ new.far.T
        reach, crossed = new.far - felt.T @ self._mine.far, self._seen(new, self._all) - k.T @ self._a
        g = new.far @ self._all.far.T - far.T @ self._a - k.T @ self._d
        fresh = self._seen(new, new) + np.diag(new.noise)
        held, omega = np.linalg.inv(fresh - k.T @ felt), reach @ reach.T
        held = (held + held.T) / 2
        scaled = held @ crossed
        d = held @ (g - omega @ scaled)
        self.above, self.below = self._after(scaled, g - omega @ scaled / 2, crossed, -1.0)
        self.value -= float(np.sum(held * omega))
        take_off(self._d, np.hstack([self._u @ reach.T, felt]), np.concatenate([scaled, d]))
        take_off(self._a, felt, scaled)
        self._u -= felt @ (held @ reach)
        self._a[own], self._d[own], self._u[own] = scaled, d, held @ reach
        self._k[:, own], self._k[own] = k, k.T
        self._k[own, own] = fresh
        p = self._p if len(self._p) == len(self._k) else np.pad(self._p, (0, self.width))
        self._p = p + felt @ held @ felt.T
        self._p[:, own], self._p[own] = -felt @ held, -held @ felt.T
        self._p[own, own] = held
        for mine, part in zip(self._mine, new, strict=True):
            mine[own] = part

    def _vacate(self, own: slice) -> None:
        """Take a reading out of its slot, which stays empty."""
        held, u, a, d = np.linalg.inv(self._p[own, own]), self._u[own], self._a[own], self._d[own]
        omega, scaled = u @ u.T, held @ a
        self.above, self.below = self._after(scaled, d + omega @ scaled / 2, a, 1.0)
        self.value += float(np.sum(held * omega))
        felt = self._p[:, own] @ held
        take_off(self._d, np.hstack([-self._u @ u.T, felt]), np.concatenate([scaled, d + omega @ scaled]))
        take_off(self._a, felt, a)
        self._u -= felt @ u
        self._p = self._p - felt @ self._p[own]
        for each in (self._k, self._k.T, self._a, self._d, self._u, *self._mine):
            each[own] = 0

    def _seen(self, some: _Rows, others: _Rows) -> Array:
        """Return K between numbers, (n, m), of one cell with its rest in common."""
        total = some.felt @ others.felt.T
        columns, terms = some.reach.shape[1], self.state.terms
        for i in np.flatnonzero(some.reach.any(axis=0)).tolist():
            for j in range(i % terms, columns, terms):
                alike = some.cell[:, i, None] == others.cell[:, j]
                total += np.outer(some.reach[:, i], others.reach[:, j]) * alike
        return total

    def _own(self, rows: _Rows, count: int) -> tuple[Array, Array]:
        """Return M and N of readings, (k, k, count) each."""
        felt, far, reach = (part.reshape(self.width, count, part.shape[1]) for part in rows[:3])
        cell, terms = rows.cell.reshape(reach.shape), self.state.terms
        below = np.einsum("imr,jmr->ijm", felt, felt) + np.eye(self.width)[:, :, None] * rows.noise.reshape(-1, count)
        for i in range(reach.shape[2]):
            for j in range(i % terms, reach.shape[2], terms):
                below += reach[:, None, :, i] * reach[:, :, j] * (cell[:, None, :, i] == cell[:, :, j])
        return below, np.einsum("imw,jmw->ijm", far, far)

    def _after(self, scaled: Array, half: Array, crossed: Array, sign: float) -> tuple[Array, Array]:
        """Return N and M after a change.  scaled, half, crossed : (k, k count)"""
        parts = (each.reshape(-1, self.width, self.count) for each in (scaled, half, crossed))
        scaled, half, crossed = parts
        turned, more = (np.einsum("kim,kjm->ijm", sign * scaled, each) for each in (half, crossed))
        return self.above + turned + turned.swapaxes(0, 1), self.below + more


def _lengthened(part: Array, count: int) -> Array:
    """Return an array with so many noughts more along its first side."""
    return np.concatenate([part, np.zeros((count, *part.shape[1:]))])


def _gains(above: Array, below: Array) -> Array:
    """Return the gains (m,).  above, below : N and M, (k, k, m)"""
    return joint_gains(above.transpose(2, 0, 1), below.transpose(2, 0, 1))
