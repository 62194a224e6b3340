"""Plans for rows: how much better they know them, where they end, and what a backlash needs."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.description.first_campaign import Purpose, first_campaign
from axiscal.estimation.case import Case
from axiscal.estimation.functionals.asked import asked_rows
from axiscal.estimation.known_rows import KnownRow, known_rows
from axiscal.machine import load_machine
from axiscal.measurement.reading import Place
from axiscal.measurement.reading_rows import blank_readings
from axiscal.planning.enough import reached_by
from axiscal.planning.gains.candidate_rows import Pool
from axiscal.planning.gains.running_gains import Scores
from axiscal.planning.next_readings import next_places, posed, rows_root
from axiscal.planning.other_readings import with_rooms
from axiscal.planning.plan.greedy import openings
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import proposed
from axiscal.present.plan_answer import reach_answer
from tests.generators.texts import setup_text

HOW_TO = Path(__file__).parents[2] / "docs" / "howto" / "dial-and-square.md"
DIAL = re.findall(r'```toml title="campaign.toml"\n(.*?)```', HOW_TO.read_text(), re.S)[0]


LASERS = """machine = "three-axis-mill"
[target]
TARGET
[[setups]]
name = "laser along X"
instrument = "interferometer"
direction = "x"
moves = ["X"]
raster = { X = "10 mm" }
approach = "both"
[[setups]]
name = "laser along Y"
instrument = "interferometer"
direction = "y"
moves = ["Y"]
raster = { Y = "10 mm" }
approach = "both"
"""


def case(text: str) -> Case:
    return Case(campaign_from_texts(text, "campaign.toml", load_machine("three-axis-mill").text, "three-axis-mill"))


def dial(target: str) -> Case:
    return case(DIAL.replace("readings = 12", target))


def planned(of: Case) -> tuple[Place, ...]:
    return next_places(of, of.knowledge, ())


def rows(of: Case, places: tuple[Place, ...]) -> dict[str, KnownRow]:
    """Return how well the rows of a campaign are known after readings at places."""
    taken = blank_readings(of.description.setups, places)
    return {row.row.name: row for row in known_rows(of, of.knowledge.read(taken), taken)}


@pytest.mark.long
@pytest.mark.parametrize(("aligned", "times"), [("false", 1.1), ("true", 1.1)])
def test_twelve_readings_planned_for_squareness_know_it_better(aligned: str, times: float) -> None:
    """Against those planned for the volume; aligned, the squareness is most of what is left of that."""
    wanted = dial('readings = 12\nwants = ["squareness XY"]')
    volume = planned(dial(f"readings = 12\naligned = {aligned}"))
    own = planned(wanted)
    assert len(own) == len(volume) == 12
    here, there = (rows(wanted, places)["squareness XY"].known for places in (own, volume))
    assert there > times * here


def test_j_is_the_variance_over_the_squared_limit() -> None:
    """A limit that is half as wide weighs four times; of two rows J is the sum."""
    factor = dial("readings = 12").prior.factor
    one, half, other, both = (
        rows_root(dial(f"readings = 12\nwants = [{wants}]")).criterion(factor)
        for wants in (
            '"squareness XY 20 urad"',
            '"squareness XY 10 urad"',
            '"straightness X in Y 3 um"',
            '"squareness XY 20 urad", "straightness X in Y 3 um"',
        )
    )
    assert half == pytest.approx(4 * one, rel=1e-9)
    assert both == pytest.approx(one + other, rel=1e-9)
    of = dial('readings = 12\nwants = ["squareness XY 20 urad"]')
    (asked,) = asked_rows(of.description, (), whole=True)
    assert asked.map is not None
    drawn = factor[: of.errors.size] @ np.random.default_rng(1).standard_normal((factor.shape[1], 20_000))
    slopes = asked.map.rows(of.errors) @ drawn
    assert one == pytest.approx(np.mean(slopes**2) * (1.96 / 20e-6) ** 2, rel=0.03)


@pytest.mark.long
def test_a_plan_for_limits_has_as_many_readings_as_reach_them() -> None:
    noisy = DIAL.replace('"1 um"', '"6 um"')
    wide, tight = (case(noisy.replace("readings = 12", f'wants = ["squareness XY {u} urad"]')) for u in (60, 45))
    few, many = planned(wide), planned(tight)
    assert len(few) < len(many) < 60
    for of, places in ((wide, few), (tight, many)):
        assert rows(of, places)["squareness XY"].reached
    assert len(planned(replace_readings(tight, 7))) == 7


BAR = setup_text("test bar", "indicator", direction="x", moves=["Z"])


@pytest.mark.long
def test_a_plan_reaches_its_rows_although_backlash_takes_readings_of_its_own() -> None:
    target = 'wants = ["positioning X 8 um", "straightness Z in X 5 um", "backlash Y 3 um"]\nreadings = 60'
    of = case(LASERS.replace("TARGET", target) + BAR)
    places = proposed(of, Limits.of(of.description.target)).plan.places
    assert len(places) < 60
    assert reached_by(of, Limits.of(of.description.target), with_rooms(of, places))


@pytest.mark.long
def test_a_row_that_these_set_ups_cannot_make_known_is_named_before_the_first_reading() -> None:
    of = dial('wants = ["squareness XY 30 urad", "straightness X in Y 5 um"]')
    (square, _) = rows(of, ()).values()
    assert reach_answer(of) is None
    assert square.floor > 4e-6
    found = reach_answer(dial('wants = ["squareness XY 4 urad", "straightness X in Y 5 um"]'))
    assert found is not None
    (missed,) = found.missed
    assert missed.name == "squareness XY"
    assert missed.limit == pytest.approx(4.0)
    assert missed.floor == pytest.approx(1e6 * square.floor)


def test_three_readings_open_a_square() -> None:
    """Two zeros, and how the square lies turned: a single reading after these tells of the squareness."""
    of = dial("readings = 12")
    task = posed(of, of.knowledge)
    scores = Scores(Pool(task.observation, task.lattice), task.state)
    opened, found = openings(scores, (0, 1), 12)
    assert len(found) == 3
    assert task.state.value - opened.state.value < 1e-4 * task.state.value
    assert opened.gains.max() > 0.05 * task.state.value
    assert openings(opened, (0, 1), 12)[1] == []
    assert openings(scores, (0, 1), 2) == (scores, [])


@pytest.mark.long
def test_a_first_campaign_with_squares_plans_every_squareness() -> None:
    """As `init` writes it where every question is answered by Enter, but for the dial and the square."""
    text = first_campaign(dial("readings = 12").description.machine, "three-axis-mill", ["dial", "square"], Purpose())
    of = case(text)
    found = rows(of, planned(of))
    names = [f"squareness {pair}" for pair in ("XY", "XZ", "YZ")]
    assert set(names) <= set(found)
    wanting = case(text.replace("[target]", f"[target]\nwants = {names}".replace("'", '"')))
    wanted = rows(wanting, planned(wanting))
    for name in names:
        assert found[name].measured
        assert found[name].known < 1.5 * wanted[name].known


def replace_readings(of: Case, readings: int) -> Case:
    return Case(replace(of.description, target=replace(of.description.target, readings=readings)))


def test_two_places_at_least_are_read_from_both_sides_where_backlash_is_wanted() -> None:
    of = case(LASERS.replace("TARGET", 'readings = 12\nwants = ["positioning X", "backlash X", "backlash Y"]'))
    places = planned(of)
    assert len(places) == 12
    found = rows(of, places)
    for name, row in found.items():
        if name.startswith("backlash"):
            assert len(row.lines[0].both) >= 2
            assert row.measured
