"""The posterior of errors and set-ups' unknowns, sizes averaged over, and whether the readings agree with each other.

    m = Σ w m_θ,    C = Σ w (C_θ + (m_θ − m)(m_θ − m)ᵀ)

The draws differ in how large they make the deviations over the volume, s²_θ = tr G (C_θ + (m_θ − m)(m_θ − m)ᵀ). A
multivariate t whose variance varies as much has degrees of freedom (as GUM G.4 has them of a standard uncertainty)

    f = 4 + 2 (Σ w s²_θ)²/Σ w (s²_θ − Σ w s²_θ)²

Bad readings are taken out (`left_out`). One reading alone cannot tell a slip from a detail of the machine. Others at
its place can, if none of those is bad. Where none tell, the answers with it and without it count one half each if
errors of the stated size could be as large:

    m = ½ (m₀ + m₁),    C = ½ (C₀ + C₁) + ¼ (m₀ − m₁)(m₀ − m₁)ᵀ
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from axiscal.estimation.promise.agreement import Agreement, Another, agreement, always_told
from axiscal.estimation.promise.change_point import jumped, likelier
from axiscal.estimation.promise.mistake import SEVERAL, Tried
from axiscal.estimation.promise.slip import Repeats
from axiscal.numerics import Array
from axiscal_core.draws import sized
from axiscal_core.left_out import Judged, LeftOut, taken_out
from axiscal_core.problem import Problem
from axiscal_core.spaces import Given, Sources
from axiscal_core.theta import Kind
from axiscal_core.threads import one_thread
from axiscal_core.unknowns import space_of

_UNSURE = 0.01
"""Probability below which a size is not so small: of what is said never to be reached."""
_DETAIL = 2.0
"""Stated sizes: a detail is no larger, and what is larger is a slip."""
_SAME = 0.9999
"""Cosine of what two readings show of the errors: more is the same place."""
_ALL_ALIKE = 1e-6
"""Of a variance: draws that differ by no more know it."""


_Owned = tuple[Kind, str]


@dataclass(frozen=True, eq=False)
class Posterior:
    """mean (k,), covariance (k, k) : of errors, then set-ups' unknowns, m and rad

    shared : (k, k) the part of the covariance that causes of type B make, which no reading improves
    degrees : of freedom of a t of that covariance
    cells : means of the rests of visited cells by (term, cell), m or rad
    sizes : exp θ by kind and owner, of lengths the geometric mean, of others the root mean square
    effective : number of draws
    bad : readings that were taken out, in this order, by index; agreement : of the others
    left_out : of each reading that stayed; draws : of which it is the mean
    """

    mean: Array
    covariance: Array
    shared: Array
    degrees: float
    cells: dict[tuple[int, int], float]
    sizes: dict[tuple[Kind, str], float]
    effective: float
    bad: dict[int, LeftOut]
    agreement: Agreement
    left_out: dict[int, LeftOut]
    draws: tuple[Drawn, ...]

    def degrees_over(self, figures: Array) -> float:
        """Return the degrees of freedom of a t whose mean square varies as that of figures (m, k) of the unknowns."""
        found, count = list[tuple[float, float]](), figures.shape[1]
        for weight, given in (each for drawn in self.draws for each in drawn.every()):
            mean, covariance = given.posterior()
            apart = figures @ (mean - self.mean)[:count]
            found.append((weight, float(np.vdot(figures @ covariance[:count, :count], figures) + apart @ apart)))
        return _degrees(*np.array(found).T)


@dataclass(frozen=True, eq=False)
class Drawn:
    """Readings with the draws of the sizes that they teach.  thetas : (n, k); weights : (n,)"""

    problem: Problem
    thetas: Array
    weights: Array

    def every(self) -> Iterator[tuple[float, Given]]:
        """Yield the weight of each draw and everything at its sizes: kept it would be gigabytes."""
        space = space_of(self.problem)
        for weight, theta in zip(self.weights.tolist(), self.thetas, strict=True):
            if (given := space.given(theta)) is not None:
                yield weight, given

    @property
    def surely(self) -> float:
        """The lower 1 % quantile of a size of errors over its root mean square, the least of all; 1 for none."""
        shares, weights = [1.0], self.weights / self.weights.sum()
        for size, thetas in zip(self.problem.sizes.of, self.thetas.T, strict=True):
            if size.kind == "std":
                rising = np.argsort(thetas)
                least = thetas[rising][np.searchsorted(np.cumsum(weights[rising]), _UNSURE)]
                shares.append(float(np.exp(least) / np.sqrt(weights @ np.exp(2 * thetas))))
        return min(shares)

    def without_readings(self) -> Array:
        """Return the covariance of the answered unknowns without readings, the mean over the draws, m² and rad²."""
        alone = np.eye(self.problem.answered + len(self.problem.scales))
        roots = ([curves.roots(theta) for curves in self.problem.curves] for theta in self.thetas)
        each = (self.problem.raw(alone, *sizes) for sizes in zip(self.thetas, roots, strict=True))
        return np.asarray(sum(weight * root @ root.T for weight, root in zip(self.weights, each, strict=True)))

    def sources(self, figures: Array) -> Sources:
        """Return what each source leaves of figures in the mean over the draws.

        figures : F (k, answered), of the answered unknowns
        """
        found = [[weight * each for each in given.sources(figures)] for weight, given in self.every()]
        return Sources(*(np.sum(each, axis=0) for each in zip(*found, strict=True)))


@dataclass(frozen=True, eq=False)
class Sorted:
    """Readings of a problem without the bad ones; then with those that may be details of the machine: each counts alike

    sizes, bad : as of a posterior; sure : are not taken out
    jumps : that readings tell, which nobody has accepted
    """

    problem: Problem
    judged: tuple[Judged, ...]
    sizes: dict[_Owned, float]
    bad: dict[int, LeftOut]
    sure: frozenset[int] = frozenset()
    jumps: tuple[Tried, ...] = ()

    @one_thread()
    def where(self, problem: Problem) -> Sorted:
        """Return the same readings, sorted alike, as another problem has them: linear elsewhere, or as normal ones."""

        def again(judged: Judged) -> Judged:
            apart = np.setdiff1d(problem.reading, judged.problem.reading).tolist()
            return Judged.of(problem, apart, judged.found.drawn)

        return replace(self, problem=problem, judged=tuple(again(each) for each in self.judged))

    @one_thread()
    def posterior(
        self,
        turned: Iterable[Another] = (),
        framed: Iterable[Another] = (),
        repeated: Iterable[Repeats] = (),
        volume: Array | None = None,
    ) -> Posterior:
        """Return the posterior.

        turned, framed : as for `agreement`; repeated : what may be stuck
        volume : G (e, e) of errors z, where zᵀG z is the mean square of the deviation over the volume
        """
        judged, mine, found, left = self.judged, self.judged[0].problem, self.judged[0].found, self.judged[0].left
        over = np.zeros((0, 0)) if volume is None else volume
        mean, covariance, shared, degrees, cells = _moments(judged, over)
        kept = np.isin(self.problem.reading, [*left])
        z = np.array([each.z for each in left.values()])
        out = len(np.unique(self.problem.reading)) - len(left)
        every = (self.problem, sized(self.problem)) if out >= SEVERAL else None
        others, frames = (((wrong, other.only(kept)) for wrong, other in each) for each in (turned, framed))
        told = always_told(mine, found, self.problem, repeated, None if self.jumps else self.sure) if left else ()
        agreed = agreement(mine, found, z, out, every, (*self.jumps, *told), frames, others)
        known = dict(zip(self.problem.cells, cells.tolist(), strict=True))
        of_sizes = self.sizes, found.effective
        drawn = tuple(Drawn(each.problem, each.found.thetas, each.found.weights / len(judged)) for each in judged)
        return Posterior(mean, covariance, shared, degrees, known, *of_sizes, self.bad, agreed, left, drawn)


@one_thread()
def sorted_out(problem: Problem, never: Iterable[int] = (), sure: Iterable[int] = ()) -> Sorted:
    """Return readings without the bad ones; all of them where zeros jumped, until somebody accepts that.

    never : are not used, unless zeros jumped; sure : are not taken out
    """
    apart, accepted = [*never], frozenset(sure)
    first = Judged.of(problem, apart)
    bad, mine = taken_out(first, accepted)
    for among, found in dict.fromkeys([(problem, None if apart else first.found), (mine.problem, mine.found)]):
        if (moved := jumped(among, found, accepted)) is not None:
            _, beside = taken_out(Judged(moved.problem, moved.found), accepted)
            if jumps := likelier(moved, (beside.problem, beside.found), (mine.problem, mine.found)):
                every, bad = Judged(among, moved.without), {i: bad[i] for i in bad if i not in among.reading}
                return Sorted(problem, (every,), every.sizes, bad, accepted, jumps)
    details = [i for i, each in bad.items() if _may_be_a_detail(problem, i, each)]
    details = [i for i in details if not _told_again(problem, i, [*mine.left], [*bad])]
    if not details:
        return Sorted(problem, (mine,), mine.sizes, bad, accepted)
    others = [i for i in bad if i not in details]
    both = mine, Judged.of(problem, [*apart, *others]) if others else first
    pairs = {key: np.array([size, both[1].sizes[key]]) for key, size in mine.sizes.items()}
    sizes = {
        key: float(np.sqrt(np.prod(each) if key[0] == "length" else np.mean(each**2))) for key, each in pairs.items()
    }
    return Sorted(problem, both, sizes, bad, accepted)


def _may_be_a_detail(problem: Problem, index: int, left: LeftOut) -> bool:
    """Return whether errors of the stated size can make a reading that the others contradict."""
    mine, theta = problem.reading == index, np.zeros(len(problem.sizes))
    largest = np.zeros(int(mine.sum()))
    for curves in problem.curves:
        shown = problem.rows[mine][:, curves.columns].transpose(1, 0, 2) @ curves.roots(theta)
        largest += np.sum(shown**2, axis=(0, 2))
    return bool(np.all(left.residual**2 < _DETAIL**2 * largest))


def _told_again(problem: Problem, index: int, kept: Sequence[int], bad: Sequence[int]) -> bool:
    """Return whether kept readings, and no other bad one, show the same of all errors as each number of a bad one."""
    shown = problem.rows[:, problem.first_cell : problem.rows.shape[1] - problem.unknowns]
    sizes, mine = np.linalg.norm(shown, axis=1), problem.reading == index
    alike = np.abs(shown @ shown[mine].T) >= _SAME * np.outer(sizes, sizes[mine])
    others = np.any(alike, axis=1) & np.isin(problem.reading, bad) & ~mine
    return bool(np.all(np.any(alike[np.isin(problem.reading, kept)], axis=0)) and not np.any(others))


def _moments(judged: Sequence[Judged], volume: Array) -> tuple[Array, Array, Array, float, Array]:
    """Return the moments over the draws.

    mean (k,), covariance (k, k), the part of it that is shared, degrees of freedom, means of rests (c,)
    judged : readings whose answers count alike; volume : G of the first unknowns
    """
    weights = np.concatenate([each.found.weights for each in judged]) / len(judged)
    givens = [given for each in judged for given in each.found.given]
    size, counts = judged[0].problem.answered, len(volume)
    means, squares, total = np.empty((len(givens), size)), np.empty(len(givens)), np.zeros((size, size))
    moved = np.hstack([np.sqrt(w) * each.type_b.gains for w, each in zip(weights, givens, strict=True)])
    over = np.zeros_like(total)
    over[:counts, :counts] = volume
    for i, given in enumerate(givens):
        means[i], covariance = given.posterior()
        squares[i] = np.vdot(over, covariance)
        covariance *= weights[i]
        total += covariance
    about = means[0]  # open zeros are large beside what draws differ by
    shift = weights @ (means - about)
    aparts = means - about - shift
    total += (aparts.T * weights) @ aparts
    squares += np.sum((aparts[:, :counts] @ volume) * aparts[:, :counts], axis=1)
    cells = np.sum([w * given.cell_means() for w, given in zip(weights, givens, strict=True)], axis=0)
    return about + shift, total, moved @ moved.T, _degrees(weights, squares), cells


def _degrees(weights: Array, squares: Array) -> float:
    """Return the degrees of freedom of a t whose variance varies as s².  weights, squares : (d,) of draws"""
    mean = float(weights @ squares)
    varied = float(weights @ (squares - mean) ** 2)
    return 4 + 2 * mean**2 / varied if varied > (_ALL_ALIKE * mean) ** 2 else np.inf
