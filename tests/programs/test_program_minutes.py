"""The minutes of a plan are those of its programs, as read back from their lines and run at the machine's speeds."""

from __future__ import annotations

import math
from functools import cache

import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.machine import load_machine
from axiscal.planning.next_readings import placed
from axiscal.planning.plan.plan import Plan
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import proposed
from axiscal.programs import controllers, dialect, programs
from axiscal_core.machine import Machine
from tests.generators.reaches import reach_of
from tests.programs.readers import READERS, Event, Halt, Mark, Move, Wait

CAMPAIGN = """
machine = "{machine}"
[programs]
dwell = true
{driven}
[target]
readings = 8
[[setups]]
name = "probe x"
instrument = "probe"
direction = "x"
{reach}reading_time = "{reading}"
settle = "0.2 s"
setup_time = "3 min"
approach = "{approach}"
[[setups]]
name = "probe z"
instrument = "probe"
direction = "z"
{reach}reading_time = "{reading}"
setup_time = "4 min"
approach = "both"
"""


@cache
def planned(machine: str, approach: str, driven: str) -> tuple[Case, Plan]:
    """Return a plan whose readings take so little time that the ways count."""
    reach = reach_of(load_machine(machine))
    text = CAMPAIGN.format(machine=machine, approach=approach, reading="0.1 s", reach=reach, driven=driven)
    case = Case(campaign_from_texts(text, "c.toml", load_machine(machine).text, "m.toml"))
    return case, proposed(case, Limits(readings=8), 100)


def run(events: list[Event], machine: Machine) -> float:
    """Return the seconds from the start with the instrument mounted to the last reading; stops take none."""
    mounted = max(k for k, event in enumerate(events) if isinstance(event, Halt))
    start = _where(events[:mounted], {})
    first = next(k for k, event in enumerate(events) if isinstance(event, Mark))
    begin = max(k for k in range(mounted, first + 1) if _where(events[mounted:k], start) == start)
    end = max(k for k, event in enumerate(events) if isinstance(event, Wait)) + 1
    at, seconds = dict(start), 0.0
    for event in events[begin:end]:
        if isinstance(event, Wait):
            seconds += event.seconds
        elif isinstance(event, Move):
            seconds += _move(event, at, machine)
            at.update(event.to)
    return seconds


def _where(events: list[Event], begin: dict[str, float]) -> dict[str, float]:
    """Return where the axes are after what a program does."""
    at = dict(begin)
    for event in events:
        at.update(event.to if isinstance(event, Move) else {})
    return at


def _move(move: Move, at: dict[str, float], machine: Machine) -> float:
    ways = {machine.axis(name): abs(to - at[name]) for name, to in move.to.items() if to != at[name]}
    if not ways:
        return 0.0
    length = math.hypot(*ways.values())
    unit = {axis: math.degrees(1) if axis.rotary else 1000.0 for axis in ways}
    push = min(unit[axis] * axis.acceleration * length / way for axis, way in ways.items())
    speed = min(move.feed / 60, math.sqrt(length * push))
    return length / speed + speed / push


DRIVEN = {
    "as usual": "",
    "over a clearance": 'clearance = "Z=390 mm"',
}


@pytest.mark.parametrize("controller", controllers())
@pytest.mark.parametrize(
    ("machine", "approach", "driven"),
    [
        ("three-axis-mill", "+", "as usual"),
        pytest.param("three-axis-mill", "both", "over a clearance", marks=pytest.mark.long),
        pytest.param("dmu60", "+", "over a clearance", marks=pytest.mark.long),
    ],
)
def test_a_program_takes_the_minutes_of_its_plan(machine: str, approach: str, controller: str, driven: str) -> None:
    case, plan = planned(machine, approach, DRIVEN[driven])
    description = case.description
    places = placed(case, plan)
    made = programs(description.machine, description.setups, places, dialect(controller))
    taken = sum(run(READERS[controller](program.text), description.machine) for program in made)
    mounted = {place.setup for place in places}
    mounting = sum(description.setup(name).setup_time for name in mounted)
    first = sum(program.readings[0].seconds for program in made)  # of a set-up: its way is part of the mounting
    assert taken == pytest.approx(plan.seconds - mounting + first, rel=0.01)
    assert len(made) == len(mounted)
