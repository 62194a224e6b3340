"""A dozen readings that say whether a machine is still as its last campaign left it.

The places are those of a plan with the prior ρ² C + (1 − ρ²) C₀, a machine that has drifted since. They move until
crashes show (`showing_crashes`). The readings z = R a + e have to fit N(ρ m, ·):

    χ² = wᵀw,  w = L⁻¹ (z − ρ R m),  L Lᵀ = R (ρ² C + (1 − ρ²) C₀) Rᵀ + I

A crash d moves w along u = L⁻¹ R d alone: (uᵀw)²/uᵀu is a χ² of one degree of freedom. P is twice the smaller of both
probabilities, that of the likeliest crash times the number of crashes (Bonferroni).

Where a check shows that something broke: readings of a plan moved, each within its set-up, until crashes stand out.

A crash d moves readings by R d. Among machines that changed as is usual they scatter by S = R C Rᵀ + V. So χ² grows by
δ² = (R d)ᵀ S⁻¹ (R d). A crash is a location, or a scale at both ends of an axis, off by three stated standard
deviations. An axis that turns round has no scale. One reading after the other goes where the sum of exp(−δ²/12) over
the crashes becomes least; χ² of twelve readings is 12. A crash that stands out already counts little.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import CampaignDescription
from axiscal.errors.model import ErrorModel
from axiscal.errors.term import Term
from axiscal.estimation.case import Case, timed
from axiscal.estimation.data_equation import data_equation
from axiscal.estimation.promise.problem import Inherited
from axiscal.exceptions import RecordError
from axiscal.measurement.instrument import values_of
from axiscal.measurement.readers.csv_readings import blank_sheet
from axiscal.measurement.reading import Place, Places, Reading
from axiscal.measurement.reading_rows import places_of
from axiscal.measurement.travel import short_way
from axiscal.numerics import Array
from axiscal.numerics.gaussian import lower_root
from axiscal.planning.other_readings import with_rooms
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import proposed
from axiscal.ports.fleet.due_dates import again, case_again
from axiscal.ports.fleet.worn_machine import Wearing, found_by, without_tables
from axiscal.tables.registry import offered_control
from axiscal.tables.surface import Control
from axiscal_core.from_scipy import chi_square_tail, solution
from axiscal_core.threads import one_thread

_FAR = 3.0
"""Standard deviations as stated that a crash is off: nearer is no crash, and farther shows anyway."""
_USUAL = 12.0
"""χ² of twelve readings of a machine in order: half or twice as much moves readings by little."""
_WORTH = 0.02
"""A reading moves for this much of one crash: where crashes show already it stays where drifts show most."""
_ROUNDS = 4
"""Times that each reading may move; the third hardly moves one."""

_UNMOVED = 1e-12
"""No division by nought: no reading sees a crash that moves all of them by a millionth of their noise."""

READINGS = 12
"""A choice: fewer find less (`python -m benchmarks.fleet.checks`)."""
CHANCE = 0.01
"""How often a machine that is in order may be called out of order."""


@dataclass(frozen=True, slots=True)
class Checked:
    """What check readings say.

    chance : how probable readings so far off are if the machine changed as is usual; count : of the numbers
    """

    chance: float
    chi_square: float
    count: int

    @property
    def in_order(self) -> bool:
        """Whether it need not be measured again."""
        return self.chance >= CHANCE


class QuickCheck:
    """The check of one machine.

    kept : share ρ of each error that is as the last campaign found it
    control : what the control adds by the tables that are in it; None where they take all away that was found
    wears : what wears off; None for all that is stated
    """

    def __init__(
        self,
        description: CampaignDescription,
        last: Inherited,
        kept: float,
        control: Control | None = None,
        wears: Wearing | None = None,
    ) -> None:
        wearing = wears or Wearing.as_stated(ErrorModel(description.machine))
        self.last, self.case = last, case_again(description, wearing.left(last, kept))
        self._control = control

    @classmethod
    def from_campaign(cls, campaign: Campaign, kept: float, controller: str | None = None) -> QuickCheck:
        """Return the check of a campaign that has been measured.

        controller : whose tables of it are loaded; None for none, or for such as take all away that was found
        Raises RecordError where it has no readings, TableError where no tables can be made for the control.
        """
        if not campaign.state.readings:
            raise RecordError("The record has no readings", "Name a campaign that has been measured", campaign.path)
        known = campaign.estimate(ended=True)
        control = None if controller is None else offered_control(known, controller)
        return cls(again(known), found_by(known), kept, control, Wearing.from_estimation(known))

    def planned(self, count: int) -> tuple[Place, ...]:
        """Return the places that say most, moved until crashes show; raises PlanError."""
        plan = proposed(self.case, Limits(count)).plan
        return with_rooms(self.case, showing_crashes(self.case, plan.places))

    def sheet(self, places: Sequence[Place]) -> str:
        """Return the places as a file to fill in."""
        setups, axes = self.case.description.setups, self.case.description.machine.axes
        return blank_sheet(setups, axes, places_of(setups, places))

    @one_thread()
    def judged(self, readings: Sequence[Reading], tables: bool = False) -> Checked:
        """Return what readings say.  tables : they were taken with the tables of the last campaign in the control"""
        described = self.case.description
        if tables and self._control is not None:
            readings, tables = without_tables(readings, described.machine, described.setups, self._control), False
        read = timed(self.case, readings).readings
        data = data_equation(self.case.observation, read)
        now = self.case.inherited or self.last
        expected = now.mean - self.last.mean if tables else now.mean
        lower = lower_root(data.rows @ now.covariance @ data.rows.T + np.eye(len(data.values)))
        off = solution(lower, data.values - data.rows @ expected)
        looked_for = crashes(self.case.errors)
        moved = solution(lower, data.rows[:, : looked_for.shape[1]] @ looked_for.T)
        squares = (off @ moved) ** 2 / np.maximum(np.sum(moved**2, axis=0), _UNMOVED)
        broken = len(squares) * chi_square_tail(1, float(np.max(squares, initial=0.0)))
        chance = chi_square_tail(len(off), float(off @ off))
        return Checked(min(1.0, 2 * min(chance, broken)) if len(squares) else chance, float(off @ off), len(off))


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
        most = max(values_of(case.description.setups[setup]) for setup in set(places.setups.tolist()))
        self._rows, self._variances = np.zeros((len(places), most, size)), np.ones((len(places), most))
        for setup, mine in places.by_setup():
            for number, seen in enumerate(case.observation.rows_each(setup, *places.in_setup(setup))):
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
        poses, approaches = places.in_setup(setup)
        order, _ = short_way(machine, setups[setup], poses, approaches)
        parts.append(Places.of_setup(setup, poses[order], approaches[order]))
    return Places.joined(parts)
