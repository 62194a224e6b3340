"""What readings make known of a machine: the last stage, and what is asked of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from axiscal.accuracy.yardstick import Accuracy
from axiscal.belief import Belief, Innovations
from axiscal.estimation.absorbed import Absorbed
from axiscal.estimation.bands import Banded
from axiscal.estimation.case import Case
from axiscal.estimation.judged import Judged
from axiscal.estimation.knowledge import Knowledge
from axiscal.estimation.learnt import Learnt
from axiscal.estimation.machine_estimate import Estimate, rest_means
from axiscal.estimation.map_grid import map_grid
from axiscal.estimation.membership import Membership
from axiscal.estimation.timed import Timed
from axiscal.inference.implausible import objection
from axiscal.inference.outliers import Doubt
from axiscal.measurement.place_texts import reading_text
from axiscal.measurement.reading import Reading
from axiscal.numerics.remembered import remembered
from axiscal.promise.agreement import NOTHING_READ, Agreement
from axiscal.promise.posterior import Posterior


class Stages(NamedTuple):
    """How an estimation was found, which the next one begins with."""

    timed: Timed
    judged: Judged
    learnt: Learnt
    absorbed: Absorbed


@dataclass(frozen=True, eq=False)
class Estimation:
    """stated : the case as described; case : with scales as learnt, and stations and sides as found

    readings : each with its time; seconds : of machine time that they take; innovations : of each
    outliers : the readings that are not believed, first those that cannot be, then those that others contradict
    banded : case and knowledge with the bands that are printed, sizes averaged over
    accuracy : how well the machine is known, with these bands
    membership : how probable the rival beliefs are, None where there is one; side : the one that it was found by
    """

    stated: Case
    case: Case
    knowledge: Knowledge
    readings: tuple[Reading, ...]
    seconds: float
    innovations: tuple[Innovations, ...]
    outliers: tuple[Doubt, ...]
    banded: Banded
    accuracy: Accuracy
    stages: Stages
    membership: Membership | None = None
    side: int = 0

    @property
    def whole(self) -> Belief:
        """The belief at the most probable scales: of all rivals together where there are some."""
        return self.knowledge.belief if self.membership is None else self.membership.belief

    @property
    def posterior(self) -> Posterior | None:
        """The posterior of errors, set-ups and sizes; None before the first reading."""
        return self.stages.learnt.found

    @property
    def agreement(self) -> Agreement:
        """Whether the readings agree with each other."""
        return NOTHING_READ if self.posterior is None else self.posterior.agreement

    @property
    def to_plan_by(self) -> Knowledge:
        """What the next readings are chosen by: the likeliest rival's, or all of them once that one is good enough."""
        target = self.stated.description.target
        if self.membership is None or not target.accurate:
            return self.knowledge
        met = self.case.yardstick.measure(self.knowledge.belief).meets(target.rms, target.worst)
        return Knowledge(self.knowledge.observation, self.whole) if met else self.knowledge

    @remembered
    def estimate(self) -> Estimate:
        """Return what tables are made of: the belief about the machine, over the volume of the target."""
        description, wide = self.case.description, self.banded
        grid = map_grid(description.machine, description.setups, self.readings)
        found = self.posterior
        rests = rest_means(wide.case.errors, {} if found is None else found.cells)
        belief, yardstick = wide.knowledge.belief, wide.case.yardstick
        place = description.target.volume, grid, rests, yardstick.sample, yardstick.alignment, yardstick.counted
        return Estimate(wide.case.errors, belief, *place)

    def objection_to(self, doubt: Doubt) -> str:
        """Return in words what an implausible reading is."""
        reading, described = self.readings[doubt.reading], self.stated.description
        return objection(doubt, reading, described.setup(reading.setup), described.machine.axes)

    def name_of(self, index: int) -> str:
        """Return which reading it is that has this index among the readings: its number, set-up and place."""
        reading, described = self.readings[index], self.stated.description
        return reading_text(described.machine.axes, described.setup(reading.setup), reading, index)
