"""What a plan, the next reading, or a renewed plan of each kind of example asks for can be taken as its text says."""

import re
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.exceptions import PlanError, ProgramError
from axiscal.machine import builtin_names, load_machine
from axiscal.measurement.reading import Place, Reading
from axiscal.planning.next_readings import next_places, placed
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import proposed
from axiscal.programs import Program, controllers, dialect, programs
from tests.generators.campaigns import built_in
from tests.generators.printed_machine import printed_machine
from tests.generators.said_places import Said
from tests.generators.ways_said import WaysSaid

ROOT = Path(__file__).resolve().parents[2]
KINDS = ("ball_bar", "five_axes", "printer", "rotary", "square", "tracker")
"""Golden campaigns with an instrument that the others have not."""
FOLDERS = (
    *("src/axiscal/present/demo", "tests/linuxcnc/machines", "examples"),
    *(f"tests/golden/campaigns/{kind}" for kind in KINDS),
)
FILES = sorted(
    path
    for folder in FOLDERS
    for path in (ROOT / folder).rglob("*.toml")
    if re.search(r"^\[\[setups\]\]", path.read_text(encoding="utf-8"), re.MULTILINE)
)
PAGES = sorted([ROOT / "README.md", *(ROOT / "docs").rglob("*.md")])


def blocks() -> list[tuple[str, str]]:
    """Return the whole campaigns that the pages print, with where each stands."""
    found = []
    for page in PAGES:
        for number, text in enumerate(re.findall(r"```toml\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)):
            if re.search(r"^machine = ", text, re.MULTILINE) and "[[setups]]" in text:
                found.append((f"{page.name} {number}", text))
    return found


BALL = '[[artefacts]]\nname = "ball"\nballs = { one = ["150 mm", "0 mm", "0 mm"] }\n'
AT_BALL = 'instrument = "rtest"\nartefact = "ball"\nmoves = ["{}"]\nraster = {{ {} = "10 deg" }}\n'
BAR = 'instrument = "ballbar"\nlength = "150 mm"\nstation = ["0 mm", "0 mm", "100 mm"]\nplane = "xy"\n'
STANDARD = {
    "circle with C in step": (
        "",
        BAR + 'arc = ["10 deg", "200 deg"]\nturning = { C = 1.0 }\nraster = { arc = "10 deg" }\n',
    ),
    "CK": (BALL, AT_BALL.format("C", "C")),
    "BK": (BALL, AT_BALL.format("B", "B")),
}
"""Tests of ISO 10791-6: a circle with a rotary axis in step, and a point that is held while one axis turns."""


def standard() -> list[tuple[str, str]]:
    """Return the tests of the standard as campaigns."""
    head = 'machine = "dmu60"\n{}[[setups]]\nname = "{}"\n{}approach = "both"\n'
    return [(f"ISO 10791-6, {name}", head.format(beside, name, keys)) for name, (beside, keys) in STANDARD.items()]


_FEW = 4
"""Readings of a plan: every one of more would be held to the same rules."""
CAMPAIGNS = [(str(path.relative_to(ROOT)), path.read_text(encoding="utf-8")) for path in FILES] + blocks() + standard()
_AT_ONCE = {"tests/golden/campaigns/printer/campaign.toml", "ISO 10791-6, CK"}
"""Those whose plans take the least time; the others are left to `make test-long`."""
CASES = [
    pytest.param(name, text, id=name, marks=() if name in _AT_ONCE else pytest.mark.long) for name, text in CAMPAIGNS
]


def described(name: str, text: str) -> CampaignDescription:
    machine = tomllib.loads(text)["machine"]
    beside = ROOT / name if (ROOT / name).is_file() else None
    if machine in builtin_names() or beside is None:
        return campaign_from_texts(text, name, load_machine(machine).text, machine)
    path = beside.parent / machine
    return campaign_from_texts(text, name, path.read_text(encoding="utf-8"), str(path))


def plans(case: Case) -> list[tuple[Place, ...]]:
    """Return what is asked for at first, what while measuring, and what after some readings with a part of it left."""
    first = placed(case, proposed(case, Limits(readings=_FEW), 60))
    coming = next_places(case, case.knowledge, ())
    taken = [_read(case, place) for place in coming[:2]]
    renewed = next_places(case, case.knowledge.read(taken), taken, left=coming[2:])
    return [first, coming, renewed]


def _read(case: Case, place: Place) -> Reading:
    """Return a reading of nothing: where others are to be taken does not depend on its value."""
    values = len(case.description.setup(place.setup).names)
    return Reading(place.setup, place.pose, place.approach, 0.0, others=(0.0,) * (values - 1), time=0.0)


@pytest.mark.parametrize(("name", "text"), CASES)
def test_every_reading_of_an_example_can_be_taken(name: str, text: str) -> None:
    campaign = described(name, text)
    if any(setup.lacks for setup in campaign.setups):
        with pytest.raises(PlanError):
            proposed(Case(campaign), Limits(readings=1), 50)
        return
    said = Said(text, printed_machine(campaign.machine.text))
    short = replace(campaign, target=replace(campaign.target, readings=_FEW, rms=None, worst=None, expanded=None))
    for places in plans(Case(short)):
        assert places
        for place in places:
            said.holds(place)
        _programs_hold(campaign, said, places, controllers()[len(name) % len(controllers())])


def _made(campaign: CampaignDescription, places: tuple[Place, ...], controller: str) -> tuple[Program, ...]:
    """Return the programs; none where the control has no axis of such a name, or the instrument stays in touch."""
    try:
        return programs(campaign.machine, campaign.setups, places, dialect(controller))
    except ProgramError as refused:
        if not re.search("no axis|stays in touch", str(refused)):
            raise
        return ()


def _programs_hold(campaign: CampaignDescription, said: Said, places: tuple[Place, ...], controller: str) -> None:
    """Assert that the programs go there, read again word by word."""
    for program in _made(campaign, places, controller):
        setup = program.readings[0].setup.name
        planned = {k: np.array(place.pose) for k, place in enumerate(places, start=1) if place.setup == setup}
        assert WaysSaid(said, setup, controller).holds(program.text, planned) == len(planned) - 1


def test_a_plan_of_a_record_of_before_is_refused_with_the_keys_of_every_set_up() -> None:
    """Descriptions that a record holds are read as they are; only what is asked for must say where."""
    nest = '[[setups]]\nname = "nest"\ninstrument = "rtest"\n'
    bar = '[[setups]]\nname = "bar"\ninstrument = "ballbar"\nstation = ["0 mm", "0 mm", "100 mm"]\n'
    both = 'In "nest": write artefact = .* In "bar": write length = "150 mm"'
    for setups, said in ((nest + bar, both), (nest, "Write artefact = ")):
        case = Case(built_in(setups, "dmu60"))
        with pytest.raises(PlanError, match=said):
            next_places(case, case.knowledge, ())
