"""Plans for rows: how much better they know them, where they end, and what a backlash needs."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from axiscal.estimation.case import Case
from axiscal.estimation.functionals.asked import asked_rows
from axiscal.estimation.known_rows import known_rows
from axiscal.measurement.reading_rows import blank_readings
from axiscal.planning.next_readings import placed, posed, rows_root
from axiscal.planning.plan.greedy import openings
from axiscal.planning.plan.scores import Scores
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import proposed
from tests.generators.campaigns import built_in
from tests.generators.texts import Said, campaign_text, setup_text

HOW_TO = Path(__file__).parents[2] / "docs" / "howto" / "dial-and-square.md"
DIAL = re.findall(r'```toml title="campaign.toml"\n(.*?)```', HOW_TO.read_text(), re.S)[0]


LASERS = "".join(
    setup_text(
        f"laser along {axis}",
        "interferometer",
        direction=axis.lower(),
        moves=[axis],
        raster={axis: "10 mm"},
        approach="both",
    )
    for axis in "XY"
)


def dial(target: str) -> Case:
    return Case(built_in(DIAL.replace("readings = 12", target)))


def test_j_is_the_variance_over_the_squared_limit() -> None:
    """A limit that is half as wide weighs four times; of two rows J is the sum."""
    factor, size = dial("readings = 12").prior.factor, dial("readings = 12").errors.size
    one, half, other, both = (
        float(np.sum((rows_root(dial(f"readings = 12\nwants = [{wants}]")) @ factor[:size]) ** 2))
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


def test_three_readings_open_a_square() -> None:
    """Two zeros, and how the square lies turned: a single reading after these tells of the squareness."""
    of = dial("readings = 12")
    task = posed(of, of.knowledge)
    scores = Scores(task)
    opened, found = openings(scores, (0, 1), 12)
    assert len(found) == 3
    assert task.state.value - opened.value < 1e-4 * task.state.value
    assert opened.gains.max() > 0.05 * task.state.value
    assert openings(opened, (0, 1), 12)[1] == []
    assert openings(scores, (0, 1), 2) == (scores, [])


def test_two_places_at_least_are_read_from_both_sides_where_backlash_is_wanted() -> None:
    target: dict[str, Said] = {"readings": 12, "wants": ["positioning X", "backlash X", "backlash Y"]}
    of = Case(built_in(campaign_text("three-axis-mill", LASERS, target=target)))
    places = placed(of, proposed(of, Limits.of(of.description.target), 200))
    assert len(places) == 12
    taken = blank_readings(of.description.setups, places)
    for row in known_rows(of, of.knowledge.read(taken), taken):
        if row.row.kind == "backlash":
            assert len(row.lines[0].both) >= 2
            assert row.measured
