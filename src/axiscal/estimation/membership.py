"""Rival beliefs on whether a machine is like its sisters, and their mixture, which the result reports.

Each belief is as probable as it foretells the readings. Bad readings, noise and rests are judged by the widest
of them: to a narrow one that is wrong every reading stands off. The planner works for the likeliest.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from axiscal.estimation.belief import Belief
from axiscal.estimation.case import Case, Rival
from axiscal.estimation.data_equation import data_equation, moments_of, shares_of
from axiscal.estimation.judged import Doubt
from axiscal.estimation.learnt import without_bad
from axiscal.estimation.located import Absorbed, absorbed, displayed
from axiscal.estimation.promise.problem import Inherited
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array

_GONE = 1e-9
"""A belief that is less probable than this moves no digit."""


@dataclass(frozen=True, eq=False, slots=True)
class Membership:
    """rivals : the beliefs; shares : (k,) how probable each is after the readings; count : of the readings

    belief : the mixture of all of them, by its moments
    """

    rivals: tuple[Rival, ...]
    shares: Array
    count: int
    belief: Belief

    @property
    def likeliest(self) -> int:
        """Index of the belief that holds the most."""
        return int(np.argmax(self.shares))

    @property
    def sister(self) -> float:
        """How probable it is that the machine is like its sisters: by the first two beliefs."""
        return float(self.shares[:2].sum())


def membership(
    stated: Case, known: Absorbed, readings: Sequence[Reading], implausible: Mapping[int, Doubt]
) -> Membership:
    """Return how probable each rival of a case is.

    known : what readings make known by one of them; readings : all, with their times
    """
    cases = [replace(known.case, inherited=rival.belief) for rival in stated.rivals]
    shares = shares_of_rivals(stated.rivals, stated.sides[-1].linear_as(known.case), readings, implausible)
    counts = [index for index, share in enumerate(shares) if share > _GONE]
    after = (absorbed(cases[k], readings, known.left_out, known.among) for k in counts)
    beliefs = [displayed(each).belief for each in after]
    parts = [Inherited(belief.mean, belief.covariance) for belief in beliefs]
    mixed = moments_of(parts, shares[counts] / shares[counts].sum())
    return Membership(stated.rivals, shares, len(readings), Belief(mixed.mean, mixed.covariance))


def shares_of_rivals(
    rivals: Sequence[Rival], widest: Case, readings: Sequence[Reading], implausible: Mapping[int, Doubt]
) -> Array:
    """Return how probable each rival is after readings, (k,).

    widest : the case by which readings are judged, and noise and rests learnt, with the sizes as stated
    """
    each = np.array([rival.weight for rival in rivals])
    before: Array = each / each.sum()
    if not readings:
        return before
    found = without_bad(widest, readings, implausible)
    counts = [index for index in range(len(readings)) if index not in found.bad and index not in implausible]
    if not counts:
        return before
    data = data_equation(widest.rescaled(found.sizes).observation, [readings[index] for index in counts])
    return shares_of(data, [rival.belief for rival in rivals], before)
