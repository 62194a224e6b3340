"""The rows that set-ups can show, and those that would bring a target which no reading of a campaign can reach."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.description.first_campaign import setups_of
from axiscal.description.stated_type_b import lacks_temperature
from axiscal.description.target import RowName, Target, Want
from axiscal.estimation.accuracy.expanded import asked
from axiscal.estimation.case import Case
from axiscal.estimation.inheritance import case_of
from axiscal.estimation.known_rows import known_rows
from axiscal.exceptions import InputError, PlanError
from axiscal.language.spoken import joined, put, quoted, said
from axiscal.measurement.setup import Setup
from axiscal.measurement.type_b import MEASURED_TEMPERATURE, TEMPERATURE
from axiscal.planning.enough import enough, goal_of, reached_by
from axiscal.planning.next_readings import posed
from axiscal.planning.other_readings import with_rooms
from axiscal.planning.plan.plan import make_plan
from axiscal.planning.plan.task import Limits
from axiscal.units import said_quantity, to_unit
from axiscal_core.instrument import TOOL
from axiscal_core.normal import Normal

_KINDS = ("interferometer", "ballbar", "dial", "sphere")
"""Those whose set-ups follow from the machine alone, and of which nothing has to be looked up first."""
_TOGETHER = 2
"""Set-ups that are added at most: more are another campaign."""
_NEARER = 0.9
"""Share of what was missed: set-ups that leave more of it are not worth a word."""
_OF_TOOL = 5e-6
"""m: a presetter, or the master ball of the instrument, shows as much of the place of what is in the spindle."""
_CANDIDATES = 400
"""Enough for the readings and minutes of a plan that is only told."""


@dataclass(frozen=True, slots=True)
class Helping:
    """Set-ups that bring a target, by name, with the readings and minutes of a plan for all; 0 where none was made.

    reached : whether that plan reaches it; else it comes nearer, a plan within the readings and time allowed
    measured, tool : no set-up more is needed if the temperature is measured, or the place of what is in the spindle
    """

    setups: tuple[str, ...]
    readings: int
    minutes: float
    reached: bool
    measured: bool = False
    tool: bool = False


def rows_shown(description: CampaignDescription, rows: Iterable[RowName]) -> tuple[RowName, ...]:
    """Return those of some rows that endless readings of a campaign's set-ups would measure."""
    target = replace(description.target, wants=tuple(Want(row) for row in rows))
    case = case_of(replace(description, target=target))
    return tuple(row.row for row in known_rows(case, case.knowledge, ()) if row.reachable)


def helping_setups(case: Case, target: Target) -> Helping | None:
    """Return what would let a target be reached or come nearer: something measured, or set-ups; None for nothing."""
    case, added = replace(case, description=replace(case.description, target=target), sized_from=None), list[str]()
    missed = before = _missed(case)
    for name, measured in (("measured", _warmed), ("tool", _tooled)):
        setups = tuple(measured(setup) for setup in case.description.setups)
        if setups != case.description.setups and _missed(known := _of(case, setups)) < 1.0:
            return replace(_planned(known, ()), measured=name == "measured", tool=name == "tool")
    more = list(_not_there(case.description))
    for _ in range(min(_TOGETHER, len(more))):
        left = case.yardstick.left  # to see which one takes most away, the others need not be looked at again
        alone = replace(case, inherited=Normal.of_factor(np.zeros(len(left)), left))
        setup = min(more, key=lambda each: _missed(_of(alone, (each,))))
        more.remove(setup)
        added.append(setup.name)
        case = _of(case, (*case.description.setups, setup))
        missed = _missed(case)
        if missed < 1.0:
            return _planned(case, tuple(added))
    return Helping(tuple(added), 0, 0.0, reached=False) if missed < _NEARER * before else None


def _warmed(setup: Setup) -> Setup:
    """Return a set-up whose temperature is measured, as far from 20 °C as one that is not may be."""
    return replace(setup, warmer=TEMPERATURE.size) if lacks_temperature(setup) else setup


def _tooled(setup: Setup) -> Setup:
    """Return a set-up that knows the place of what is in the spindle."""
    unknowns = (replace(each, std=min(each.std, _OF_TOOL)) if each.name in TOOL else each for each in setup.unknowns)
    return replace(setup, unknowns=tuple(unknowns))


def helping_words(found: Helping) -> str:
    """Return in words what would help."""
    names = joined([quoted(name) for name in found.setups])
    if found.measured:
        names = said("the temperature (to {size})", size=said_quantity(MEASURED_TEMPERATURE.size, "K"))
    elif found.tool:
        names = put('tool_length = "{size}", tool_eccentricity = "{size}"', size=said_quantity(_OF_TOOL, "um"))
    text = "With {names} as well, {readings} readings reach it in {minutes} min."
    if not found.readings:
        text = "With {names} as well it can be reached." if found.reached else "With {names} as well it comes nearer."
    elif not found.reached:
        text = "With {names} as well it comes nearer: {readings} readings in {minutes} min."
    return said(text, names=names, readings=found.readings, minutes=put("{time:.3g}", time=found.minutes))


def _missed(case: Case) -> float:
    """Return how many times its limit is left: by the accuracy that comes nearest to its own, and the farthest row."""
    target = case.description.target
    volume = [each.floor / each.limit for each in asked(target, case.yardstick)]
    rows = known_rows(case, case.knowledge, ()) if target.lines else ()
    lines = [row.floor / row.goal for row in rows if row.limit is not None and row.row.kind != "volume"]
    return max([*([min(volume)] if volume else []), *lines])


def _of(case: Case, setups: tuple[Setup, ...]) -> Case:
    return replace(case, description=replace(case.description, setups=setups))


def _not_there(described: CampaignDescription) -> Iterator[Setup]:
    """Yield the set-ups of usual instruments that a campaign does not have."""
    names, head = {setup.name for setup in described.setups}, described.text.partition("[[setups]]")[0]
    for text in (text for kind in _KINDS for text in setups_of(described.machine, kind)):
        machine = described.machine.text, described.machine_source
        try:
            found = campaign_from_texts(f"{head}\n{text}", described.source, *machine).setups[-1]
        except InputError:  # an artefact of that name stands there already
            continue
        if found.name not in names:
            yield found


def _planned(case: Case, added: tuple[str, ...]) -> Helping:
    """Return set-ups that help with the readings and seconds of a plan."""
    limits = Limits.of(case.description.target)
    try:
        task = posed(case, case.knowledge, candidates=_CANDIDATES)
        heeded = enough(case, limits)
        made = make_plan(task, heeded, goal=goal_of(case, task, heeded), patience=0.0)
    except PlanError:
        return Helping(added, 0, 0.0, reached=True)
    met = reached_by(case, limits, with_rooms(case, made.places))
    return Helping(added, len(made.readings), to_unit(made.seconds, "min"), met)
