"""The best reading on one joint, enclosed by ball arithmetic, without a root finder and without the package.

The spline's equations are written out anew (power form, B&H eq. 2-11) and solved in balls of 400 bits from the floats
taken as exact numbers, so N and D are enclosed polynomials. A branch and bound encloses the largest N/D: an interval is
left out when every Bernstein coefficient of N - u D is certainly negative, which proves N/D < u on it.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import comb

from flint import arb, arb_mat, ctx

from axiscal.numerics import Array

BITS = 400
SLACK = arb("1e-13")
"""The enclosure's relative width: the best gain lies in [lower, lower (1 + slack)]."""


@dataclass(frozen=True)
class Problem:
    """One joint, one reading to choose: gain(t) = mᵀCWCm / (σ² + mᵀCm), with C = F Fᵀ and W = Rᵀ R of exact floats."""

    knots: Array
    cyclic: bool
    factor: Array
    root: Array
    variance: float


@dataclass(frozen=True)
class Certified:
    """The best gain lies in [lower, lower (1 + SLACK)]; every best position in one of `left` intervals (index, s)."""

    lower: arb
    position: tuple[int, arb]
    boxes: int


class GainPolynomials:
    """N and D on every interval as polynomials in s = (t - t_i)/h on [0, 1], coefficients in balls."""

    def __init__(self, problem: Problem) -> None:
        ctx.prec = BITS
        self.knots = [arb(x) for x in problem.knots.tolist()]
        shapes = _power_rows(self.knots, problem.cyclic)
        along = arb_mat(problem.factor.T.tolist()) * shapes
        reach = arb_mat(problem.root.tolist()) * (arb_mat(problem.factor.tolist()) * along)
        self.numerator = _squares(reach)
        self.denominator = _squares(along)
        for series in self.denominator:
            series[0] += arb(problem.variance)

    def gain(self, interval: int, s: arb) -> arb:
        """Return N/D at s of an interval."""
        return _horner(self.numerator[interval], s) / _horner(self.denominator[interval], s)

    def gain_at(self, t: float) -> arb:
        """Return N/D at a position within the knots."""
        i = sum(1 for x in self.knots[1:-1] if x <= arb(t))
        return self.gain(i, (arb(t) - self.knots[i]) / (self.knots[i + 1] - self.knots[i]))


def certified_best_gain(polynomials: GainPolynomials, hint: float | None = None) -> Certified:
    """Enclose the largest gain over all intervals.

    hint : a position to compare with first; it saves time and changes no answer
    """
    best, where = arb(-1), (0, arb(0))
    if hint is not None:
        best = polynomials.gain_at(hint)
    todo = []
    for i, (n, d) in enumerate(zip(polynomials.numerator, polynomials.denominator, strict=True)):
        todo.append((i, arb(0), arb(1), _bernstein(n), _bernstein(d)))
    boxes = 0
    while todo:
        i, low, high, n, d = todo.pop()
        boxes += 1
        for s, ratio in ((low, n[0] / d[0]), (high, n[-1] / d[-1])):
            if ratio > best:
                best, where = ratio, (i, s)
        limit = best * (1 + SLACK)
        if all(a - limit * b < 0 for a, b in zip(n, d, strict=True)):
            continue
        middle = (low + high) / 2
        (n0, n1), (d0, d1) = _halved(n), _halved(d)
        todo += [(i, low, middle, n0, d0), (i, middle, high, n1, d1)]
    return Certified(best, where, boxes)


def _power_rows(t: list[arb], cyclic: bool) -> arb_mat:
    """Return (size, 4 (n - 1)): the control values' weights in a, b h, c h², d h³ of every interval (B&H eq. 2-11)."""
    last = len(t) - 1
    size = last if cyclic else last + 1
    h = [t[i + 1] - t[i] for i in range(last)]
    c = second(h, size, cyclic)
    out = arb_mat(size, 4 * last)
    for i in range(last):
        j = (i + 1) % size
        out[i, 4 * i] = 1
        for k in range(size):
            step = arb((k == j) - (k == i))
            out[k, 4 * i + 1] = step - h[i] ** 2 * (c[j, k] + 2 * c[i, k]) / 3
            out[k, 4 * i + 2] = h[i] ** 2 * c[i, k]
            out[k, 4 * i + 3] = h[i] ** 2 * (c[j, k] - c[i, k]) / 3
    return out


def second(h: list[arb], size: int, cyclic: bool) -> arb_mat:
    """Return (size, size): c at every knot from the control values."""
    system, load = arb_mat(size, size), arb_mat(size, size)
    for i in range(size):
        if not cyclic and i in (0, size - 1):
            system[i, i] = 1
            continue
        before, after, j, k = h[i - 1], h[i], (i - 1) % size, (i + 1) % size
        for column, value in ((j, before), (i, 2 * (before + after)), (k, after)):
            system[i, column] += value
        for column, value in ((j, 3 / before), (i, -3 / before - 3 / after), (k, 3 / after)):
            load[i, column] += value
    return system.solve(load)


def _squares(shapes: arb_mat) -> list[list[arb]]:
    """Return the sum over the rows of their squares, for every block of columns 1, s, s², s³: seven coefficients."""
    series = []
    for i in range(0, shapes.ncols(), 4):
        block = arb_mat([[shapes[r, i + k] for k in range(4)] for r in range(shapes.nrows())])
        gram = block.transpose() * block
        series.append([sum((gram[a, k - a] for a in range(max(0, k - 3), min(3, k) + 1)), arb(0)) for k in range(7)])
    return series


def _horner(series: list[arb], s: arb) -> arb:
    value = arb(0)
    for c in reversed(series):
        value = value * s + c
    return value


def _bernstein(series: list[arb]) -> list[arb]:
    """Return the Bernstein coefficients on [0, 1]: b_j = Σ_k C(j, k)/C(n, k) c_k."""
    n = len(series) - 1
    return [sum((series[k] * comb(j, k) / comb(n, k) for k in range(j + 1)), arb(0)) for j in range(n + 1)]


def _halved(points: list[arb]) -> tuple[list[arb], list[arb]]:
    """Return the Bernstein coefficients on both halves (de Casteljau)."""
    left, right = [], []
    while points:
        left.append(points[0])
        right.append(points[-1])
        points = [(a + b) / 2 for a, b in pairwise(points)]
    return left, right[::-1]
