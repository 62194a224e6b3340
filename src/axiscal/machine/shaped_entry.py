"""Errors of a stated shape: EXX_pitch repeats with a period (screw, encoder line), EXX_step has steps at joints."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

from axiscal.document import Document, shown
from axiscal.exceptions import DescriptionError
from axiscal.machine.axis import Axis
from axiscal.machine.limits import Keys, within
from axiscal.machine.machine_schema import ErrorTable
from axiscal.machine.names import ErrorName

MOST_HARMONICS = 4
"""What is finer than a quarter of a period is noise; a matter of taste."""
MOST_BREAKS = 4000
"""Of a curve along an axis: a step search meets each of them, and takes a second for so many."""
KNOTS_PER_WAVE = 8
"""A cyclic spline of so many follows a sine within 1.2 thousandths (tests/numerics/test_repeated.py)."""
JOINT = 1e-3
"""m, or rad: over so much a reading head goes from one piece of a scale to the next (an assumption)."""
_MOST_JOINTS = 40
"""More pieces than any scale has."""
_TURN = 1e-6
"""Share of a turn that a period may be off a whole part of it: rounding."""


class Shaped(NamedTuple):
    """harmonics : waves to a period, at most; 0 for no pitch; joints : where steps are, m or rad."""

    harmonics: int = 0
    joints: tuple[float, ...] = ()


def shaped(document: Document, keys: Keys, table: ErrorTable, name: ErrorName, axis: Axis) -> Shaped:
    """Return the shape that an entry states; raises DescriptionError where name and keys do not fit each other."""
    if name.shape != "pitch" and table.harmonics is not None:
        remedy = "Give them to {error}_pitch"
        raise DescriptionError("{name} has no harmonics", remedy, name=name.canonical, error=name.bare)
    if name.shape != "step" and table.at is not None:
        raise DescriptionError("{name} has no joints", "Give at to {error}_step", name=name.canonical, error=name.bare)
    if name.shape == "curve":
        return Shaped()
    for key in ("knots", "spacing", "length", "rest", "smoothness"):
        if getattr(table, key) is not None:
            remedy = "Take it out, or give it to {error}"
            raise DescriptionError("{name} has no {key}", remedy, name=name.canonical, key=key, error=name.bare)
    return _pitch(document, keys, table, axis) if name.shape == "pitch" else _step(document, keys, table, axis)


def _pitch(document: Document, keys: Keys, table: ErrorTable, axis: Axis) -> Shaped:
    if table.period is None:
        raise DescriptionError("the period is missing", 'Add the pitch of the screw or of the scale: period = "10 mm"')
    period = within(document, (*keys, "period"), table.period, axis.dimension, 1e-6, 1e4)
    harmonics = 1 if table.harmonics is None else table.harmonics
    if not 1 <= harmonics <= MOST_HARMONICS:
        remedy = "Write 1 to {most}"
        raise DescriptionError("harmonics = {text} is not possible", remedy, text=shown(harmonics), most=MOST_HARMONICS)
    if axis.length / period * KNOTS_PER_WAVE * harmonics > MOST_BREAKS:
        waves = axis.length / period * harmonics
        what = "{waves:.0f} waves over the travel of {axis} are too many"
        remedy = "At most {most}; fewer harmonics, or a longer period"
        raise DescriptionError(what, remedy, waves=waves, axis=axis.name, most=MOST_BREAKS // KNOTS_PER_WAVE)
    turns = axis.length / period
    if axis.cyclic and abs(turns - round(turns)) > _TURN * turns:
        remedy = "A period that repeats in every turn"
        raise DescriptionError("{turns:.6g} periods make no whole turn", remedy, turns=turns)
    return Shaped(harmonics)


def _step(document: Document, keys: Keys, table: ErrorTable, axis: Axis) -> Shaped:
    if not table.at or len(table.at) > _MOST_JOINTS:
        remedy = 'Name 1 to {most} places: at = ["500 mm", "1000 mm"]'
        raise DescriptionError("it is not said where the pieces of the scale meet", remedy, most=_MOST_JOINTS)
    if axis.cyclic:
        remedy = "Give EXX_step to an axis that does not turn round"
        raise DescriptionError("a scale around {axis} closes", remedy, axis=axis.name)
    places = [within(document, (*keys, "at"), text, axis.dimension, -1e4, 1e4) for text in table.at]
    low, high = axis.travel
    ends = [low, *places, high]
    if any(after - before < 2 * JOINT for before, after in pairwise(ends)):
        what = "{places}: joints lie within the travel, one after the other"
        remedy = "{axis} goes from {travel}; leave 2 mm between them"
        raise DescriptionError(
            what, remedy, places=", ".join(shown(text) for text in table.at), axis=axis.name, travel=axis.travel_text
        )
    return Shaped(joints=tuple(places))
