"""What a promise rests on that somebody stated and no reading shows: a tool's length, where an axis lies, a growth.

A curve is read at many places, and its stated size tested by all of them. A single unknown z is tested by itself alone:
where readings show it only together with another one, what is left of it over the volume,

    e = V c − V C Gᵀ K⁻¹ G c,   c = σ z's column of the prior, of standard deviation one,

is as large as it was stated to be, whatever is read. With E the fields e of all of them (shifts that nobody counts
taken off) and J the variance that the model leaves, the truth of a machine that is just as stated is

    truth² = J − |E|² + |E z|²,   z normal,

and 95 % of them are below Q². Of many unknowns Q is near √J, of a single one it is near 1.96 √J. A promise that one
machine in twenty exceeds by κ = 1.5 or more with nothing to say so is not vouched for: that is Q > κ √J, and of one
unknown the share |E|²/J > (κ² − 1)/(1.96² − 1) = 0.44. (From 0.42 on, (κ² − 1)/(2² − 1), the truth is κ times the
promise as well where the statement is too small by a factor of two.) The least promise that would be vouched for is
Q/κ.

Where scales were learnt, from what was read, nothing was learnt of what was not: a statement stays as large as it was,
r times what the other errors make of it. With S = BᵀK⁻¹B, B = G c, D = diag(r² − 1) the fields are then
E (1 + D S)⁻¹ diag(r), exactly (Sherman, Morrison and Woodbury).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from axiscal.accuracy.damage import KAPPA
from axiscal.accuracy.expanded import reach, within
from axiscal.machine.description import Machine
from axiscal.measurement.instruments.kind import TOOL
from axiscal.measurement.instruments.nest import RADIUS
from axiscal.measurement.observation import Observation
from axiscal.measurement.owners import key_of
from axiscal.numerics import Array

_MOST_OF_IT = 0.5
"""Those are named that make half of it together, and another one is asked for that would take half of it away."""

_APART = frozenset({*TOOL, "growth", "scale", RADIUS})
"""What a tool, an artefact or a temperature is can be measured apart from the machine; where one stands cannot."""


@dataclass(frozen=True, slots=True)
class Statement:
    """A single unknown.

    name : of an error or of an unknown; owner : the set-up, artefact or tool whose unknown it is, "" of an error
    std : as stated, m, rad or of no unit; setup : index of a set-up that has the unknown, None of an error
    """

    name: str
    owner: str
    std: float
    setup: int | None = None


@dataclass(frozen=True, slots=True)
class Resting:
    """What of a promise rests on statements.

    named : those that make most of it; share : of the promised variance that rests on all of them, 0 to 1
    effect : m, RMS over the volume of what that is; hidden : probability that the truth is κ times the promise for it
    bearable : m, the least promise of which that would be no more than 5 %
    shown_by : what would show them if it were measured apart; None where no single unknown would
    """

    named: tuple[Statement, ...]
    share: float
    effect: float
    hidden: float
    bearable: float
    shown_by: Statement | None = None


class LeftOpen(NamedTuple):
    """What readings leave of single unknowns.

    products : (s, s) EᵀE, m²; seen : (s, s) S, what readings tell of them in their own standard deviations
    """

    products: Array
    seen: Array

    def with_stds(self, times: Array) -> LeftOpen:
        """Return the same of unknowns that are so many times as large.  times : (s,)"""
        turned = np.linalg.solve(np.eye(len(times)) + (times**2 - 1.0)[:, None] * self.seen, np.diag(times))
        return LeftOpen(turned.T @ self.products @ turned, np.diag(times) @ self.seen @ turned)


class Single(NamedTuple):
    """One single unknown.

    column : (errors and unknowns,) of the prior, of standard deviation one
    times : how many times as large it was stated as learnt scales make it, 1 where that is less
    """

    statement: Statement
    column: Array
    times: float = 1.0


def singles(observation: Observation, covariance: Array, stated: Machine) -> Iterator[Single]:
    """Yield the single unknowns of errors and set-ups.

    covariance : (size, size) of the errors before the first reading; stated : the machine before scales were learnt
    Of one that an earlier campaign has read as much counts as its readings left as stated, v²/σ² where they left v of
    σ².
    """
    errors, setups = observation.errors, observation.setups
    width, stds = errors.size + len(observation.unknowns), {entry.name: entry.std for entry in stated.errors}
    for each in errors.functions:
        at, std = each.columns.start, float(np.sqrt(each.covariance[0, 0]))
        variance = float(covariance[at, at]) if each.basis.size == 1 else 0.0
        if variance > 0:
            column = np.zeros(width)
            column[: errors.size] = covariance[:, at] * min(1.0, np.sqrt(variance) / std) / np.sqrt(variance)
            yield Single(Statement(each.name, "", stds[each.name]), column, max(1.0, stds[each.name] / std))
    met = set()
    for index, setup in enumerate(setups):
        for unknown, at in zip(setup.unknowns, observation.unknowns_of(index).tolist(), strict=True):
            if unknown.std > 0 and key_of(index, unknown) not in met:
                met.add(key_of(index, unknown))
                column = np.zeros(width)
                column[at] = unknown.std
                yield Single(Statement(unknown.name, unknown.owner or setup.name, unknown.std, index), column)


def resting(found: Sequence[Single], left: LeftOpen, remaining: float, promise: float) -> Resting | None:
    """Return what of a promise rests on statements; None where nothing does.

    remaining : J, what the model leaves of the variance, m²; promise : RMS over the volume, m
    """
    beside = max(remaining - float(np.trace(left.products)), 0.0)
    left = left.with_stds(np.array([each.times for each in found]))
    spectrum = np.maximum(np.linalg.eigvalsh(left.products), 0.0)
    effect = float(spectrum.sum())
    if not effect > 0:
        return None
    spoilt = np.array([max((KAPPA * promise) ** 2 - beside, 0.0)])
    return Resting(
        _most([each.statement for each in found], np.diagonal(left.products)),
        effect / (beside + effect),
        math.sqrt(effect),
        1.0 - float(within(spectrum[None], spoilt)[0]),
        math.sqrt(beside + reach(spectrum[None]) ** 2) / KAPPA,
        _shown_by([each.statement for each in found], left, effect),
    )


def _most(found: Sequence[Statement], variances: Array) -> tuple[Statement, ...]:
    """Return the fewest statements that make half of the variance together, the largest first."""
    order = np.argsort(-variances, kind="stable")
    enough = int(np.searchsorted(np.cumsum(variances[order]), _MOST_OF_IT * variances.sum())) + 1
    return tuple(found[index] for index in order[:enough].tolist())


def _shown_by(found: Sequence[Statement], left: LeftOpen, effect: float) -> Statement | None:
    """Return what can be measured apart whose exact value would take most off the variance, where that is half of it.

    Known exactly, an unknown takes off |V C a|²/(aᵀC a): of its field e, of standard deviation one before, and of the
    share of its variance that is left.
    """
    open_ones = 1.0 - np.diagonal(left.seen)
    gains = np.diagonal(left.products) / np.where(open_ones > 0, open_ones, np.inf)
    gains = np.where([each.name in _APART for each in found], gains, 0.0)
    best = int(np.argmax(gains))
    return found[best] if gains[best] > _MOST_OF_IT * effect else None
