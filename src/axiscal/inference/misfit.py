"""Whether the stated priors fit the readings: each scale against the one that the readings make most probable."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.error_model.model import ErrorFunction
from axiscal.inference.evidence import Evidence
from axiscal.inference.fit import drawn, roughly
from axiscal.inference.scales import Kind, Scales, all_scales
from axiscal.machine.entry import GUESSED_REST
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array

FEWEST = 8
"""Fewer readings say nothing about scales."""
_MOST = 120
_CONVINCING = 5.0
"""Twice the log of how much more probable one error's own scales make the readings; three to learn, weak priors."""
_ROUGHER, _OFF = 1.5, 1.8
_NOISE_OFF = 1.5


@dataclass(frozen=True, slots=True)
class Misfit:
    """One error, or one set-up, whose stated scales do not fit.

    kind : "rough" where the curve has detail that the model does not follow, "size" or "noise" where a stated figure is
        off; stated, found : that figure, m or rad
    rest : of the curve, as found, m or rad; detail : it has detail finer than this, m or rad
    knots : that would follow it
    """

    owner: str
    kind: str
    stated: float
    found: float
    rest: float = 0.0
    detail: float = 0.0
    knots: int = 0


def misfits(observation: Observation, readings: Sequence[Reading]) -> tuple[Misfit, ...]:
    """Return what does not fit, the errors first.

    observation : the model that is to be judged, before any cell is visited
    """
    if len(readings) < FEWEST:
        return ()
    sample = drawn(readings, _MOST)
    scales = all_scales(observation.machine, observation.setups)
    evidence = Evidence(observation, sample, scales)
    logs = roughly(evidence, scales)
    found = Scales(scales, tuple(np.exp(logs)))
    judge = _Judge(observation, evidence, found, logs, evidence.log_density(logs)[0])
    return tuple(judge.all())


@dataclass(frozen=True, eq=False, slots=True)
class _Judge:
    """observation : as stated; found, logs, best : the most probable scales and their log likelihood."""

    observation: Observation
    evidence: Evidence
    found: Scales
    logs: Array
    best: float

    def all(self) -> Iterator[Misfit]:
        for function in self.observation.errors.functions:
            misfit = self._error(function)
            if misfit is not None and self._gain(function.name) > _CONVINCING:
                yield misfit
        for setup in self.observation.setups:
            factor = self._factor("noise", setup.name)
            if not 1 / _NOISE_OFF < factor < _NOISE_OFF and self._gain(setup.name) > _CONVINCING:
                yield Misfit(setup.name, "noise", setup.noise, setup.noise * factor)

    def _gain(self, owner: str) -> float:
        """How much less probable the readings are when one owner's scales are as stated, the others as found."""
        logs = np.where([scale.owner == owner for scale in self.found.of], self._as_stated, self.logs)
        return 2.0 * (self.best - self.evidence.log_density(logs)[0])

    @property
    def _as_stated(self) -> Array:
        """The logarithms of the factors that give what is stated; a rest that is not stated is none."""
        rests = {f.name: f.rest for f in self.observation.errors.terms}
        return np.array([-7.0 if s.kind == "rest" and rests[s.owner] == 0 else 0.0 for s in self.found.of])

    def _error(self, function: ErrorFunction) -> Misfit | None:
        std, length = self._factor("std", function.name), self._factor("length", function.name)
        stated = next(entry.std for entry in self.observation.machine.errors if entry.name == function.name)
        if function.basis.size > 1 and not function.stated_shape:
            rest = self.found.value("rest", function.name) or 0.0
            allowed = max(_ROUGHER * function.rest, GUESSED_REST * stated)
            if rest > allowed or length < 1 / _ROUGHER:
                return self._rough(function, rest)
        if not 1 / _OFF < std < _OFF:
            return Misfit(function.name, "size", stated, stated * std)
        return None

    def _rough(self, function: ErrorFunction, rest: float) -> Misfit:
        travel = float(function.basis.knots[-1] - function.basis.knots[0])
        gap = travel / (len(function.basis.knots) - 1)
        length = self.found.value("length", function.name) or 2 * gap
        knots = int(np.ceil(travel / min(gap / 2, length / 2))) + 1
        return Misfit(function.name, "rough", function.rest, rest, rest, max(gap, length / 2), min(knots, 400))

    def _factor(self, kind: Kind, owner: str) -> float:
        value = self.found.value(kind, owner)
        stated = next((s.stated for s in self.found.of if s[:2] == (kind, owner)), None)
        return 1.0 if value is None or stated is None else value / stated
