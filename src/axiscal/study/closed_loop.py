"""A virtual machine measured as `axiscal run` does: read, estimated and planned anew while the readings come."""

from __future__ import annotations

from dataclasses import replace

from axiscal.accuracy.yardstick import Accuracy
from axiscal.campaign.default_planner import plan_ahead
from axiscal.campaign.ending import count_reached, out_of_reach, standing
from axiscal.campaign.sources.simulated import SimulatedSource
from axiscal.campaign.sources.source import Request
from axiscal.description.campaign import CampaignDescription
from axiscal.description.wants import Want
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import estimated
from axiscal.estimation.timed import Timed, elapsed, timed
from axiscal.measurement.place import Place
from axiscal.measurement.reading import Reading
from axiscal.planning.plan_basis import plan_basis
from axiscal.simulation import VirtualMachine
from axiscal.study.study_case import Stop


class Reader:
    """Takes readings of a virtual machine one after the other; zeros drift with the time that they take.

    case : says how long they take; number : of the machine, with which its noise begins
    """

    def __init__(self, case: Case, truth: VirtualMachine, number: int) -> None:
        self._case, self._source, self._times = case, SimulatedSource(truth, number), Timed()
        self.readings = tuple[Reading, ...]()

    def until(self, place: Place) -> float:
        """Return what they and one more take, s."""
        return elapsed(self._case, self._times, [place])

    def take(self, place: Place) -> None:
        """Take one."""
        described = self._case.description
        setup, axes = described.setup(place.setup), described.machine.axes
        request = Request(len(self.readings) + 1, setup, axes, place.pose, place.approach, self.until(place))
        answer = self._source.read(request)
        reading = Reading(place.setup, place.pose, place.approach, answer.value, others=answer.others)
        self.readings = *self.readings, reading
        self._times = timed(self._case, self.readings, self._times)


def replanned(case: Case, stop: Stop, truth: VirtualMachine, number: int) -> tuple[Reading, ...]:
    """Return what a campaign reads that plans anew with what it has read, until it ends.

    stop : when; with neither of both at the target of the campaign, or where none is to be reached
    """
    case = replace(case, description=_ending_so(case.description, stop))
    reader, target = Reader(case, truth, number), case.description.target
    path, plan, basis = list[Accuracy](), tuple[Place, ...](), ""
    while True:
        known = estimated(case, reader.readings)
        path.append(known.accuracy)
        reached = target.accurate and standing(target, known) is not None
        if reached or count_reached(target, len(reader.readings)) or out_of_reach(target, path):
            return reader.readings
        now = plan_basis(known.case, known.readings, known.outliers)
        if not plan or now != basis:
            plan = plan_ahead(known.case, known.to_plan_by, known.readings, known.outliers, (), plan)
            basis = now
        if not plan or (target.budget is not None and reader.until(plan[0]) > target.budget):
            return reader.readings
        reader.take(plan[0])
        plan = plan[1:]


def _ending_so(described: CampaignDescription, stop: Stop) -> CampaignDescription:
    target = described.target
    if stop.readings is not None or stop.budget is not None:
        wants = tuple(Want(want.row) for want in target.wants)
        target = replace(target, readings=stop.readings, budget=stop.budget, rms=None, worst=None, expanded=None)
        target = replace(target, wants=wants)
    return replace(described, target=target)
