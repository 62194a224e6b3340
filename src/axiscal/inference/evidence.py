"""The marginal likelihood of readings: how probable they are under given scales, whatever the errors themselves are.

    2 log p(y | θ) = −yᵀ K⁻¹ y − log |K| − m log 2π,    K(θ) = Σ_f s_f² G_f R_f(ℓ_f) G_fᵀ + r_f² E_f + F D Fᵀ + N

over errors f: G_f the rows of the readings on the control values, R_f their prior correlation, E_f the products of the
levers of readings that share a cell; F, D the set-ups' own unknowns and their variances; N the noise. The unknowns have
wide priors and are integrated out, which makes this the restricted likelihood of Patterson and Thompson (1971).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.error_model.model import ErrorFunction
from axiscal.error_model.prior import distances, matern52, matern52_by_length
from axiscal.inference.scales import Kind, Scale
from axiscal.measurement.observation import Observation, directions_of
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array


@dataclass(frozen=True, eq=False, slots=True)
class _Part:
    """What one error does to the readings.

    rows : (m, k) G; distances : (k, k) of its control values
    first, second : pairs of readings that share a cell; products : of their levers
    """

    function: ErrorFunction
    rows: Array
    distances: Array
    first: NDArray[np.intp]
    second: NDArray[np.intp]
    products: Array

    def correlation(self, length: float | None) -> Array:
        """R (k, k)."""
        if length is None:
            return np.eye(self.rows.shape[1])
        return matern52(self.distances / length)

    def by_length(self, length: float) -> Array:
        """∂R/∂log ℓ (k, k)."""
        return matern52_by_length(self.distances / length)

    def sharing(self, matrix: Array) -> float:
        """Σ of a matrix (m, m) over E."""
        return float(matrix[self.first, self.second] @ self.products)


class Evidence:
    """The marginal likelihood of readings as a function of the logarithms of the scales' factors.

    observation : the stated model; scales : those that vary; what is not among them stays as stated
    A reading of three numbers counts as three; m is the count of all numbers, `reading` (m,) the index of its reading.
    """

    def __init__(self, observation: Observation, readings: Sequence[Reading], scales: tuple[Scale, ...] = ()) -> None:
        self.scales, self._index = scales, {(scale.kind, scale.owner): i for i, scale in enumerate(scales)}
        seen = _Seen(observation, readings)
        self.reading, self.values, self.rows = seen.reading, seen.values, seen.rows
        self._parts, self._fixed = seen.parts(), seen.unknowns()
        self._noise, self._own_noise = seen.noise()
        self._owners = [readings[int(i)].setup for i in seen.reading]
        self._entries = {entry.name: entry for entry in observation.errors.machine.errors}

    def log_density(self, logs: Array) -> tuple[float, Array]:
        """Return log p(y | θ) and its gradient (n,) at the logarithms of the factors (n,)."""
        covariance = self._covariance(logs)
        lower = np.linalg.cholesky(covariance)
        inverse = np.linalg.inv(covariance)
        alpha = inverse @ self.values
        value = -0.5 * float(self.values @ alpha) - float(np.log(np.diag(lower)).sum())
        pull = np.outer(alpha, alpha) - (inverse + inverse.T) / 2
        return value - 0.5 * len(lower) * float(np.log(2 * np.pi)), self._gradient(pull, logs)

    def covariance(self) -> Array:
        """Return K (m, m) as stated."""
        return self._covariance(np.zeros(len(self.scales)))

    def covariance_under(self, prior: Array) -> Array:
        """Return K with another prior covariance (size, size) of the errors, (m, m)."""
        size, plain = len(prior), self._fixed + np.diag(self._noise)
        for part in self._parts:
            rest = self._entries[part.function.name].first_rest
            plain[part.first, part.second] += rest**2 * part.products
        result: Array = plain + self.rows[:, :size] @ prior @ self.rows[:, :size].T
        return result

    def noise(self) -> Array:
        """Return the noise variances as stated, (m,)."""
        return self._noise

    def _factor(self, kind: Kind, owner: str, logs: Array) -> float:
        index = self._index.get((kind, owner))
        return 1.0 if index is None else float(np.exp(logs[index]))

    def _scale(self, kind: Kind, owner: str, stated: float, logs: Array) -> float:
        index = self._index.get((kind, owner))
        return stated if index is None else self.scales[index].stated * float(np.exp(logs[index]))

    def _length(self, name: str, logs: Array) -> float | None:
        stated = self._entries[name].length
        return None if stated is None else stated * self._factor("length", name, logs)

    def _covariance(self, logs: Array) -> Array:
        result: Array = self._fixed + np.diag(self._variances(logs))
        for part in self._parts:
            entry = self._entries[part.function.name]
            std = entry.std * self._factor("std", entry.name, logs)
            correlation = part.correlation(self._length(entry.name, logs)) if len(part.rows.T) > 1 else np.ones((1, 1))
            result += std**2 * (part.rows @ correlation @ part.rows.T)
            rest = self._scale("rest", entry.name, entry.first_rest, logs)
            if rest > 0:
                result[part.first, part.second] += rest**2 * part.products  # each pair is there once
        return result

    def _variances(self, logs: Array) -> Array:
        factors = np.array([self._factor("noise", owner, logs) for owner in self._owners])
        variances: Array = self._noise * np.where(self._own_noise, 1.0, factors**2)
        return variances

    def _gradient(self, pull: Array, logs: Array) -> Array:
        """½ Σ pull ∘ ∂K/∂log θ."""
        result = np.zeros(len(self.scales))
        variances = self._variances(logs)
        for (kind, owner), i in self._index.items():
            if kind == "noise":
                mine = np.array([name == owner for name in self._owners]) & ~self._own_noise
                result[i] = float(np.diag(pull)[mine] @ variances[mine])
        for part in self._parts:
            self._add_gradient(part, pull, logs, result)
        return result

    def _add_gradient(self, part: _Part, pull: Array, logs: Array, result: Array) -> None:
        entry = self._entries[part.function.name]
        std = entry.std * self._factor("std", entry.name, logs)
        inner = part.rows.T @ pull @ part.rows
        length = self._length(entry.name, logs) if len(part.rows.T) > 1 else None
        if (i := self._index.get(("std", entry.name))) is not None:
            result[i] = std**2 * float(np.sum(part.correlation(length) * inner))
        if length is not None and (i := self._index.get(("length", entry.name))) is not None:
            result[i] = 0.5 * std**2 * float(np.sum(part.by_length(length) * inner))
        if (i := self._index.get(("rest", entry.name))) is not None:
            result[i] = self._scale("rest", entry.name, 0.0, logs) ** 2 * part.sharing(pull)


class _Seen:
    """All numbers of all readings: rows (m, size) over the unknowns, effects of errors (functions, m), values (m,)."""

    def __init__(self, observation: Observation, readings: Sequence[Reading]) -> None:
        self._observation, self._readings = observation, readings
        counts = np.array([len(reading.values) for reading in readings])
        self.reading = np.repeat(np.arange(len(readings)), counts)
        self._first = np.cumsum(counts) - counts
        size = len(self.reading)
        self.values, self.rows = np.zeros(size), np.zeros((size, observation.size))
        self._effects = np.zeros((len(observation.errors.functions), size))
        self._rests = np.array([function.rest for function in observation.errors.functions])[:, None]
        self._loose = np.zeros(size)  # what else widens a reading, such as a side that nobody told
        for index in range(len(observation.setups)):
            self._fill(index)

    def _fill(self, index: int) -> None:
        """Fill in the numbers of one set-up."""
        setup = self._observation.setups[index]
        mine = [i for i, reading in enumerate(self._readings) if reading.setup == setup.name]
        if not mine:
            return
        poses = np.array([self._readings[i].pose for i in mine])
        approaches = np.array([self._readings[i].approach for i in mine], dtype=float)
        for number, direction in enumerate(directions_of(setup)):
            at = self._first[mine] + number
            seen = self._observation.rows(index, poses, approaches, direction)
            effects = self._observation.effects(index, poses, approaches, direction)
            self.rows[at], self._effects[:, at] = seen.rows, effects
            self._loose[at] = seen.variances - setup.noise**2 - np.sum((self._rests * effects) ** 2, axis=0)
            self.values[at] = [self._readings[i].values[number] for i in mine]
            self.values[at] -= self._observation.beyond(index, poses)

    def parts(self) -> list[_Part]:
        """Return what each error does to the numbers, without those that none of them depends on."""
        poses = np.array([self._readings[int(i)].pose for i in self.reading])
        result = []
        for function, effect in zip(self._observation.errors.functions, self._effects, strict=True):
            if np.any(effect):
                cells = function.cells(poses[:, function.axis])
                felt = effect[:, None] * effect[None, :]
                first, second = np.nonzero((cells[:, None] == cells[None, :]) & (felt != 0))
                rows, apart = self.rows[:, function.columns], distances(function.basis)
                result.append(_Part(function, rows, apart, first, second, felt[first, second]))
        return result

    def unknowns(self) -> Array:
        """Return F D Fᵀ, and on its diagonal what else widens a reading, (m, m)."""
        start = self._observation.errors.size
        variances = np.array([unknown.std**2 for setup in self._observation.setups for unknown in setup.unknowns])
        rows = self.rows[:, start : start + len(variances)]
        product: Array = (rows * variances) @ rows.T + np.diag(np.maximum(self._loose, 0.0))
        return product

    def noise(self) -> tuple[Array, NDArray[np.bool_]]:
        """Return the noise variances (m,), and whether a reading states its own standard deviation."""
        usual = {setup.name: setup.noise for setup in self._observation.setups}
        each = [(usual[r.setup] if r.std is None else r.std) ** 2 for r in self._readings]
        own = np.array([r.std is not None for r in self._readings], dtype=bool)
        return np.array(each)[self.reading], own[self.reading]
