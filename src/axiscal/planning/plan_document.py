"""A plan in the words and units of outsiders: the document `axiscal-plan/1` and the sentence about its bound."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from axiscal.design.plan.plan import Plan
from axiscal.estimation.case import Case
from axiscal.machine.kinematics import frames
from axiscal.measurement.place import Place
from axiscal.measurement.place_texts import shown_approach, shown_pose
from axiscal.planning.next_readings import placed
from axiscal.planning.promise import reachable_rms
from axiscal.planning.proposal import Proposal
from axiscal.units import to_unit

_MUCH = 0.5
"""Share of the bound from which it is worth a sentence."""


def plan_document(case: Case, proposal: Proposal) -> dict[str, Any]:
    """Return the document `axiscal-plan/1`.

    ratio : of the mean variances that the two RMS figures are the roots of; of J where the criterion is another one
    """
    plan = proposal.plan
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
        "reachable_rms_um": to_unit(reachable_rms(case), "um"),
        "target_met": plan.met,
        "J": plan.value,
        "bound_J": None if plan.bound is None else plan.bound.value,
        "bound_rms_um": bound_rms_um(case, plan),
        "ratio": _finite(ratio(case, plan)),
        "percent_from_best": _finite(percent_from_best(case, plan)),
        "bound_holds_for": holds_for(proposal),
        "proof_gap_percent": None if proposal.gap is None else _finite(_gap_percent(case, proposal)),
    }


def _points(case: Case, plan: Plan) -> list[dict[str, Any]]:
    axes = case.description.machine.axes
    points = []
    for place, reading in zip(placed(case, plan), plan.readings, strict=True):
        points.append(
            {
                "setup": place.setup,
                "position": shown_pose(axes, place.pose),
                "direction": list(case.description.setup(place.setup).direction),
                "approach": shown_approach(axes, place.approach),
                **_touched(case, place),
                "rms_um": to_unit(reading.accuracy.rms, "um"),
                "worst_um": to_unit(reading.accuracy.worst, "um"),
                "minutes": to_unit(reading.seconds, "min"),
            }
        )
    return points


def _touched(case: Case, place: Place) -> dict[str, Any]:
    """Return where the tool point is, mm in the workpiece frame, and the artefact and the ball that it is at."""
    setup, at = case.description.setup(place.setup), np.array([place.pose])
    tips = frames(case.description.machine, at).tcp
    said: dict[str, Any] = {"tcp": [round(to_unit(float(value), "mm"), 9) + 0.0 for value in tips[0]]}
    if setup.artefact is not None:
        ball = int(setup.artefact.nearest(tips, setup.balls)[0])
        said |= {"artefact": setup.artefact.name, "ball": setup.artefact.balls[ball].name}
    return said


def bound_rms_um(case: Case, plan: Plan) -> float | None:
    """Return the RMS that no plan can beat, um; None without a bound, or where the criterion is not the volume's."""
    if plan.bound is None or case.description.target.criterion != "volume":
        return None
    return to_unit(case.yardstick.rms_of(plan.bound.value), "um")


def ratio(case: Case, plan: Plan) -> float:
    """Return how many times the mean variance over the volume (else J) is what no plan can beat; inf without a bound.

    Rests and what no set-up sees are in both, a constant shift that is not counted in neither: as printed.
    """
    bound = bound_rms_um(case, plan)
    if bound is None:
        return plan.ratio
    return (to_unit(plan.accuracy.rms, "um") / bound) ** 2 if bound > 0 else math.inf


def percent_from_best(case: Case, plan: Plan) -> float:
    """Return by how many percent the RMS (else J) is above what no plan can beat."""
    times = ratio(case, plan)
    return 100 * ((times if bound_rms_um(case, plan) is None else math.sqrt(times)) - 1)


def holds_for(proposal: Proposal) -> str | None:
    """Return which plans the bound is about."""
    if proposal.plan.bound is None:
        return None
    if proposal.gap is not None:
        return "every position in the travel"
    everywhere = "any readings whatever"
    return everywhere if proposal.plan.bound.everywhere else f"lattice of {proposal.plan.candidates:,} candidates"


def bound_sentence(case: Case, proposal: Proposal) -> str:
    """Say how far from the best possible plan this one is."""
    plan = proposal.plan
    if plan.bound is None:
        return "No bound was asked for."
    count, bound = len(plan.readings), bound_rms_um(case, plan)
    readings = f"{count} reading{'' if count == 1 else 's'}"
    best = f"make J smaller than {plan.bound.value:.4g}" if bound is None else f"be better than {bound:.3g} um"
    own = f"{plan.value:.4g}" if bound is None else f"{to_unit(plan.accuracy.rms, 'um'):.3g} um"
    said = f"No plan of {readings} {_where(proposal)} can {best}; this one gives {own}: "
    said += f"{_percent(percent_from_best(case, plan))} from the best possible"
    if proposal.gap is not None:
        said += f"; search stopped at a gap of {_percent(_gap_percent(case, proposal))}"
    return f"{said}.{_left_by_all(case, plan, bound)}"


def _where(proposal: Proposal) -> str:
    if proposal.gap is not None:
        return "anywhere in the travel"
    everywhere = proposal.plan.bound is not None and proposal.plan.bound.everywhere
    return "wherever they are taken" if everywhere else f"from these {proposal.plan.candidates:,} candidates"


def _left_by_all(case: Case, plan: Plan, bound: float | None) -> str:
    """Say how much of both figures no reading could take away, where that makes them look alike."""
    left = to_unit(reachable_rms(case), "um")
    return "" if bound is None or left < _MUCH * bound else f" Of both, {left:.3g} um is what endless readings leave."


def _gap_percent(case: Case, proposal: Proposal) -> float:
    """Return the gap at which the proof stopped, of the RMS (else of J)."""
    gap, bound = proposal.gap or 0.0, proposal.plan.bound
    if bound is None or bound_rms_um(case, proposal.plan) is None or not math.isfinite(gap):
        return 100 * gap
    low, high = (case.yardstick.rms_of(value) for value in (bound.value, bound.value * (1 + gap)))
    return 100 * (high / low - 1) if low > 0 else math.inf


def _percent(value: float) -> str:
    return f"{value:.2g} %" if value < 100 else f"{value:.0f} %" if math.isfinite(value) else "unknown"


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
