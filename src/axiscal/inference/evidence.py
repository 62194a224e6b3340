"""The marginal likelihood of readings: how probable they are under given scales, whatever the errors themselves are.

    2 log p(y | θ) = −yᵀ K⁻¹ y − log |K| − m log 2π,    K(θ) = Σ_f s_f² G_f R_f(ℓ_f) G_fᵀ + r_f² E_f + F D Fᵀ + N

over errors f: G_f the rows of the readings on the control values, R_f their prior correlation, E_f the products of the
levers of readings that share a cell; F, D the set-ups' own unknowns and their variances; N the noise. The unknowns have
wide priors and are integrated out, which makes this the restricted likelihood of Patterson and Thompson (1971).
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import replace

import numpy as np

from axiscal.error_model.model import Term
from axiscal.inference.error_priors import Entry, by_length, prior_of
from axiscal.inference.reading_set import ErrorPart, ReadingSet
from axiscal.inference.scales import Kind, Scale, length_owners
from axiscal.machine.entry import ErrorEntry
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import inverse_of_product, solution
from axiscal.numerics.gaussian import lower_root


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
        self.noise, self._std_stated = numbers.noise, numbers.std_stated
        self._owners = [readings[int(i)].setup for i in numbers.reading]
        self._terms, machine = observation.errors.terms, observation.machine
        entries: list[Entry] = [*machine.errors, *machine.planes]
        self._entries = {entry.name: entry for entry in entries}
        self.functions, self.axes = observation.errors.functions, machine.axes

    def log_density(self, logs: Array) -> tuple[float, Array]:
        """Return log p(y | θ) and its gradient (n,) at the logarithms of the factors (n,)."""
        lower = lower_root(self.covariance(logs))
        inverse = inverse_of_product(lower)
        alpha = inverse @ self.values
        value = -0.5 * float(self.values @ alpha) - float(np.log(np.diag(lower)).sum())
        pull = np.outer(alpha, alpha) - inverse
        return value - 0.5 * len(lower) * float(np.log(2 * np.pi)), self._gradient(pull, logs)

    def log_likelihood(self, logs: Array) -> float:
        """Return log p(y | θ) alone."""
        lower = lower_root(self.covariance(logs))
        half = solution(lower, self.values)
        value = -0.5 * float(half @ half) - float(np.log(np.diag(lower)).sum())
        return value - 0.5 * len(lower) * float(np.log(2 * np.pi))

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
        return other

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
        for term in self._terms:
            result[term.columns, term.columns] = self._prior_of(term, logs)
        return result

    def _factor(self, kind: Kind, owner: str, logs: Array) -> float:
        index = self._index.get((kind, owner))
        return 1.0 if index is None else float(np.exp(logs[index]))

    def _scale(self, kind: Kind, owner: str, stated: float, logs: Array) -> float:
        index = self._index.get((kind, owner))
        return stated if index is None else self.scales[index].stated * float(np.exp(logs[index]))

    def covariance(self, logs: Array) -> Array:
        result: Array = self._fixed + np.diag(self._variances(logs))
        if self._inherited is None:
            result += self._shown @ self._priors(logs) @ self._shown.T
        entries = result.reshape(-1)
        for part, sharing in zip(self._parts, self._sharing, strict=True):
            entry = self._entries[part.term.name]
            entries[sharing.entries] += self._scale("rest", entry.name, entry.first_rest, logs) ** 2 * sharing.values
        return result

    def _priors(self, logs: Array) -> Array:
        """s² R of every error that shows in the readings, along the diagonal."""
        result, start = np.zeros((self._shown.shape[1],) * 2), 0
        for part in self._parts:
            stop = start + part.rows.shape[1]
            result[start:stop, start:stop] = self._prior_of(part.term, logs)
            start = stop
        return result

    def _prior_of(self, term: Term, logs: Array) -> Array:
        """s² R of one error."""
        return prior_of(term, *self._scales_of(term.name, logs))

    def _scales_of(self, name: str, logs: Array) -> tuple[Entry, float, tuple[float, float]]:
        """Return an error's entry, its std, and the factors on its lengths."""
        entry = self._entries[name]
        first, second = (self._factor("length", owner, logs) for owner in length_owners(entry))
        return entry, entry.std * self._factor("std", name, logs), (first, second)

    def _variances(self, logs: Array) -> Array:
        factors = np.array([self._factor("noise", owner, logs) for owner in self._owners])
        variances: Array = self.noise * np.where(self._std_stated, 1.0, factors**2)
        return variances

    def _gradient(self, pull: Array, logs: Array) -> Array:
        """½ Σ pull ∘ ∂K/∂log θ."""
        result = np.zeros(len(self.scales))
        variances = self._variances(logs)
        for (kind, owner), i in self._index.items():
            if kind == "noise":
                mine = np.array([name == owner for name in self._owners]) & ~self._std_stated
                result[i] = float(np.diag(pull)[mine] @ variances[mine])
        pulled, start = pull @ self._shown, 0
        for part, sharing in zip(self._parts, self._sharing, strict=True):
            stop = start + part.rows.shape[1]
            self._add_gradient(part, part.rows.T @ pulled[:, start:stop], logs, result)
            start = stop
            if (at := self._index.get(("rest", part.term.name))) is not None:
                shared = float(pull.reshape(-1)[sharing.entries] @ sharing.values)
                result[at] = self._scale("rest", part.term.name, 0.0, logs) ** 2 * shared
        return result

    def _add_gradient(self, part: ErrorPart, inner: Array, logs: Array, result: Array) -> None:
        """Add what size and length of an error do.  inner : (k, k) Gᵀ pull G"""
        scales = self._scales_of(part.term.name, logs)
        if (i := self._index.get(("std", part.term.name))) is not None:
            result[i] = float(np.sum(prior_of(part.term, *scales) * inner))
        for number, owner in enumerate(dict.fromkeys(length_owners(scales[0]))):
            if (i := self._index.get(("length", owner))) is not None:
                result[i] = 0.5 * float(np.sum(by_length(part.term, *scales, number) * inner))


def _as_smooth(entry: Entry, smoothness: float) -> Entry:
    if isinstance(entry, ErrorEntry) and entry.smoothness_averaged:
        return replace(entry, smoothness=smoothness)
    return entry
