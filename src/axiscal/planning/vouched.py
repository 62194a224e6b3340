"""What readings can vouch for, in words and as rows of a document."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from axiscal.accuracy.other_tool import other_tool
from axiscal.design.plan.guarded import Enough
from axiscal.design.plan.plan import Plan
from axiscal.error_model.gauge_words import reading_that_shows
from axiscal.estimation.case import Case
from axiscal.estimation.defence import Defence, Departed, defence
from axiscal.estimation.scatter import Scatter
from axiscal.estimation.slips import Slip
from axiscal.estimation.statements import Resting, Statement
from axiscal.language.spoken import capital, counted, later, listed, put, said
from axiscal.measurement.departures import Family
from axiscal.measurement.instrument import INSTRUMENTS, values_of
from axiscal.measurement.place_texts import place_read
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.planning.next_readings import guarding
from axiscal.units import said_quantity, to_unit

_NAMED = 3
"""Departures in a sentence that is read."""
_WORDS: Mapping[Family, str] = MappingProxyType(
    {
        "drift": later('a drift of "{owner}"'),
        "levelling": later('a drift of "{owner}"'),
        "excursion": later('a zero of "{owner}" that comes and goes'),
        "growth": later("a growth of {owner} that comes and goes"),
        "step": later("a step in {owner}"),
        "pitch": later("an error of {owner} within a turn of its screw"),
        "bump": later("a detail of {owner}"),
        "detail": later("a detail of {owner} narrower than its knots are apart"),
        "reversal": later("a reversal that varies, {owner},"),
        "together": later("what two axes do together, {owner},"),
    }
)
_SHOWN_BY: Mapping[Family, str] = MappingProxyType(
    {
        "drift": later('The first places of "{owner}" read once more at its end would show a drift.'),
        "levelling": later('The first places of "{owner}" read once more at its end would show a drift.'),
        "excursion": later(
            'Places of "{owner}" read again later, or every other one in a second round, would show that.'
        ),
        "growth": later("Places read again later, or every other one in a second round, would show that in {owner}."),
        "step": later("Readings in the widest gaps would show a step in {owner}."),
        "pitch": later("Places out of step with the screw would show that in {owner}."),
        "bump": later("Readings in the widest gaps would show a detail of {owner}."),
        "detail": later("Readings in the widest gaps would show a detail of {owner}."),
        "reversal": later("Places read from both sides, in more parts of the travel, would show that in {owner}."),
        "together": later("Places spread over both axes would show {owner}."),
    }
)
"""What shows a departure of which these readings would show no size."""


@dataclass(frozen=True, slots=True)
class Vouched:
    """What the readings can vouch for: defended, um, a standard uncertainty; words : the same in a sentence.

    departures : rows of `result.json`
    """

    defended: float
    words: str
    departures: Sequence[Mapping[str, Any]] = ()


def vouched_by_plan(case: Case, plan: Plan) -> Defence:
    """Return what the readings of a plan can vouch for, each taken when it is planned."""
    readings = _planned(case, plan)
    return defence(case, readings, plan.accuracy.rms, case.description.machine)


def other_tool_words(case: Case, plan: Plan) -> str:
    """Return what a plan leaves with a longer tool than the one it is read with, "" where it is as good."""
    known = case.knowledge.read(_planned(case, plan))
    yardstick = case.yardstick
    return other_tool(case.errors, known.belief, yardstick.box, counted=yardstick.counted).words


def _planned(case: Case, plan: Plan) -> list[Reading]:
    setups = case.description.setups
    rows = zip(plan.places.setups.tolist(), plan.places.poses.tolist(), plan.places.approaches.tolist(), strict=True)
    readings = []
    for (setup, pose, approach), planned in zip(rows, plan.readings, strict=True):
        others = (0.0,) * (values_of(setups[setup]) - 1)
        side = tuple(int(each) for each in approach)
        readings.append(Reading(setups[setup].name, tuple(pose), side, 0.0, others=others, time=planned.seconds))
    return readings


def vouched_words(case: Case, found: Defence) -> str:
    """Return in sentences what readings can vouch for, and what they could not show if that is much more."""
    parts, size = [], said_quantity(found.u_def, "um")
    rests_on, scatter = rests_on_too_much(found), scatters_too_much(found)
    if _open(found) or (rests_on is None and scatter is None):
        parts.append(_shown_words(case, found))
    if rests_on is not None:
        parts.append(_statements_words(case, found, rests_on, "" if parts else size))
    if scatter is not None:
        parts.append(_scatter_words(case, found, scatter, "" if parts else size))
    if believed := found.believed:
        parts.append(_believed_words(case, found.readings, believed))
    return listed(" ", parts)


def rests_on_too_much(found: Defence) -> Resting | None:
    """Return the statements that spoil a promise, None where none do."""
    return found.rests_on if found.rests_on is not None and found.rests_on.bearable > found.promise else None


def scatters_too_much(found: Defence) -> Scatter | None:
    """Return the noise that spoils a promise, None where none does."""
    return found.scatter if found.scatter is not None and found.scatter.bearable > found.promise else None


def _scatter_words(case: Case, found: Defence, scatter: Scatter, size: str) -> str:
    """Return which noise readings do not tell from the machine, and what would tell.

    size : what can be vouched for in all, "" where that is said already
    """
    setup = case.description.setups[scatter.setup]
    noise = said_quantity(scatter.std, _unit_read(setup))
    remedy = counted("Read {count} place once more.", "Read {count} places once more.", scatter.lacking)
    if not size:
        too = 'They do not tell the noise of "{setup}" ({noise}) from what the machine does from place to place either.'
        return put("{what} {remedy}", what=said(too, setup=setup.name, noise=noise), remedy=remedy)
    what = counted(
        'This {count} reading does not tell the noise of "{setup}" ({noise}) from what the machine does from place to '
        "place; what can be vouched for is a standard uncertainty of {size}.",
        'These {count} readings do not tell the noise of "{setup}" ({noise}) from what the machine does from place to '
        "place; what can be vouched for is a standard uncertainty of {size}.",
        found.readings,
        setup=setup.name,
        noise=noise,
        size=size,
    )
    return put("{what} {remedy}", what=what, remedy=remedy)


def _believed_words(case: Case, readings: int, believed: Sequence[Slip]) -> str:
    """Return how many readings would be believed though they are bad, the worst of them, and what would show it."""
    reading, harm = believed[0].reading, believed[0].harm
    setup = case.description.setup(reading.setup)
    size = harm.seen_from if math.isfinite(harm.seen_from) else harm.most
    return counted(
        "{count} of the {readings} readings would be believed if it were bad, the one at {place}: it is surely shown "
        "only where it is off by more than {size}. One beside it, or the same once more, would show that one of both "
        "is wrong.",
        "{count} of the {readings} readings would be believed if they were bad. The one at {place} would do most harm: "
        "it is surely shown only where it is off by more than {size}. One beside it, or the same once more, would show "
        "that one of both is wrong.",
        len(believed),
        readings=readings,
        place=place_read(case.observation.machine.axes, setup, reading),
        size=said_quantity(size, _unit_read(setup), 2),
    )


def _statements_words(case: Case, found: Defence, rests_on: Resting, size: str) -> str:
    """Return which statements a promise rests on, how much of it, and what would show them.

    size : what can be vouched for in all, "" where that is said already
    """
    named, share = listed(", ", [_stated(case, each) for each in rests_on.named[:_NAMED]]), float(rests_on.share)
    if not size:
        too = "They leave as stated {named}, too: {share:.0%} of the promised variance rests on what is stated alone."
        return put("{what} {remedy}", what=said(too, named=named, share=share), remedy=_remedy(case, rests_on))
    what = counted(
        "This {count} reading leaves as stated {named}: {share:.0%} of the promised variance rests on what is stated "
        "alone, and what can be vouched for is a standard uncertainty of {size}.",
        "These {count} readings leave as stated {named}: {share:.0%} of the promised variance rests on what is stated "
        "alone, and what can be vouched for is a standard uncertainty of {size}.",
        found.readings,
        named=named,
        share=share,
        size=size,
    )
    return put("{what} {remedy}", what=what, remedy=_remedy(case, rests_on))


def _remedy(case: Case, rests_on: Resting) -> str:
    best = rests_on.shown_by
    if not best:
        return _shown_otherwise(case, rests_on)
    if set(best) <= set(rests_on.named):
        if len(best) > 1:
            return said("Measured by themselves and stated closer they would leave less.")
        return said("Measured by itself and stated closer it would leave less.")
    unknown = listed(", ", [_stated(case, each) for each in best[:_NAMED]])
    return said("They would show it with {unknown} known better than that.", unknown=unknown)


def _shown_otherwise(case: Case, rests_on: Resting) -> str:
    """Return which reading would show the first of the errors, in the words for what cannot be seen."""
    name = next((each.name for each in rests_on.named if each.setup is None), None)
    if name is None:
        return said("Only another set-up would show it.")
    reading = capital(reading_that_shows(case.errors, case.errors.names[name]))
    return said("{reading} would show {name}.", reading=reading, name=name)


def _stated(case: Case, each: Statement) -> str:
    """Return an unknown and how well it is stated."""
    size = said_quantity(each.std, _unit_of(case, each))
    if each.setup is None:
        return put("{name} ({size})", name=each.name, size=size)
    return said('{name} of "{owner}" ({size})', name=each.name, owner=each.owner, size=size)


def _unit_of(case: Case, each: Statement) -> str:
    if each.setup is None:
        return "urad" if case.errors.names[each.name].angular else "um"
    setup = case.description.setups[each.setup]
    return case.unit_of(setup, next(own for own in setup.unknowns if own.name == each.name))


def _shown_words(case: Case, found: Defence) -> str:
    size, open_ones = said_quantity(found.u_def, "um"), _open(found)
    if not open_ones:
        one = "{count} reading could vouch for {size} (standard uncertainty)."
        many = "{count} readings could vouch for {size} (standard uncertainty)."
        return counted(one, many, found.readings, size=size)
    alike: dict[str, Departed] = {}
    for each in open_ones:  # a drift that levels off is a drift, too: of the same words the one that is seen last
        named = said(_WORDS[each.family], owner=each.owner)
        alike[named] = max(alike.get(named, each), each, key=lambda one: one.seen_from)
    shown = [_limit(case, each) for each in alike.values()]
    never = next((each for each in list(alike.values())[:_NAMED] if not math.isfinite(each.seen_from)), None)
    remedy = [] if never is None else [said(_SHOWN_BY[never.family], owner=never.owner)]
    could = counted(
        "This {count} reading could not show {named}; what they can vouch for is a standard uncertainty of {size}.",
        "These {count} readings could not show {named}; what they can vouch for is a standard uncertainty of {size}.",
        found.readings,
        named=listed(", ", shown[:_NAMED]),
        size=size,
    )
    return listed(" ", [could, *remedy])


def enough_words(enough: Enough | None) -> str:
    """Return in a sentence how many readings could vouch for what they promise; nothing where that is not known."""
    if enough is None:
        return ""
    return f" {_counted(enough.readings)} could vouch for {to_unit(enough.vouched, 'um'):.3g} um."


def unguarded_words(case: Case, found: Defence) -> str:
    """Return why readings that leave much unshown were not chosen otherwise; nothing where they were, or leave little.

    found : what the readings of a plan can vouch for
    """
    if guarding(case) or not found.leaves:
        return ""
    criterion = case.description.target.criterion
    if criterion != "volume":
        return (
            f'criterion = "{criterion}" chooses readings by the model alone; with criterion = "volume" they are chosen '
            "for what they can vouch for."
        )
    return (
        "readings that are to teach how much two axes do together are chosen by the model alone; with the std and "
        'length of the plane stated, and scales = "stated", they are chosen for what they can vouch for.'
    )


def vouched_of(case: Case, found: Defence) -> Vouched:
    """Return what readings can vouch for, in the units of outsiders."""
    return Vouched(to_unit(found.u_def, "um"), vouched_words(case, found), departure_rows(case, found))


def departure_rows(case: Case, found: Defence) -> list[dict[str, Any]]:
    """Return the departures of a document, the most damaging first; before them what a promise rests on too much."""
    rests_on, scatter = rests_on_too_much(found), scatters_too_much(found)
    rows = [] if rests_on is None else [_statement_row(case, rests_on)]
    rows += [] if scatter is None else [_scatter_row(case, scatter)]
    for each in found.departures:
        unit = _unit(case, each)
        rows.append(
            {
                "name": f"{each.family} {each.owner}",
                "power": _figure(each.power),
                "seen_from_um": _figure(to_unit(each.seen_from, unit)) if math.isfinite(each.seen_from) else None,
                "damage_um": _figure(to_unit(each.damage, "um")),
                "hidden": _figure(each.hidden),
                "bearable_um": _figure(to_unit(each.bearable, "um")),
                "unit": unit,
                "counted": each.counted,
            }
        )
    return rows


def _statement_row(case: Case, rests_on: Resting) -> dict[str, Any]:
    return {
        "name": f"statement {' '.join(each.name for each in rests_on.named)}",
        "power": 0.0,
        "seen_from_um": None,
        "damage_um": _figure(to_unit(rests_on.effect, "um")),
        "hidden": _figure(rests_on.hidden),
        "bearable_um": _figure(to_unit(rests_on.bearable, "um")),
        "unit": _unit_of(case, rests_on.named[0]),
        "counted": True,
    }


def _scatter_row(case: Case, scatter: Scatter) -> dict[str, Any]:
    setup = case.description.setups[scatter.setup]
    return {
        "name": f"noise {setup.name}",
        "power": 0.0,
        "seen_from_um": None,
        "damage_um": _figure(to_unit(scatter.effect, "um")),
        "hidden": 0.0,
        "bearable_um": _figure(to_unit(scatter.bearable, "um")),
        "unit": _unit_read(setup),
        "counted": True,
    }


def _figure(value: float) -> float:
    """Return six digits of a number."""
    return float(f"{value:.6g}")


def _counted(readings: int) -> str:
    return f"{readings} reading{'' if readings == 1 else 's'}"


def _open(found: Defence) -> list[Departed]:
    """Return what readings would not show and what does more than the promise allows, the most damaging first."""
    return [each for each in found.departures if each.exceeds(found.promise)]


def _limit(case: Case, each: Departed) -> str:
    """Return one departure and from where it would be seen."""
    named = said(_WORDS[each.family], owner=each.owner)
    if not math.isfinite(each.seen_from):
        return said("{departure} of any size", departure=named)
    return said("{departure} above {size}", departure=named, size=said_quantity(each.seen_from, _unit(case, each), 2))


def _unit(case: Case, each: Departed) -> str:
    """Return the unit of the size of a departure."""
    setups = {setup.name: setup for setup in case.description.setups}
    if each.owner in setups and each.family in ("drift", "levelling", "excursion", "bad"):
        return _unit_read(setups[each.owner])
    if each.family == "together":
        return "um"
    return "urad" if case.errors.names[each.owner].angular else "um"


def _unit_read(setup: Setup) -> str:
    return "um" if INSTRUMENTS[setup.instrument].reads == "length" else "urad"
