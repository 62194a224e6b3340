"""A plan in the words and units of outsiders: the document `axiscal-plan/1` and the sentence about its bound."""

from __future__ import annotations

import math
from typing import Any

from axiscal.campaign.planning import placed
from axiscal.campaign.problem import Problem
from axiscal.design.plan import Plan
from axiscal.measurement.wording import shown_approach, shown_pose
from axiscal.units import to_unit


def plan_document(case: Problem, plan: Plan) -> dict[str, Any]:
    """Return the document `axiscal-plan/1`.

    ratio : J of the plan over the bound on J; the RMS figures are there where the criterion is the volume's
    """
    return {
        "schema": "axiscal-plan/1",
        "criterion": case.description.target.criterion,
        "points": _points(case, plan),
        "readings": len(plan.readings),
        "minutes": to_unit(plan.seconds, "min"),
        "rms_um": to_unit(plan.accuracy.rms, "um"),
        "worst_um": to_unit(plan.accuracy.worst, "um"),
        "before_rms_um": to_unit(plan.before.rms, "um"),
        "unseen_rms_um": to_unit(case.yardstick.unseen_rms, "um"),
        "target_met": plan.met,
        "J": plan.value,
        "bound_J": None if plan.bound is None else plan.bound.value,
        "bound_rms_um": bound_rms_um(case, plan),
        "ratio": plan.ratio if math.isfinite(plan.ratio) else None,
        "bound_holds_for": holds_for(plan),
    }


def _points(case: Problem, plan: Plan) -> list[dict[str, Any]]:
    axes = case.description.machine.axes
    points = []
    for place, reading in zip(placed(case, plan), plan.readings, strict=True):
        points.append(
            {
                "setup": place.setup,
                "position": shown_pose(axes, place.position),
                "direction": list(case.description.setup(place.setup).direction),
                "approach": shown_approach(axes, place.approach),
                "rms_um": to_unit(reading.accuracy.rms, "um"),
                "worst_um": to_unit(reading.accuracy.worst, "um"),
                "minutes": to_unit(reading.seconds, "min"),
            }
        )
    return points


def bound_rms_um(case: Problem, plan: Plan) -> float | None:
    """Return the RMS that no plan can beat, um; None without a bound, or where the criterion is not the volume's."""
    if plan.bound is None or case.description.target.criterion != "volume":
        return None
    return to_unit(case.yardstick.rms_of(plan.bound.value), "um")


def holds_for(plan: Plan) -> str | None:
    """Return which plans the bound is about."""
    if plan.bound is None:
        return None
    return "any readings whatever" if plan.bound.everywhere else f"lattice of {plan.candidates:,} candidates"


def bound_sentence(case: Problem, plan: Plan) -> str:
    """Say how far from the best possible plan this one is."""
    bound = bound_rms_um(case, plan)
    count = len(plan.readings)
    if plan.bound is None:
        return "No bound was asked for."
    where = "wherever they are taken" if plan.bound.everywhere else f"from these {plan.candidates:,} candidates"
    if bound is None:
        return (
            f"No plan of {count} readings {where} can make J smaller than {plan.bound.value:.4g}; "
            f"this one gives {plan.value:.4g}: {100 * (plan.ratio - 1):.2g} % from the best possible."
        )
    rms = to_unit(plan.accuracy.rms, "um")
    return (
        f"No plan of {count} readings {where} can be better than {bound:.3g} um; "
        f"this one gives {rms:.3g} um: {100 * (rms / bound - 1):.2g} % from the best possible."
    )
