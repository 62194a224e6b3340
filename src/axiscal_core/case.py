"""A case: what is to be measured and with what, and the four questions that one asks of it.

>>> from axiscal_core import Axis, Case, Error, Laser, Machine
>>> machine = Machine([Axis.linear("X", "x", (0, "600 mm"))], [Error("EXX", "10 um", length="200 mm")])
>>> case = Case(machine, [Laser("laser", "X")])
>>> case.next().poses, f"{case.plan(readings=5).rms * 1e6:.2f} um"
(array([[0.]]), '0.95 um')
"""

from __future__ import annotations

from copy import copy

from numpy.typing import ArrayLike

from axiscal_core.criterion import Criterion
from axiscal_core.estimate import estimated
from axiscal_core.known import Known
from axiscal_core.model import CANDIDATES, Model, Table
from axiscal_core.places import Places, Readings
from axiscal_core.plan import Evaluation, Plan, evaluated, planned
from axiscal_core.refusals import InputError
from axiscal_core.step import best_step
from axiscal_core.units import Quantity

After = Readings | Table | Places | Known | None
"""What there is before a plan: readings, or places of such, at sizes as stated; what is known counts as it is."""


class Case(Model):
    """A machine and the instruments on it.

    usual : "on" adds what usually goes wrong and nobody stated, to errors and to readings: see `causes`
    sure : how well stated sizes are known; aligned : a rigid motion of the whole volume counts as no error
    """

    def plan(
        self, readings: int | None = None, *, minutes: Quantity | None = None, rms: Quantity | None = None,
        criterion: Criterion = "volume", candidates: Places | int = CANDIDATES, after: After = None,
        keep: Places | None = None,
    ) -> Plan:  # fmt: skip
        """Return the readings that serve best together; at least one of the first three says when it ends.

        readings : so many; minutes : as fit; rms : the fewest with an RMS over the volume of no more, m
        criterion : what is made small: "volume", "joint", V (w, size) of the unknowns as `names`, or f(covariance)
        candidates : where readings may be taken, or how many even places are tried
        after : readings that are there already; keep : places that are among those of the plan
        """
        case, before = self._begun(after, "Case.plan")
        return planned(case, readings, minutes, rms, criterion, candidates, before, keep)

    def evaluate(self, places: Places | Readings, after: After = None, criterion: Criterion = "volume") -> Evaluation:
        """Return what readings at places would make known, and the J that no choice of as many even places can beat."""
        case, before = self._begun(after, "Case.evaluate")
        return evaluated(case, places, before, criterion)

    def next(self, after: After = None, criterion: Criterion = "volume") -> Places:
        """Return the one reading that serves most (eq. 37): exactly, where one axis moves along a line."""
        case, before = self._begun(after, "Case.next")
        return best_step(case, before, criterion)

    def estimate(self, readings: Readings | Table) -> Known:
        """Return what readings make known, sizes averaged over, without readings that the others contradict.

        readings : or a table of them, see `Case.readings`
        """
        return estimated(self, self.taken_from(readings, "Case.estimate"))

    def known(self, mean: ArrayLike, covariance: ArrayLike) -> Known:
        """Return what is known already.  mean : (size,); covariance : (size, size)"""
        return Known.of(self, mean, covariance)

    def _begun(self, after: After, function: str) -> tuple[Model, Readings | Places | None]:
        """Return the case and what was read; what is known takes the place of its prior."""
        if not isinstance(after, Known):
            return self, after if isinstance(after, Places | None) else self.taken_from(after, function, "after")
        if after.names != self.names:
            raise InputError(function, "after", "is known of another case", "Estimate readings of this one")
        begun = copy(self)
        vars(begun)["prior"] = after.normal
        return begun, None

    def __repr__(self) -> str:
        return f"<Case of {self.machine!r} with {', '.join(self.setups)}>"
