"""The report where there is little, or too large to show."""

from __future__ import annotations

from pathlib import Path

import pytest

from axiscal.language.spoken import LANGUAGES, speaking
from axiscal.machine import load_machine
from axiscal.machine.questions import which_way
from axiscal.present.rendering import pdf
from axiscal.present.result import Result
from tests.generators.answers import answer
from tests.generators.results import AT_ODDS, CONTRADICT, bare, constant, curve, five_axis_result
from tests.golden.surfaces import of_paper, plain, words_of


@pytest.fixture
def paper(tmp_path: Path) -> Path:
    """Where a report is written."""
    return tmp_path / "report.pdf"


def _said(result: Result, paper: Path, page: int | None = None) -> str:
    paper.write_bytes(pdf(result, {}))
    return of_paper(paper, page)


def test_a_campaign_without_readings_has_a_report(paper: Path) -> None:
    said = _said(bare(errors={"EXX": curve([0.0, 0.0], 9.0)}), paper)
    assert "NOREADINGSYET" in said
    for stated in ("14.2um", "Uinspace23.4um", "Ualongy±12.0um", "foratoolof120mm", "hardlytouchthem:EXX"):
        assert stated in said


def test_what_nobody_has_said_stands_in_it(paper: Path) -> None:
    assert plain("What nobody has said") not in _said(bare(), paper)
    asked = _said(bare(questions=which_way(load_machine("dmu60"))), paper)
    assert plain("Which way do C and B count?") in asked


@pytest.mark.parametrize("size", [1e-300, 1e-12, 1e12, 1e150])
def test_extreme_figures_still_make_a_report(size: float, paper: Path) -> None:
    errors, constants = {"EXX": curve([size, -size, size], size)}, {"C0Y": constant("C0Y", size, size, "urad")}
    said = _said(bare(errors=errors, constants=constants, rms_um=size, worst_um=size), paper)
    assert "C0Y" in said
    assert "nan" not in said


def test_readings_that_contradict_each_other_leave_no_uncertainty(paper: Path) -> None:
    withheld = answer(verdict="contradict", withheld=True)
    said = _said(bare(agreement=AT_ODDS, answer=withheld, readings=24, errors={"EXX": curve([0.0], 9.0)}), paper)
    assert "READINGSCONTRADICT" in said
    assert plain(CONTRADICT) in said


@pytest.mark.parametrize("language", sorted(LANGUAGES))
def test_the_first_page_is_short(language: str, paper: Path) -> None:
    with speaking(language):
        paper.write_bytes(pdf(five_axis_result(), {}))
    assert len(words_of(paper, 1)) <= 190
