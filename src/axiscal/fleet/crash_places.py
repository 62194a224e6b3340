"""Where a check shows that something broke: readings of a plan moved, each within its set-up, until crashes stand out.

A crash d moves readings by R d. Among machines that changed as is usual they scatter by S = R C Rᵀ + V, so that χ²
grows by δ² = (R d)ᵀ S⁻¹ (R d). Crashes are a location that is off by three of its stated standard deviations, and a
scale that is off by as much at both ends of an axis; around an axis that turns round there is no scale. One reading
after the other goes where the sum of exp(−δ²/12) over the crashes becomes least, twelve being χ² of twelve readings:
what stands out already counts little.
"""

from __future__ import annotations

import numpy as np

from axiscal.error_model.model import ErrorModel, Term
from axiscal.estimation.case import Case
from axiscal.measurement.observation import directions_of
from axiscal.measurement.place import Places
from axiscal.measurement.time_taken import short_way
from axiscal.numerics import Array

_FAR = 3.0
"""Standard deviations as stated that a crash is off: nearer is no crash, and farther shows anyway."""
_USUAL = 12.0
"""χ² of twelve readings of a machine in order: half or twice as much moves readings by little."""
_WORTH = 0.02
"""A reading moves for this much of one crash: where crashes show already it stays where drifts show most."""
_ROUNDS = 4
"""Times that each reading may move; the third hardly moves one."""


def crashes(errors: ErrorModel) -> Array:
    """Return the crashes that are looked for, over the unknowns of the errors, (f, n); none where there are no such."""
    found = list[Array]()
    for term in errors.terms:
        std = _FAR * float(np.sqrt(np.mean(np.diagonal(term.covariance))))
        along = np.zeros(errors.size)
        if term.kind == "location":
            along[term.columns] = std
        elif _is_along(term, errors):
            along[term.columns] = np.linspace(-std, std, term.columns.stop - term.columns.start)
        else:
            continue
        found.append(along)
    return np.array(found).reshape(-1, errors.size)


def _is_along(term: Term, errors: ErrorModel) -> bool:
    """Whether an error is that along an axis with two ends: after a whole turn a scale would be a step."""
    axes = [errors.machine.axes[axis] for axis in term.axes]
    return any(term.name == axis.positioning_error and not axis.cyclic for axis in axes)


def showing_crashes(case: Case, places: Places) -> Places:
    """Return places of a plan moved so that crashes show, in an order that is quickly gone through.

    case : its prior is the machine as it changes as a rule
    """
    looked_for = crashes(case.errors)
    if not len(looked_for) or not len(places):
        return places
    lattice = case.lattice.within(np.isin(case.lattice.setups, places.setups))
    candidates = _CrashRows(case, Places.joined([places, lattice]), looked_for)
    chosen = list(range(len(places)))
    for _ in range(_ROUNDS):
        for turn in range(len(chosen)):
            others = chosen[:turn] + chosen[turn + 1 :]
            losses = candidates.losses(others)
            mine = candidates.places.setups == candidates.places.setups[chosen[turn]]
            best = int(np.argmin(np.where(mine, losses, np.inf)))
            if losses[best] < losses[chosen[turn]] - _WORTH:
                chosen[turn] = best
    return _ordered(case, candidates.places.within(np.array(chosen, dtype=np.intp)))


class _CrashRows:
    """Candidates as rows: what their numbers see of all unknowns, and what each crash does to them."""

    def __init__(self, case: Case, places: Places, looked_for: Array) -> None:
        self.places, self._covariance = places, case.prior.covariance
        size, (crash_count, errors) = len(self._covariance), looked_for.shape
        most = max(len(directions_of(case.description.setups[setup])) for setup in set(places.setups.tolist()))
        self._rows, self._variances = np.zeros((len(places), most, size)), np.ones((len(places), most))
        for setup, mine in places.by_setup():
            for number, seen in enumerate(case.observation.rows_each(setup, *places.of(setup))):
                self._rows[mine, number], self._variances[mine, number] = seen.rows, seen.variances
        self._moved = np.einsum("mkn,fn->mkf", self._rows[:, :, :errors], looked_for)
        self._crashes = crash_count

    def losses(self, others: list[int]) -> Array:
        """Return the sum over the crashes with `others` and each candidate read, (m,); inf for one of these."""
        rows = self._rows[others].reshape(-1, self._rows.shape[2])
        moved = self._moved[others].reshape(-1, self._crashes)
        shown = self._covariance @ rows.T
        scatter = rows @ shown + np.diag(self._variances[others].ravel())
        explained, taken = np.linalg.solve(scatter, moved), np.linalg.solve(scatter, shown.T)
        stand_out = np.sum(moved * explained, axis=0)
        left = self._moved - self._rows @ (shown @ explained)
        seen = self._rows @ (self._covariance - shown @ taken)
        own = np.einsum("mkn,mjn->mkj", seen, self._rows)
        own += self._variances[:, :, None] * np.eye(own.shape[1])
        gains = np.sum(left * np.linalg.solve(own, left), axis=1)
        losses: Array = np.sum(np.exp(-(stand_out + gains) / _USUAL), axis=1)
        losses[others] = np.inf
        return losses


def _ordered(case: Case, places: Places) -> Places:
    """Return places set-up by set-up, each in a short way."""
    machine, setups, parts = case.description.machine, case.description.setups, list[Places]()
    for setup in dict.fromkeys(places.setups.tolist()):
        poses, approaches = places.of(setup)
        order, _ = short_way(machine, setups[setup], poses, approaches)
        parts.append(Places.of_setup(setup, poses[order], approaches[order]))
    return Places.joined(parts)
