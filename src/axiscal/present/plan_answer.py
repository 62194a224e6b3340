"""The effect of a plan as the document `axiscal-plan/1`: codes and numbers, um, urad, mm, deg, minutes; no sentence."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from operator import not_
from typing import Literal

import numpy as np
from pydantic import Field

from axiscal.campaign.campaign import Campaign
from axiscal.estimation.case import Case
from axiscal.estimation.known_rows import known_rows
from axiscal.measurement.reading import Place, shown_approach, shown_pose
from axiscal.measurement.reading_rows import blank_readings, places_of
from axiscal.planning.helping import helping_setups
from axiscal.planning.next_readings import FEW_CANDIDATES, placed
from axiscal.planning.plan.plan import Plan
from axiscal.planning.plan.task import Limits
from axiscal.planning.promise import foreseen
from axiscal.planning.proposal import Bought, bought
from axiscal.present.answer import (
    Aim,
    AnswerDocument,
    BoughtAccuracy,
    NextStep,
    PlannedAnswer,
    PlannedRow,
    PlannedSetup,
    PlanVerdict,
    ReachAnswer,
    StepCode,
)
from axiscal.present.answer_of_campaign import Aims, known_figures
from axiscal.units import to_unit
from axiscal_core.threads import one_thread


class PlanPoint(AnswerDocument):
    """A reading: where, from which sides, and what is known and has passed after it.

    tcp : the tool point, mm in the workpiece frame; artefact, ball : that it is at, on a chart
    check : it was drawn at random
    """

    setup: str
    position: Mapping[str, float]
    direction: Sequence[float]
    approach: Mapping[str, str]
    tcp: Sequence[float]
    artefact: str | None = Field(None, exclude_if=not_)
    ball: str | None = Field(None, exclude_if=not_)
    rms_um: float
    minutes: float
    check: bool = Field(False, exclude_if=not_)


class PlanAnswer(PlannedAnswer):
    """A plan in full.

    `points` and `rms_um` leave out what no reading shows, such as the error of a wavelength
    units : of the axes
    bound_rms_um : RMS that no plan of as many readings can beat; None where it is below half of `rms_um`
    """

    kind: Literal["axiscal-plan/1"] = Field("axiscal-plan/1", alias="schema")
    points: Sequence[PlanPoint]
    units: Mapping[str, str]
    rms_um: float
    bound_rms_um: float | None


@one_thread()
def plan_answer(
    case: Case,
    plan: Plan,
    limits: Limits,
    buys: Sequence[Bought] = (),
    *,
    ends: bool = True,
) -> PlanAnswer:
    """Return the document of a plan that was made within limits.

    buys : what other minutes buy; ends : whether the campaign says when it ends
    """
    places = placed(case, plan)
    begin: list[StepCode] = ["start"] if ends else ["target", "start"]
    passed = [0.0, *(reading.seconds for reading in plan.readings)]
    answer = _planned(case, places, passed.__getitem__, limits, begin)
    return PlanAnswer(
        **{**dict(answer), "bought": _bought(buys)},
        points=list(_points(case, places, plan)),
        units={axis.name: axis.unit for axis in case.description.machine.axes},
        rms_um=to_unit(plan.accuracy.rms, "um"),
        bound_rms_um=None if plan.bound is None else to_unit(plan.bound, "um"),
    )


@one_thread()
def coming_answer(campaign: Campaign) -> PlannedAnswer | None:
    """Return what is known after the readings to come of a campaign that has none yet; None after its first."""
    case, places = campaign.estimate().case, campaign.state.coming
    if campaign.state.readings or not places:
        return None
    target = case.description.target
    limits = Limits(readings=target.readings, budget=target.budget)
    return _planned(case, places, lambda count: campaign.seconds(places[:count]), limits, ["measure"])


def minutes_curve(campaign: Campaign) -> list[BoughtAccuracy]:
    """Return what other minutes than those of the readings to come buy; nothing where none come."""
    coming, setups = campaign.state.coming, campaign.description.setups
    places = places_of(setups, blank_readings(setups, coming))
    return _bought(bought(campaign.estimate().case, places, campaign.seconds(coming), FEW_CANDIDATES))


def _bought(buys: Sequence[Bought]) -> list[BoughtAccuracy]:
    return [
        BoughtAccuracy(minutes=to_unit(each.seconds, "min"), expanded_um=to_unit(each.expanded, "um"), mark=each.mark)
        for each in buys
    ]


def _planned(
    case: Case,
    places: Sequence[Place],
    passed: Callable[[int], float],
    limits: Limits,
    steps: Sequence[StepCode],
) -> PlannedAnswer:
    """Return what is known after readings at places.  passed : seconds after so many of them"""
    readings = blank_readings(case.description.setups, places)
    known = foreseen(case, (), places)
    rows = known_rows(case, known, readings)
    aims = Aims.from_case(case, known.belief, case.yardstick, rows)
    verdict: PlanVerdict = "planned" if not any(aims) else "reached" if aims.met else "short"
    reach = None if aims.met else _reach(case, aims.hopeless)
    return PlannedAnswer(
        verdict=verdict if reach is None else "unreachable",
        rows=[PlannedRow(**known_figures(row, case.description.machine.axes)) for row in rows],
        aims=[*aims.volume, *aims.lines],
        reach=reach,
        setups=list(_setups(case, places, passed)),
        steps=[NextStep(code=code) for code in steps],
        readings=len(places),
        checks=sum(place.check for place in places),
        allowed=limits.readings,
        minutes=to_unit(passed(len(places)), "min"),
        budget_minutes=None if limits.budget is None else to_unit(limits.budget, "min"),
    )


@one_thread()
def reach_answer(case: Case) -> ReachAnswer | None:
    """Return why no reading of these set-ups can reach the target, and what would help; None where readings can."""
    rows = known_rows(case, case.knowledge, ()) if case.description.target.lines else ()
    return _reach(case, Aims.from_case(case, case.knowledge.belief, case.yardstick, rows).hopeless)


def _reach(case: Case, missed: Sequence[Aim]) -> ReachAnswer | None:
    return ReachAnswer(missed=missed, helps=helping_setups(case, case.description.target)) if missed else None


def _setups(case: Case, places: Sequence[Place], passed: Callable[[int], float]) -> Iterator[PlannedSetup]:
    axes, names = case.description.machine.axes, [place.setup for place in places]
    for name in dict.fromkeys(names):
        setup, last = case.description.setup(name), len(names) - names[::-1].index(name)
        yield PlannedSetup(
            setup=name,
            instrument=setup.title,
            moves=[axes[k].name for k in setup.moves],
            readings=names.count(name),
            minutes=to_unit(passed(last), "min"),
        )


def _points(case: Case, places: Sequence[Place], plan: Plan) -> Iterator[PlanPoint]:
    machine = case.description.machine
    for place, reading in zip(places, plan.readings, strict=True):
        setup, tips = case.description.setup(place.setup), machine.frames(np.array([place.pose])).tcp
        artefact = setup.artefact
        ball = None if artefact is None else artefact.balls[int(artefact.nearest(tips, setup.balls)[0])].name
        yield PlanPoint(
            setup=place.setup,
            position=shown_pose(machine.axes, place.pose),
            direction=list(setup.direction),
            approach=shown_approach(machine.axes, place.approach),
            tcp=[round(to_unit(float(value), "mm"), 9) + 0.0 for value in tips[0]],
            artefact=None if artefact is None else artefact.name,
            ball=ball,
            rms_um=to_unit(reading.accuracy.rms, "um"),
            minutes=to_unit(reading.seconds, "min"),
            check=place.check,
        )
