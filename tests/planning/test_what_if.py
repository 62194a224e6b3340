"""What if: every way starts from the same knowledge, and the traditional way is what it says."""

from __future__ import annotations

from pathlib import Path

import pytest

from axiscal.description.campaign import read_campaign
from axiscal.estimation.case import Case
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import Thoroughness
from axiscal.planning.what_if import PLANNED, TRADITIONAL, alternatives, traditional_readings
from axiscal.present.what_if_page import render

CAMPAIGN = """
machine = "one-axis"
[target]
readings = 6
[[setups]]
name = "laser"
instrument = "interferometer"
direction = "x"
[[setups]]
name = "dial <b>"
instrument = "indicator"
direction = "x"
approach = "-"
"""


@pytest.fixture
def case(tmp_path: Path) -> Case:
    path = tmp_path / "campaign.toml"
    path.write_text(CAMPAIGN)
    return Case(read_campaign(path))


def test_all_ways_start_alike_and_planning_is_not_worse(case: Case) -> None:
    told: list[str] = []
    found = alternatives(case, Limits(readings=6), Thoroughness(400), told.append)
    assert [each.name for each in found] == [PLANNED, "only laser", "only dial <b>", TRADITIONAL] == told
    assert [each.setups for each in found[1:3]] == [("laser",), ("dial <b>",)]
    assert all(each.bound is not None and each.bound <= each.rms[-1] for each in found[:-1])
    assert found[-1].bound is None
    assert len({round(each.rms[0], 12) for each in found}) == 1
    assert {each.readings for each in found} == {6}
    assert found[0].rms[-1] <= min(each.rms[-1] for each in found) * 1.001
    assert all(each.seconds[i] <= each.seconds[i + 1] for each in found for i in range(6))


def test_the_traditional_way_is_evenly_spaced_and_shared_between_the_set_ups(case: Case) -> None:
    readings = traditional_readings(case, 5)
    assert [r.setup for r in readings] == ["laser"] * 3 + ["dial <b>"] * 2
    assert [r.pose[0] for r in readings] == pytest.approx([1 / 6, 3 / 6, 5 / 6, 1 / 4, 3 / 4])
    assert [r.approach for r in readings] == [(1,)] * 3 + [(-1,)] * 2


def test_names_of_set_ups_are_no_markup_on_the_page(case: Case) -> None:
    page = render("Ways", alternatives(case, Limits(readings=2), Thoroughness(100), lambda _: None))
    assert "dial <b>" not in page
    assert "dial &lt;b&gt;" in page
    assert 'src="http' not in page


def test_instruments_are_compared_where_several_set_ups_share_one(tmp_path: Path) -> None:
    path = tmp_path / "campaign.toml"
    more = '[[setups]]\nname = "dial along y"\ninstrument = "indicator"\ndirection = "y"\n'
    path.write_text(CAMPAIGN + more)
    found = alternatives(Case(read_campaign(path)), Limits(readings=3), Thoroughness(60), lambda _: None)
    assert [each.name for each in found][1] == "only indicator, 2 set-ups"
    assert set(found[1].setups) <= {"dial <b>", "dial along y"}
