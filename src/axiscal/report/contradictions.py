"""What explains readings that contradict the model, in one sentence: the likeliest cause, its odds, size and remedy."""

from __future__ import annotations

import math
from collections.abc import Iterator

from axiscal.error_model.iso230 import words
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.ruled import ruling_of
from axiscal.inference.contradiction import SURE, Comparison, Explanation
from axiscal.measurement.departures import TWIST
from axiscal.measurement.place_texts import reading_unit
from axiscal.report.curves import value_unit
from axiscal.report.summary import Finding
from axiscal.units import to_unit

_CODES = {
    "drift": "drift",
    "levelling": "drift",
    "bad": "outlier",
    "scale": "prior-misfit",
}
_AS_LIKELY = 0.1
"""Others are named whose odds are no less than so much of the likeliest one's."""
_STEEL = 11.7e-6
"""1/K: the growth of steel, from which a scale is said as a difference of temperature."""
_MOST = 15
"""Powers of ten of the odds: more are said as so many."""


def contradictions(estimation: Estimation, found: Comparison) -> Iterator[Finding]:
    """Yield one sentence for the likeliest cause, if the readings contradict the model; nothing if they do not."""
    if not found.caused:
        return
    first, *others = found.explanations
    what, remedy = _described(first, estimation)
    text = f"The readings contradict the model ({_how_surely(found)}): {what}; {remedy}."
    near = [_described(each, estimation)[0] for each in others if each.odds >= _AS_LIKELY * first.odds]
    if near:
        text += f" About as likely: {'; or '.join(near)}."
    owner = first.owner if first.owner in estimation.case.errors.names else None
    yield Finding(_CODES.get(first.family, "lack-of-fit"), owner, text)


def _how_surely(found: Comparison) -> str:
    """Return by which odds, or by which chance where the odds are less than those that are acted on."""
    if found.highest >= SURE:
        odds = min(math.floor(math.log10(found.highest)), _MOST)
        return f"odds of 10^{odds} to 1 at least"
    return "chance does so in less than one campaign of twenty"


def _described(each: Explanation, estimation: Estimation) -> tuple[str, str]:
    """Return in words what may be, and what to do about it."""
    if each.family in ("drift", "levelling", "bad"):
        return _of_setup(each, estimation)
    if each.family == "together":
        size = f"{abs(to_unit(each.size, 'um')):.2g} ± {2 * to_unit(each.std, 'um'):.2g} um"
        shape = "twist" if each.place == TWIST else "sag"
        what = f"two axes seem to act together beyond the sum of their curves, a {shape} of {size} ({each.owner})"
        return what, f'describe {each.owner} = {{ std = "…", knots = [9, 9] }}'
    return _of_error(each, estimation)


def _of_setup(each: Explanation, estimation: Estimation) -> tuple[str, str]:
    setup = estimation.case.description.setup(each.owner)
    unit = reading_unit(setup)
    size = f"{abs(to_unit(each.size, unit)):.2g} ± {2 * to_unit(each.std, unit):.2g} {unit}"
    if each.family == "bad":
        index = estimation.readings.index(ruling_of(estimation).readings[int(each.place)])
        return f"{estimation.name_of(index)} seems to be wrong by {size}", "take it again"
    again = f'state drift = "{abs(to_unit(each.size, unit)):.2g} {unit}/h" in the set-up, or measure when it is warm'
    how = f"by {size} in an hour" if each.family == "drift" else f"and level off after {size}"
    return f'the zero of "{each.owner}" seems to drift {how}', again


def _of_error(each: Explanation, estimation: Estimation) -> tuple[str, str]:
    function = estimation.case.errors.names[each.owner]
    axis = estimation.case.errors.machine.axes[function.axis]
    unit, place = value_unit(function), f"{to_unit(each.place, axis.unit):.4g} {axis.unit}"
    size = f"{abs(to_unit(each.size, unit)):.2g} ± {2 * to_unit(each.std, unit):.2g} {unit}"
    name = f"{each.owner} ({words(each.owner)})"
    if each.family == "pitch":
        return f"{name} seems to repeat every {place}, by ±{size}", f'state period = "{place}" for it'
    if each.family == "step":
        return f"{name} seems to step by {size} near {place}", "read closely on both sides of it"
    if each.family == "bump":
        return f"{name} seems to have a bump of {size} near {place}", "read more densely there, and give it more knots"
    if each.family == "reversal":
        return f"{name} seems to be another by {size} near {place}", "give the reversal knots"
    kelvin = abs(each.size) / axis.length / _STEEL
    like = f", like 11.7 um/m/K × {kelvin:.2g} K" if not (axis.rotary or function.angular) else ""
    return f"{name} seems to be linear, {size} over the travel{like}", "state the temperature, or a larger std"
