"""The report where there is little, or too large to show."""

from __future__ import annotations

from pathlib import Path

import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.language.spoken import LANGUAGES, speaking
from axiscal.machine import load_machine
from axiscal.machine.questions import which_way
from axiscal.present.answer_of_campaign import answer_of
from axiscal.present.rendering import pdf
from axiscal.present.result import Result
from axiscal.present.result_of_campaign import result_of
from tests.generators.laser_axis import CASE
from tests.generators.results import golden_result
from tests.golden.surfaces import of_paper, plain, words_of


@pytest.fixture
def paper(tmp_path: Path) -> Path:
    """Where a report is written."""
    return tmp_path / "report.pdf"


def _said(result: Result, paper: Path) -> str:
    paper.write_bytes(pdf(result, {}))
    return of_paper(paper)


def test_a_campaign_without_readings_has_a_report(paper: Path) -> None:
    with Campaign.create(paper.with_name("c.axiscal"), CASE.description) as campaign:
        result = result_of(campaign, known := campaign.estimate(ended=True), answer_of(campaign, known, {}))
    said = _said(result, paper)
    assert "NOREADINGSYET" in said
    for stated in (f"{result.rms_um:.3g}um", "foratoolof", "hardlytouchthem:EXX"):
        assert stated in said


def test_what_nobody_has_said_stands_in_it(paper: Path) -> None:
    asked = golden_result("iso_test/out", questions=which_way(load_machine("dmu60")))
    assert plain("Which way do C and B count?") in _said(asked, paper)


@pytest.mark.parametrize("size", [1e-300, 1e-12, 1e12, 1e150])
def test_extreme_figures_still_make_a_report(size: float, paper: Path) -> None:
    usual = golden_result("mill/out")
    errors = {"EXX": usual.errors["EXX"].model_copy(update={"mean": [size, -size, size], "std": [size] * 3})}
    constants = {"C0Y": usual.constants["C0Y"].model_copy(update={"mean": size, "std": size})}
    changed = {"errors": errors, "constants": constants, "rms_um": size, "worst_um": size, "budget": ()}
    said = _said(usual.model_copy(update=changed), paper)
    assert "C0Y" in said
    assert "nan" not in said


@pytest.mark.parametrize("language", sorted(LANGUAGES))
def test_the_first_page_is_short(language: str, paper: Path) -> None:
    with speaking(language):
        paper.write_bytes(pdf(golden_result("mill/out"), {}))
    assert len(words_of(paper, 1)) <= 190
