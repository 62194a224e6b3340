"""What explains readings that contradict the model, in one sentence: the likeliest cause, its odds, size and remedy."""

from __future__ import annotations

import math
from collections.abc import Iterator

from axiscal.error_model.iso230 import words
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.ruled import ruling_of
from axiscal.inference.contradiction import SURE, Comparison, Explanation
from axiscal.language.spoken import listed, put, said
from axiscal.measurement.departures import TWIST
from axiscal.measurement.place_texts import reading_unit
from axiscal.report.curves import value_unit
from axiscal.report.summary import Finding
from axiscal.units import said_quantity, to_unit

_CODES = {
    "drift": "drift",
    "levelling": "drift",
    "excursion": "drift",
    "growth": "drift",
    "jump": "drift",
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
    contradicted = "The readings contradict the model ({surely}): {what}; {remedy}."
    text = said(contradicted, surely=_how_surely(found), what=what, remedy=remedy)
    near = [_described(each, estimation)[0] for each in others if each.odds >= _AS_LIKELY * first.odds]
    if near:
        text = listed(" ", [text, said("About as likely: {causes}.", causes=listed(said("; or "), near))])
    owner = first.owner if first.owner in estimation.case.errors.names else None
    yield Finding(_CODES.get(first.family, "lack-of-fit"), owner, text)


def _how_surely(found: Comparison) -> str:
    """Return by which odds, or by which chance where the odds are less than those that are acted on."""
    if found.highest >= SURE:
        odds = min(math.floor(math.log10(found.highest)), _MOST)
        return said("odds of 10^{power} to 1 at least", power=odds)
    return said("chance does so in less than one campaign of twenty")


def _described(each: Explanation, estimation: Estimation) -> tuple[str, str]:
    """Return in words what may be, and what to do about it."""
    if each.family in ("drift", "levelling", "excursion", "jump", "bad"):
        return _of_setup(each, estimation)
    if each.family == "together":
        twist = "two axes seem to act together beyond the sum of their curves, a twist of {size} ({owner})"
        sag = "two axes seem to act together beyond the sum of their curves, a sag of {size} ({owner})"
        what = said(twist if each.place == TWIST else sag, size=_sized(each, "um"), owner=each.owner)
        return what, said('describe {owner} = {{ std = "…", knots = [9, 9] }}', owner=each.owner)
    return _of_error(each, estimation)


def _of_setup(each: Explanation, estimation: Estimation) -> tuple[str, str]:
    setup = estimation.case.description.setup(each.owner)
    unit = reading_unit(setup)
    size = _sized(each, unit)
    if each.family == "bad":
        index = estimation.readings.index(ruling_of(estimation).readings[int(each.place)])
        wrong = said("{reading} seems to be wrong by {size}", reading=estimation.name_of(index), size=size)
        return wrong, said("take it again")
    if each.family == "jump":
        jumped = said(
            'the zero of "{owner}" seems to have jumped by {size}: {reading} is the first one after it',
            owner=each.owner,
            size=size,
            reading=estimation.name_of(_with_number(int(each.place), estimation)),
        )
        return jumped, said("if it was set anew or knocked there, let what was read from there on be another set-up")
    if each.family == "excursion":
        gone = 'the zero of "{owner}" seems to have come and gone by {size} while it was read'
        return said(gone, owner=each.owner, size=size), said(
            "read when it is warm, or read every other place in a second round"
        )
    rate = f"{abs(to_unit(each.size, unit)):.2g} {unit}/h"
    remedy = said('state drift = "{rate}" in the set-up, or measure when it is warm', rate=rate)
    steady = 'the zero of "{owner}" seems to drift by {size} in an hour'
    levelling = 'the zero of "{owner}" seems to drift and level off after {size}'
    return said(steady if each.family == "drift" else levelling, owner=each.owner, size=size), remedy


def _with_number(number: int, estimation: Estimation) -> int:
    """Return the index of the reading that holds this one of all numbers that were compared."""
    readings = ruling_of(estimation).readings
    owners = [reading for reading in readings for _ in reading.values]
    return estimation.readings.index(owners[number])


def _sized(each: Explanation, unit: str) -> str:
    """Return the size of a departure with its band."""
    size, half = abs(to_unit(each.size, unit)), 2 * to_unit(each.std, unit)
    return put("{size:.2g} ± {half:.2g} {unit}", size=float(size), half=float(half), unit=unit)


def _of_error(each: Explanation, estimation: Estimation) -> tuple[str, str]:
    function = estimation.case.errors.names[each.owner]
    axis = estimation.case.errors.machine.axes[function.axis]
    written, place = f"{to_unit(each.place, axis.unit):.4g} {axis.unit}", said_quantity(each.place, axis.unit, 4)
    name = put("{name} ({words})", name=each.owner, words=words(each.owner))
    told = {"name": name, "size": _sized(each, value_unit(function)), "place": place}
    if each.family == "pitch":
        return said("{name} seems to repeat every {place}, by ±{size}", **told), said(
            'state period = "{period}" for it', period=written
        )
    if each.family == "step":
        return said("{name} seems to step by {size} near {place}", **told), said("read closely on both sides of it")
    if each.family == "growth":
        what = "{name} seems to have grown by {size} over the travel and shrunk again while it was read"
        return said(what, **told), said("let the axis warm up first, or read every other place in a second round")
    if each.family == "bump":
        remedy = said("read more densely there, and give it more knots")
        return said("{name} seems to have a bump of {size} near {place}", **told), remedy
    if each.family == "detail":
        what = "{name} seems to have a detail of {size} near {place}, narrower than its knots are apart"
        remedy = said("read there again and on both sides of it: one reading cannot tell a detail from a slip")
        return said(what, **told), remedy
    if each.family == "reversal":
        return said("{name} seems to be another by {size} near {place}", **told), said("give the reversal knots")
    remedy = said("state the temperature, or a larger std")
    if axis.rotary or function.angular:
        return said("{name} seems to be linear, {size} over the travel", **told), remedy
    kelvin = float(abs(each.size) / axis.length / _STEEL)
    like = "{name} seems to be linear, {size} over the travel, like {steel:.3g} um/m/K × {kelvin:.2g} K"
    return said(like, **told, steel=_STEEL * 1e6, kelvin=kelvin), remedy
