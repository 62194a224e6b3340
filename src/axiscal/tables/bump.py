"""A bump of 10 um in mid travel, alone in the files: two readings show which way a control takes its tables."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from axiscal.estimation.machine_estimate import Estimate, LeftUnknown
from axiscal.exceptions import TableError
from axiscal.language.spoken import said
from axiscal.machine.axis import letter_direction
from axiscal.units import format_quantity
from axiscal_core.normal import Normal
from axiscal_core.terms import Term

SIZE = 10e-6
"""m: a dial gauge shows it, and no tool feels it."""
_SURE = 1e-10
"""m, std of what is known: it is made up."""


def bumped(estimate: Estimate, controller: str, unstated: str) -> tuple[Estimate, str]:
    """Return an estimate of one bump and nothing else, and which two readings tell the sign.

    unstated : as of `Exporter`.  Raises TableError where the machine has no such error.
    """
    model, machine = estimate.model, estimate.machine
    ways = {letter_direction(axis.letter) for axis in machine.axes if not axis.rotary}

    def shows(function: Term) -> bool:
        axis = machine.axes[function.axis]
        own = function.component == letter_direction(axis.letter)
        moved = own if unstated == "own" else function.component in ways and not own
        return function.kind == "motion" and not axis.rotary and moved

    chosen = next(filter(shows, model.curves), None)
    if chosen is None:
        what = "no error of machine.toml goes into tables of {controller} whose sign is not stated"
        raise TableError(what, "Leave --probe-sign out", controller=controller)
    axis = machine.axes[chosen.axis]
    low, middle = axis.travel[0] + axis.overrun, sum(axis.travel) / 2  # from below is from within the travel
    ends, there = chosen.rows(np.array([low, middle]))
    mean, highest = np.zeros(model.size), int(np.argmax(there))
    mean[chosen.columns.start + highest] = axis.sign * SIZE / (there - ends)[highest]  # the tool is 10 um too far
    belief = Normal(mean, _SURE**2 * np.eye(model.size))
    places = [format_quantity(place, axis.unit, 6) for place in (low, middle)]
    readings = (
        "TWO READINGS TELL THE SIGN. Let {axis} come from below to {first} and to {second}, and read where the tool "
        "point is along {way}, once without these files and once with them. Give by how much more the second place "
        "has moved than the first: axiscal verify RECORD --to {controller} --bump LENGTH. It is -10 um if the control "
        "takes its tables as we suppose, and 10 um if it is the other way round."
    )
    way = "+" + "xyz"[chosen.component]
    told = said(readings, axis=axis.name, first=places[0], second=places[1], way=way, controller=controller)
    bare = replace(estimate, belief=belief, grid=None, rests={}, told=frozenset(), open=None, unknown=LeftUnknown())
    return bare, str(told)


def other_way(moved: float) -> bool:
    """Return whether a control takes its tables the other way round.  moved : m, by how much the bump moved the tool

    Raises TableError for a bump that did not come.
    """
    if not SIZE / 2 < abs(moved) < 2 * SIZE:
        what = "the bump moved the tool by {moved}, and -10 um or 10 um were expected"
        remedy = "Look whether its files are in force, and read both places again"
        raise TableError(what, remedy, moved=format_quantity(moved, "um", 3))
    return moved > 0
