"""A dozen readings that say whether a machine is still as its last campaign left it.

The places are those that say most of a machine that has drifted since: a plan with ρ² C + (1 − ρ²) C₀ as the prior,
moved until crashes show (`crash_places`).
Its readings z = R a + e have to fit N(ρ m, ·): χ² = (z − ρ R m)ᵀ (R (ρ² C + (1 − ρ²) C₀) Rᵀ + I)⁻¹ (z − ρ R m). Where
the campaign knew the machine's type, what all sisters have stays (`wearing`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.campaign.campaign import Campaign
from axiscal.compensation.effect import Control
from axiscal.description.campaign import CampaignDescription
from axiscal.design.plan.task import Limits
from axiscal.error_model.model import ErrorModel
from axiscal.estimate.problem import Inherited
from axiscal.estimation.timed import Timed, timed
from axiscal.exceptions import RecordError
from axiscal.fleet.crash_places import showing_crashes
from axiscal.fleet.measured_again import again, case_again
from axiscal.fleet.tables_left import control_of
from axiscal.fleet.wearing import Wearing, found_by
from axiscal.fleet.without_tables import without_tables
from axiscal.inference.reading_set import ReadingSet
from axiscal.inference.sisters.data_equation import data_equation
from axiscal.measurement.blank_sheet import blank_sheet
from axiscal.measurement.place import Place
from axiscal.measurement.place_texts import columns_of
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import places_of
from axiscal.numerics.from_scipy import chi_square_tail, solution
from axiscal.numerics.gaussian import lower_root
from axiscal.numerics.threads import one_thread
from axiscal.planning.next_readings import with_rooms
from axiscal.planning.proposal import proposed

READINGS = 12
"""Six readings find a crash of three standard deviations in one of twenty cases, eight in four of five, twelve in all
but one of fifty (trials of the method)."""
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
        self.last, self.case = last, case_again(description, wearing.worn(last).left(kept))
        self._control = control

    @classmethod
    def of(cls, campaign: Campaign, kept: float, controller: str | None = None) -> QuickCheck:
        """Return the check of a campaign that has been measured.

        controller : whose tables of it are loaded; None for none, or for such as take all away that was found
        Raises RecordError where it has no readings, TableError where no tables can be made for the control.
        """
        if not campaign.state.readings:
            raise RecordError("The record has no readings", "Name a campaign that has been measured", campaign.path)
        known = campaign.concluded()
        control = None if controller is None else control_of(known, controller)
        return cls(again(known), found_by(known), kept, control, Wearing.of(known))

    def planned(self, count: int, told: Callable[[str], None] = lambda said: None) -> tuple[Place, ...]:
        """Return the places that say most, moved until crashes show; raises PlanError."""
        plan = proposed(self.case, Limits(count), progress=told, bounded=False).plan
        return with_rooms(self.case, showing_crashes(self.case, plan.places))

    def sheet(self, places: Sequence[Place]) -> str:
        """Return the places as a file to fill in."""
        described = self.case.description
        setups, axes = described.setups, described.machine.axes
        at = places_of(setups, [Reading(p.setup, p.pose, p.approach, 0.0) for p in places])
        return blank_sheet(setups, axes, at, columns_of(setups[index] for index in at.setups))

    @one_thread()
    def judged(self, readings: Sequence[Reading], tables: bool = False) -> Checked:
        """Return what readings say.  tables : they were taken with the tables of the last campaign in the control"""
        described = self.case.description
        if tables and self._control is not None:
            readings, tables = without_tables(readings, described.machine, described.setups, self._control), False
        read = timed(self.case, readings, Timed()).readings
        numbers, size = ReadingSet(self.case.observation, read), self.case.errors.size
        data = data_equation(numbers, np.ones(len(readings)), np.zeros((size, 0)))
        now = self.case.inherited or self.last
        expected = now.mean - self.last.mean if tables else now.mean
        lower = lower_root(data.rows @ now.covariance @ data.rows.T + np.eye(len(data.values)))
        off = solution(lower, data.values - data.rows @ expected)
        return Checked(chi_square_tail(len(off), float(off @ off)), float(off @ off), len(off))
