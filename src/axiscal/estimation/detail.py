"""Knots by evidence: where readings show finer detail than curves follow, their knots are halved.

Curves of one kind go together: displacements or angles, of linear or rotary axes. Descriptions are weighed by the same
readings, sizes integrated over. A quarter of the distance comes first: where it is no better, half of it is neither.
Of detail that half cannot follow the sizes take all for a rest. Knots that somebody stated stay, and so do those of an
inherited belief. No kind gets more new knots than numbers were read.

A reversal that is one number becomes a curve likewise: a screw is worn where it works most. Columns of the sides times
the first powers of the position tell first whether that is worth weighing. Sizes are then those stated, and three times
these: those that are learnt swallow it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded, estimated, posed
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.inheritance import carried_over
from axiscal.estimation.promise.mistake import Sought
from axiscal.measurement.reading import Reading
from axiscal_core.draws import sized
from axiscal_core.machine import Machine
from axiscal_core.normal import Normal
from axiscal_core.problem import Problem
from axiscal_core.usual import LENGTH_OF_TRAVEL

_MOST = 96
"""Knots of a curve, as many as the realtime component for LinuxCNC takes."""
_CERTAIN = 5.0
"""Gain of log evidence: 2 log B > 10 is very strong (Kass and Raftery, J. Amer. Statist. Assoc. 90 (1995), 3.2)."""
_POWERS = 4
"""Of the position: a worn middle, and one end that is worn, take two; a narrower spot takes four."""
_TURNS = 3
"""Out and back twice: once, a drift looks the same."""
_KNOTS = 17
"""Of a reversal that varies: four to its length, as a fine curve has."""


def in_detail(stated: Case, readings: Sequence[Reading], so_far: Estimation | None = None) -> Estimation:
    """Return what readings make known, with knots as close as they ask for; the case called stated then has them, too.

    so_far : what the same readings make known while others are to follow
    """
    before = so_far or estimated(stated, readings)
    finer = as_fine_as_shown(stated, before)
    return concluded(finer, readings, before if finer is stated else None)


def as_fine_as_shown(stated: Case, known: Estimation) -> Case:
    """Return the case with knots halved where readings are likelier with them; itself where none are.

    known : what the readings make known by it while others are to follow
    """
    if not stated.description.era.fine_knots or known.posterior is None or stated.inherited is not None:
        return stated
    judged, best = known.posterior.draws[0].problem, stated
    names, uneven = _free(stated.description.machine), _uneven(known, judged)
    if not names and not uneven:
        return stated
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
    varying = _with(best, dict.fromkeys(uneven, _KNOTS))
    return varying if uneven and _log_evidence(_posed(varying, known, judged)) > highest + _CERTAIN else best


def _uneven(known: Estimation, problem: Problem) -> list[str]:
    """Return the reversals of one number each that seem to differ from place to place."""
    errors, found = known.case.errors, list[str]()
    terms = [term for term in errors.curves if term.kind == "reversal" and term.spline.size == 1]
    sought = Sought.of(problem) if terms else None
    poses = np.array([known.readings[reading].pose for reading in problem.reading])
    for term in terms:
        whole = problem.rows[:, problem.rows.shape[1] - problem.answered + term.columns.start]
        if np.count_nonzero(np.diff(np.sign(whole[whole != 0]))) < _TURNS:
            continue
        low, high = errors.axes[term.axis].travel
        along = (2 * poses[:, term.axis] - low - high) / (high - low)
        columns = whole * along ** np.arange(1, _POWERS + 1)[:, None]
        if sought is not None and sought.log_odds_of_columns(columns) > 0:
            found.append(term.name)
    return found


def _free(machine: Machine) -> dict[tuple[bool, bool], list[str]]:
    """Return the names of the curves whose knots nobody stated, by kind."""
    found = dict[tuple[bool, bool], list[str]]()
    for entry in machine.stated:
        if entry.free_knots:
            kind = machine.axis(entry.axis).rotary, entry.angular
            found.setdefault(kind, []).append(entry.name)
    return found


def _halved(case: Case, names: Sequence[str]) -> Case:
    """Return the case with half the distance between knots of some curves; itself where one of them would have many."""
    machine = case.description.machine
    counts = {e.name: 2 * e.count - 1 for e in machine.stated if e.name in names}
    return case if max(counts.values()) > _MOST else _with(case, counts)


def _with(case: Case, counts: Mapping[str, int]) -> Case:
    """Return the case with so many knots of some errors, by name."""
    machine = case.description.machine
    errors = tuple(
        replace(
            e, knots=counts[e.name], free_knots=False, length=e.length or LENGTH_OF_TRAVEL * machine.axis(e.axis).length
        )
        if e.name in counts
        else e
        for e in machine.stated
    )
    return replace(case, description=replace(case.description, machine=replace(machine, errors=errors)))


def _posed(finer: Case, known: Estimation, judged: Problem) -> Problem:
    """Return the readings of a problem by a case with other knots, linear where it has them so."""
    at = finer.shown_by(known.readings).linear_as(known.case)
    if at.about is not None:
        size = known.case.errors.size
        before = Normal.of_factor(at.about[:size], np.zeros((size, 1)))
        errors = carried_over(before, known.case.errors, finer.errors).mean
        at = replace(at, about=np.concatenate([errors, at.about[size:]]))
    whole = posed(at, known.history.normal)
    return whole.only(np.isin(whole.reading, judged.reading))


def _log_evidence(problem: Problem) -> float:
    """Return log p(y), up to what is the same for all problems of the same readings: rests may count as noise."""
    return sized(problem).log_evidence - float(np.sum(np.log(problem.noise)))
