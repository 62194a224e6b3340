"""The marginal likelihood of readings: how probable they are under given scales, whatever the errors themselves are.

    2 log p(y | θ) = −yᵀ K⁻¹ y − log |K| − m log 2π,    K(θ) = Σ_f s_f² G_f R_f(ℓ_f) G_fᵀ + r_f² E_f + F D Fᵀ + N

over errors f: G_f the rows of the readings on the control values, R_f their prior correlation, E_f the products of the
levers of readings that share a cell; F, D the set-ups' own unknowns and their variances; N the noise. The unknowns have
wide priors and are integrated out, which makes this the restricted likelihood of Patterson and Thompson (1971).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from copy import copy
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from axiscal.error_model.model import ErrorFunction
from axiscal.error_model.prior import between_knots
from axiscal.inference.error_priors import Entry
from axiscal.inference.priors_at_once import PriorsAtOnce
from axiscal.inference.reading_set import ErrorPart, ReadingSet
from axiscal.inference.scales import Kind, Scale
from axiscal.machine.entry import ErrorEntry
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import inverse_of_product, solution, sparse_product
from axiscal.numerics.gaussian import lower_root

_STEP = 1e-3
"""Of a logarithm: differences of the exact slope lose below 1e-6 to bending or rounding, ten times off too."""

_LENGTHS = 3
"""Common factors on the lengths that are averaged over (`inference.contradiction`): one product is kept for each."""

_REMEMBERED = 16_000_000
"""Bytes of priors of errors at scales that were asked for: those of all draws of some hundreds of unknowns."""

_ROOTS = 80_000_000
"""Bytes of roots of the covariances of readings, kept for who weighs scales first and then asks what they make known:
those of 96 draws of 300 numbers. What comes after them is found anew.
"""


class _Slopes(NamedTuple):
    """What the scales do to K at some factors.

    noises : (m,) the variances of the numbers; priors : of each error that shows ∂(s² R)/∂log θ by numbers of scales
    rests : of each the square of its rest
    """

    noises: Array
    priors: list[list[tuple[int, Array]]]
    rests: list[float]


class Evidence:
    """The marginal likelihood of readings as a function of the logarithms of the scales' factors.

    observation : the stated model; scales : those that vary; what is not among them stays as stated
    prior : mean and covariance of the errors, where they are not the stated ones; then only noises and rests vary
    noise : (m,) variances as stated; functions : the errors; axes : of the machine
    A reading of three numbers counts as three; m is the count of all numbers, `reading` (m,) the index of its reading.
    """

    def __init__(
        self,
        observation: Observation,
        readings: Sequence[Reading],
        scales: tuple[Scale, ...] = (),
        prior: tuple[Array, Array] | None = None,
    ) -> None:
        self.scales, self._index = scales, {(scale.kind, scale.owner): i for i, scale in enumerate(scales)}
        numbers = ReadingSet(observation, readings)
        self.reading, self.values, self.rows = numbers.reading, numbers.values, numbers.rows
        self._parts, unknowns = numbers.parts(), numbers.unknowns()
        self._sharing = [part.sharing() for part in self._parts]
        self._shown = (
            np.hstack([part.rows for part in self._parts]) if self._parts else np.zeros((len(numbers.values), 0))
        )
        self._fixed = unknowns @ unknowns.T + np.diag(numbers.extra_variance)
        self._stds = np.array([unknown.std for unknown in observation.unknowns])
        self._inherited = None if prior is None else prior[1]
        if prior is not None:
            rows = self.rows[:, : len(prior[0])]
            self.values = self.values - rows @ prior[0]
            self._fixed = self._fixed + rows @ prior[1] @ rows.T
        self.noise = numbers.noise
        owners = np.array([readings[int(i)].setup for i in numbers.reading])
        noises = {scale.owner: i for i, scale in enumerate(scales) if scale.kind == "noise"}
        self._noisy = {i: np.flatnonzero((owners == name) & ~numbers.std_stated) for name, i in noises.items()}
        self._terms, machine = observation.errors.terms, observation.machine
        entries: list[Entry] = [*machine.errors, *machine.planes]
        self._entries = {entry.name: entry for entry in entries}
        self.functions, self.axes = observation.errors.functions, machine.axes
        stds = {owner: i for (kind, owner), i in self._index.items() if kind == "std"}
        self._sizes = [stds[part.term.name] for part in self._parts if part.term.name in stds]
        self._priors_at_once = PriorsAtOnce(self._terms, self._entries, self._index)
        self._forget()

    def _forget(self) -> None:
        """Begin with nothing that is kept for scales that come back."""
        self._of_lengths: dict[bytes, Array] = {}
        self._known: dict[bytes, dict[str, Array]] = {}
        self._roots: dict[bytes, Array] = {}
        self._known_bytes = self._roots_bytes = 0

    def log_density(self, logs: Array) -> tuple[float, Array]:
        """Return log p(y | θ) and its gradient (n,) at the logarithms of the factors (n,)."""
        lower = lower_root(self.covariance(logs))
        inverse = inverse_of_product(lower)
        alpha = inverse @ self.values
        value = -0.5 * float(self.values @ alpha) - float(np.log(np.diag(lower)).sum())
        pull = np.outer(alpha, alpha) - inverse
        return value - 0.5 * len(lower) * float(np.log(2 * np.pi)), self._gradient(pull, self._slopes(logs))

    def curvature(self, logs: Array) -> Array:
        """Return minus the second derivative of log p(y | θ) by the logarithms of the factors, (n, n).

            −∂² log p = −½ tr(P_j K_i) − ½ tr((α αᵀ − K⁻¹) K_ij),    P_j = S_j − S_j y αᵀ − α yᵀ S_j

        with α = K⁻¹ y, S_j = K⁻¹ K_j K⁻¹, and indices for derivatives of K by the logarithm of a factor.
        """
        inverse = inverse_of_product(lower_root(self.covariance(logs)))
        alpha, slopes = inverse @ self.values, self._slopes(logs)
        result = -self._bent(np.outer(alpha, alpha) - inverse, slopes, logs)
        for j, between in self._sandwiched(inverse, slopes):
            moved = np.outer(between @ self.values, alpha)
            result[j] -= self._gradient(between - moved - moved.T, slopes)
        curved: Array = (result + result.T) / 2
        return curved

    def log_likelihood(self, logs: Array) -> float:
        """Return log p(y | θ) alone."""
        lower = self.root(logs)
        half = solution(lower, self.values)
        value = -0.5 * float(half @ half) - float(np.log(np.diag(lower)).sum())
        return value - 0.5 * len(lower) * float(np.log(2 * np.pi))

    def root(self, logs: Array) -> Array:
        """Return L (m, m), lower triangular, with L Lᵀ the covariance of the readings at some scales."""
        key = logs.tobytes()
        if (known := self._roots.get(key)) is not None:
            return known
        found = lower_root(self.covariance(logs))
        if self._roots_bytes + found.nbytes <= _ROOTS:
            self._roots[key] = found
            self._roots_bytes += found.nbytes
        return found

    def chi_square(self) -> float:
        """Return yᵀ K⁻¹ y as stated."""
        half = solution(lower_root(self.covariance(np.zeros(len(self.scales)))), self.values)
        return float(half @ half)

    @property
    def averages(self) -> bool:
        """Whether there are errors whose smoothness is averaged over; not where the prior of errors is inherited."""
        entries = self._entries.values() if self._inherited is None else ()
        return any(isinstance(entry, ErrorEntry) and entry.smoothness_averaged for entry in entries)

    def with_smoothness(self, smoothness: float | None) -> Evidence:
        """Return the evidence with another smoothness of the errors that average over it; None leaves it."""
        other = copy(self)
        if smoothness is not None:
            other._entries = {name: _as_smooth(entry, smoothness) for name, entry in self._entries.items()}
            other._priors_at_once = PriorsAtOnce(other._terms, other._entries, other._index)
            other._forget()
        return other

    def unfollowed(self, function: ErrorFunction, draws: Array) -> Array:
        """Return what the spline of a curve leaves between its knots at some scales, (l,) m or rad; 0 of no curve.

        draws : (l, n) of the logarithms of the factors
        """
        entry, none = self._entries[function.name], np.zeros(len(draws))
        if not isinstance(entry, ErrorEntry) or entry.length is None or function.stated_shape:
            return none
        if function.basis.size == 1:
            return none
        std, factors = (self._factors(kind, function.name, draws) for kind in ("std", "length"))
        spacing = float(np.ptp(function.basis.knots)) / (len(function.basis.knots) - 1)
        left: Array = entry.std * std * between_knots(spacing / (entry.length * factors), entry.smoothness)
        return left

    def _factors(self, kind: Kind, owner: str, draws: Array) -> Array:
        """Return the factor on one scale in each of many draws, (l,)."""
        index = self._index.get((kind, owner))
        return np.ones(len(draws)) if index is None else np.exp(draws[:, index])

    def multiplied(self, factor: float) -> Evidence:
        """Return the evidence of the same readings with all values times a factor."""
        other = copy(self)
        other.values = factor * self.values
        return other

    def prior(self, logs: Array) -> Array:
        """Return the covariance of errors and set-ups' unknowns before the readings, (k, k), in the order of `rows`."""
        result = np.zeros((self.rows.shape[1],) * 2)
        errors = len(result) - len(self._stds)
        unknowns = np.arange(errors, len(result))
        result[unknowns, unknowns] = self._stds**2
        if self._inherited is not None:
            result[:errors, :errors] = self._inherited
            return result
        priors = self._priors_of(logs)
        for term in self._terms:
            result[term.columns, term.columns] = priors[term.name]
        return result

    def _scale(self, kind: Kind, owner: str, stated: float, logs: Array) -> float:
        index = self._index.get((kind, owner))
        return stated if index is None else self.scales[index].stated * float(np.exp(logs[index]))

    def covariance(self, logs: Array) -> Array:
        result: Array = self._fixed + np.diag(self._variances(logs))
        if self._inherited is None:
            result += self._of_errors(logs)
        entries = result.reshape(-1)
        for part, sharing in zip(self._parts, self._sharing, strict=True):
            entries[sharing.entries] += self._rest_square(part, logs) * sharing.values
        return result

    def _of_errors(self, logs: Array) -> Array:
        """Σ_f s_f² G_f R_f G_fᵀ: where all sizes go by one factor the product at these lengths is found once."""
        sizes = logs[self._sizes]
        if not len(sizes) or len(sizes) < len(self._parts) or np.any(sizes != sizes[0]):
            return np.asarray(self._shown @ self._priors(logs) @ self._shown.T)
        others = logs.copy()
        others[self._sizes] = 0.0
        lengths = others[[i for i, scale in enumerate(self.scales) if scale.kind == "length"]].tobytes()
        if lengths not in self._of_lengths:
            if len(self._of_lengths) == _LENGTHS:
                self._of_lengths.clear()
            self._of_lengths[lengths] = self._shown @ self._priors(others) @ self._shown.T
        return np.asarray(np.exp(2 * sizes[0]) * self._of_lengths[lengths])

    def _priors(self, logs: Array) -> Array:
        """s² R of every error that shows in the readings, along the diagonal."""
        result, start, priors = np.zeros((self._shown.shape[1],) * 2), 0, self._priors_of(logs)
        for part in self._parts:
            stop = start + part.rows.shape[1]
            result[start:stop, start:stop] = priors[part.term.name]
            start = stop
        return result

    def _priors_of(self, logs: Array) -> dict[str, Array]:
        """s² R of each error: of a draw of scales it is asked for its weight, and again for what it adds to bands."""
        key = logs.tobytes()
        if (known := self._known.get(key)) is not None:
            return known
        found = self._priors_at_once.at(logs)
        size = sum(each.nbytes for each in found.values())
        self._known_bytes += size
        if self._known_bytes > _REMEMBERED:
            self._known.clear()
            self._known_bytes = size
        self._known[key] = found
        return found

    def _variances(self, logs: Array) -> Array:
        variances = self.noise.copy()
        for i, mine in self._noisy.items():
            variances[mine] *= float(np.exp(logs[i])) ** 2
        return variances

    def _slopes(self, logs: Array) -> _Slopes:
        priors, lengths = self._priors_of(logs), self._priors_at_once.by_length(logs)
        each = [self._moved(part, priors, lengths) for part in self._parts]
        return _Slopes(self._variances(logs), each, [self._rest_square(part, logs) for part in self._parts])

    def _gradient(self, pull: Array, slopes: _Slopes) -> Array:
        """½ Σ pull ∘ ∂K/∂log θ."""
        result, own, each = np.zeros(len(self.scales)), np.diag(pull), pull.reshape(-1)
        for i, mine in self._noisy.items():
            result[i] = float(own[mine] @ slopes.noises[mine])
        for k, (inner, sharing) in enumerate(zip(self._inner(pull), self._sharing, strict=True)):
            for i, slope in slopes.priors[k]:
                result[i] = 0.5 * float(np.sum(slope * inner))
            if (at := self._index.get(("rest", self._parts[k].term.name))) is not None:
                result[at] = slopes.rests[k] * float(each[sharing.entries] @ sharing.values)
        return result

    def _inner(self, pull: Array) -> list[Array]:
        """Return Gᵀ pull G of every error that shows in the readings, each (k, k)."""
        if not self._parts or all(kind in ("rest", "noise") for kind, _ in self._index):
            return [np.zeros((0, 0))] * len(self._parts)
        cuts = np.cumsum([part.rows.shape[1] for part in self._parts])[:-1]
        pulled = np.split(pull @ self._shown, cuts, axis=1)
        return [part.rows.T @ mine for part, mine in zip(self._parts, pulled, strict=True)]

    def _moved(
        self, part: ErrorPart, priors: dict[str, Array], lengths: dict[str, list[tuple[int, Array]]]
    ) -> list[tuple[int, Array]]:
        """Return what size and lengths of an error do to its prior, ∂(s² R)/∂log θ (k, k), by the number of a scale."""
        own = self._index.get(("std", part.term.name))
        size = [] if own is None else [(own, 2 * priors[part.term.name])]
        return [*size, *lengths[part.term.name]]

    def _by_scale(self, part: ErrorPart, logs: Array) -> list[tuple[int, Array]]:
        """Return the same at scales at which no other error is asked for."""
        once, name = self._priors_at_once, part.term.name
        return self._moved(part, {name: once.of(part.term, logs)}, {name: once.of_by_length(part.term, logs)})

    def _rest_square(self, part: ErrorPart, logs: Array) -> float:
        entry = self._entries[part.term.name]
        return self._scale("rest", entry.name, entry.first_rest, logs) ** 2

    def _sandwiched(self, inverse: Array, slopes: _Slopes) -> Iterator[tuple[int, Array]]:
        """Yield K⁻¹ ∂K/∂log θ K⁻¹ (m, m) by the number of each scale."""
        count = len(inverse)
        for i, mine in self._noisy.items():
            yield i, 2 * (inverse[:, mine] * slopes.noises[mine]) @ inverse[mine]
        for k, (part, sharing) in enumerate(zip(self._parts, self._sharing, strict=True)):
            seen = inverse @ part.rows
            for i, slope in slopes.priors[k]:
                yield i, seen @ slope @ seen.T
            if (at := self._index.get(("rest", part.term.name))) is not None:
                row, column = np.divmod(sharing.entries, count)
                first = np.searchsorted(row, np.arange(count + 1))  # E is its own transpose
                shared = sparse_product(sharing.values, column, first, count)(inverse)
                yield at, 2 * slopes.rests[k] * inverse @ shared

    def _bent(self, pull: Array, slopes: _Slopes, logs: Array) -> Array:
        """½ Σ pull ∘ ∂²K/∂log θ ∂log θ: only scales of one error meet, and rests and noises count as their squares."""
        result = np.diag(2 * self._gradient(pull, slopes))
        for part, own, inner in zip(self._parts, slopes.priors, self._inner(pull), strict=True):
            for i, _ in own:
                step = _STEP * (np.arange(len(logs)) == i)
                ends = zip(*(self._by_scale(part, logs + side * step) for side in (1, -1)), strict=True)
                for (j, after), (_, before) in ends:
                    result[i, j] = 0.25 / _STEP * float(np.sum((after - before) * inner))
        return result


def _as_smooth(entry: Entry, smoothness: float) -> Entry:
    if isinstance(entry, ErrorEntry) and entry.smoothness_averaged:
        return replace(entry, smoothness=smoothness)
    return entry
