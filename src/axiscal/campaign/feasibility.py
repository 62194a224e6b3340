"""Whether the target can be reached with the set-ups at all, said before the first reading."""

from __future__ import annotations

import math

from axiscal.campaign.problem import Problem
from axiscal.units import to_unit

_NAMED = 3


def out_of_reach(problem: Problem) -> str | None:
    """Return why the RMS target cannot be reached with these set-ups and what would help; None if it can."""
    target = problem.description.target.rms
    floor = reachable_rms(problem)
    if target is None or floor <= target:
        return None
    said = f"With these set-ups the RMS cannot fall below {to_unit(floor, 'um'):.3g} um, whatever is read"
    wanted = f"the target is {to_unit(target, 'um'):.3g} um"
    rest = math.sqrt(problem.yardstick.moments.rest)
    if rest > target:
        help_text = (
            f"the rests of the errors alone make {to_unit(rest, 'um'):.3g} um: finer knots would let them shrink"
        )
    else:
        hidden = " ".join(part.text for part in problem.hidden[:_NAMED])
        help_text = f"another set-up would help. What cannot be seen: {hidden}"
    return f"{said}; {wanted}. The campaign stops at the target for what can be seen; {help_text}"


def reachable_rms(problem: Problem) -> float:
    """Return the RMS over the volume that endless readings would leave, m."""
    return math.hypot(problem.yardstick.unseen_rms, math.sqrt(problem.yardstick.moments.rest))
