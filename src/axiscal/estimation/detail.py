"""Knots by evidence: where readings show finer detail than curves follow, their knots are halved.

Curves of one kind go together: displacements or angles, of linear or rotary axes. Descriptions are weighed by the same
readings, sizes integrated over. A quarter of the distance comes first: where it is no better, half of it is neither.
Of detail that half cannot follow the sizes take all for a rest. Knots that somebody stated stay, and so do those of an
inherited belief; so do those of a kind of which more would be added than numbers were read.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from axiscal.estimation.case import Case
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.learnt import posed
from axiscal.estimation.located import taken_as_normal
from axiscal.estimation.type_prior import carried_over
from axiscal.machine.description import Machine
from axiscal.measurement.setup import About
from axiscal.numerics import Array
from axiscal_core.draws import sized
from axiscal_core.problem import Problem
from axiscal_core.unknowns import space_of

_MOST = 96
"""Knots of a curve, as many as the realtime component for LinuxCNC takes."""
_CERTAIN = 5.0
"""Gain of log evidence: 2 log B > 10 is very strong (Kass and Raftery, J. Amer. Statist. Assoc. 90 (1995), 3.2)."""


def as_fine_as_shown(stated: Case, known: Estimation) -> Case:
    """Return the case with knots halved where readings are likelier with them; itself where none are.

    known : what the readings make known by it while others are to follow
    """
    names = _free(stated.description.machine)
    if not names or known.posterior is None or stated.inherited is not None:
        return stated
    judged, best = known.posterior.draws[0].problem, stated
    highest = _log_evidence(judged)
    for mine in names.values():
        once = _halved(best, mine)
        if once is best or once.errors.size - best.errors.size > len(judged.values):
            continue
        twice = _halved(once, mine)
        if (finest := _log_evidence(_posed(twice, known, judged))) < highest + _CERTAIN:
            continue
        fine = _log_evidence(_posed(once, known, judged))
        best, highest = (once, fine) if finest < fine + _CERTAIN else (twice, finest)
    return best


def _free(machine: Machine) -> dict[tuple[bool, bool], list[str]]:
    """Return the names of the curves whose knots nobody stated, by kind; none where a record of before fixed them."""
    found = dict[tuple[bool, bool], list[str]]()
    for entry in machine.errors if machine.fine_knots else ():
        if entry.follows_length:
            kind = machine.axis(entry.axis).rotary, entry.parts.angular
            found.setdefault(kind, []).append(entry.name)
    return found


def _halved(case: Case, names: Sequence[str]) -> Case:
    """Return the case with half the distance between knots of some curves; itself where one of them would have many."""
    machine = case.description.machine
    counts = {e.name: 2 * e.knot_count(machine.axis(e.axis)) - 1 for e in machine.errors if e.name in names}
    if max(counts.values()) > _MOST:
        return case
    errors = tuple(replace(e, knots=counts.get(e.name, e.knots)) for e in machine.errors)
    return replace(case, description=replace(case.description, machine=replace(machine, errors=errors)))


def _posed(finer: Case, known: Estimation, judged: Problem) -> Problem:
    """Return the readings of a problem by a case with other knots, linear where it has them so."""
    at = finer.shown_by(known.readings).linear_as(known.case)
    if at.about is not None:
        across, point = carried_over(known.case.errors, finer.errors), at.about.point
        size = known.case.errors.size
        carried: Array = np.concatenate([across.matrix @ point[:size], point[size:]])
        at = replace(at, about=About(carried, at.about.bent))
    whole = posed(at, taken_as_normal(known.absorbed, known.readings))
    return whole.only(np.isin(whole.reading, judged.reading))


def _log_evidence(problem: Problem) -> float:
    """Return log p(y), up to what is the same for all problems of the same readings: rests may count as noise."""
    return sized(space_of(problem)).log_evidence - float(np.sum(np.log(problem.noise)))
