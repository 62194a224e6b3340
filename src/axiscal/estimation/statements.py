"""What a promise rests on that somebody stated and no reading shows: a tool's length, where an axis lies, a growth.

A curve is read at many places, and its stated size tested by all of them. A single unknown z is tested by itself alone:
where readings show it only together with another one, what is left of it over the volume,

    e = V c − V C Gᵀ K⁻¹ G c,   c = σ z's column of the prior, of standard deviation one,

is as large as it was stated to be, whatever is read. Let E be the fields e of all of them, M the covariance of what
else is left (constant shifts taken off), J the variance that the model leaves and b what of it is neither. The truth of
a machine that is just as stated is

    truth² = b + |m + E z|²,   m ~ N(0, M), z normal,   b = J − tr M − |E|²,

and were the unknowns known exactly it would be b + |m|². With κ = 1.5 the share of machines that statements spoil is

    hidden = P(truth > κ promise) − P(b + |m|² > κ² promise²).

A promise that so more than one machine in fifty exceeds with nothing to say so is not vouched for. Of many unknowns the
truth is near √J; of a single one, that makes a share ρ of J beside what hardly varies, one in fifty is above
√(J (1 + ρ (2.33² − 1))), which is κ times the promise from ρ = (κ² − 1)/(2.33² − 1) = 0.28 on. What varies as well
takes less to get there: both count together. The least promise of which no more are spoilt is what could be vouched
for. What noise leaves of an unknown that readings do tell is no statement: E is what was stated, not what was read.

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
from axiscal.accuracy.expanded import within_one
from axiscal.machine.description import Machine
from axiscal.measurement.instruments.kind import TOOL
from axiscal.measurement.instruments.nest import RADIUS
from axiscal.measurement.observation import Observation
from axiscal.measurement.owners import key_of
from axiscal.numerics import Array

SPOILT = 0.02
"""Of machines that are just as stated one in fifty may be much worse than promised for what was stated."""
_FARTHEST = 2.33
"""Of normal unknowns no more than one machine in fifty is farther off than so many times their RMS, however few."""
_PROMISES = 400
"""Promises that are tried up to there: a step is less than half a percent."""
_MOST_OF_IT = 0.5
"""Those are named that make half of it together, and others are asked for that would take half of it away."""

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
    bearable : m, the least promise of which that would be no more than one in fifty; 0 where it is that of any
    shown_by : what would show them if it were measured apart; empty where nothing would
    """

    named: tuple[Statement, ...]
    share: float
    effect: float
    hidden: float
    bearable: float
    shown_by: tuple[Statement, ...] = ()


class LeftOpen(NamedTuple):
    """What readings leave of single unknowns, and of all else.

    fields : (w, s) E over the volume, m; beside : (w, w) M of all else, m²
    seen : (s, s) S, what readings tell of them in their own standard deviations
    """

    fields: Array
    beside: Array
    seen: Array

    def with_stds(self, times: Array) -> LeftOpen:
        """Return the same of unknowns that are so many times as large.  times : (s,)"""
        turned = np.linalg.solve(np.eye(len(times)) + (times**2 - 1.0)[:, None] * self.seen, np.diag(times))
        return LeftOpen(self.fields @ turned, self.beside, np.diag(times) @ self.seen @ turned)


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
    others = float(np.trace(left.beside))
    constant = max(remaining - others - float(np.sum(left.fields**2)), 0.0)
    left = left.with_stds(np.array([each.times for each in found]))
    variances = np.sum(left.fields**2, axis=0)
    effect = float(variances.sum())
    if not effect > 0:
        return None
    total = constant + others + effect
    promises = np.linspace(math.sqrt(constant + others), _FARTHEST * math.sqrt(total), _PROMISES) / KAPPA
    shares = _spoilt(left, constant, np.append(promises, promise))
    return Resting(
        _most([each.statement for each in found], variances),
        effect / total,
        math.sqrt(effect),
        float(shares[-1]),
        _least(promises, shares[:-1]),
        _shown_by([each.statement for each in found], left, effect),
    )


def _spoilt(left: LeftOpen, constant: float, promises: Array) -> Array:
    """Return the shares of machines that are κ times a promise for what was stated.  constant : b, m²"""
    beyond = (KAPPA * promises) ** 2 - constant
    whole = left.beside + left.fields @ left.fields.T
    return np.maximum(within_one(left.beside, beyond) - within_one(whole, beyond), 0.0)


def _least(promises: Array, shares: Array) -> float:
    """Return the promise, m, above which no more are spoilt than may be; 0 where more are of none."""
    above = np.flatnonzero(shares > SPOILT)
    if not len(above):
        return 0.0
    last = int(above[-1])
    if last + 1 == len(promises):
        return float(promises[last])
    low, high = shares[last], shares[last + 1]
    return float(promises[last] + (promises[last + 1] - promises[last]) * (low - SPOILT) / (low - high))


def _most(found: Sequence[Statement], variances: Array) -> tuple[Statement, ...]:
    """Return the fewest statements that make half of the variance together, the largest first."""
    order = np.argsort(-variances, kind="stable")
    enough = int(np.searchsorted(np.cumsum(variances[order]), _MOST_OF_IT * variances.sum())) + 1
    return tuple(found[index] for index in order[:enough].tolist())


def _shown_by(found: Sequence[Statement], left: LeftOpen, effect: float) -> tuple[Statement, ...]:
    """Return the fewest that can be measured apart whose exact values would take half of the variance away, if any do.

    Known exactly, unknowns take off |V C A|²/(Aᵀ C A): of their fields e, of standard deviation one before, and of what
    is left of their covariance.
    """
    apart = np.flatnonzero([each.name in _APART for each in found])
    order = sorted(apart.tolist(), key=lambda index: -_gain(left, [index]))
    for count in range(1, len(order) + 1):
        if _gain(left, order[:count]) > _MOST_OF_IT * effect:
            return tuple(found[index] for index in order[:count])
    return ()


def _gain(left: LeftOpen, known: list[int]) -> float:
    """Return the variance over the volume that exact values of some take off, m²."""
    fields, open_ones = left.fields[:, known], np.eye(len(known)) - left.seen[np.ix_(known, known)]
    return float(np.sum((fields @ np.linalg.pinv(open_ones, hermitian=True)) * fields))
