"""The report where there is little, too much or too large to show, and thousands of readings."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from pathlib import Path

import pytest

from axiscal.exceptions import SummaryError
from axiscal.language.spoken import LANGUAGES, speaking
from axiscal.machine import load_machine
from axiscal.machine.questions import which_way
from axiscal.present.rendering import pdf
from axiscal.present.result_document import readings_csv, result_json
from axiscal.present.summary import Summary
from tests.generators.answers import answer
from tests.generators.summaries import AT_ODDS, CONTRADICT, bare, five_axis_summary, written_constant, written_error
from tests.golden.surfaces import of_paper, plain, words_of


@pytest.fixture
def paper(tmp_path: Path) -> Path:
    """Where a report is written."""
    return tmp_path / "report.pdf"


def _said(summary: Summary, paper: Path, page: int | None = None) -> str:
    paper.write_bytes(pdf(summary))
    return of_paper(paper, page)


def test_a_campaign_without_readings_has_a_report(paper: Path) -> None:
    said = _said(bare(errors={"EXX": written_error([0.0, 0.0], 9.0)}), paper)
    assert "NOREADINGSYET" in said
    for stated in ("14.2um", "Uinspace23.4um", "Ualongy±12.0um", "foratoolof120mm", "hardlytouchedbythereadings"):
        assert stated in said


def test_what_nobody_has_said_stands_in_it(paper: Path) -> None:
    assert plain("What nobody has said") not in _said(bare(), paper)
    asked = _said(bare(questions=which_way(load_machine("dmu60"))), paper)
    assert plain("Which way do C and B count?") in asked


@pytest.mark.parametrize("size", [1e-300, 1e-12, 1e12, 1e150])
def test_extreme_figures_still_make_a_report(size: float, paper: Path) -> None:
    found = {"errors": {"EXX": written_error([size, -size, size], size)}}
    found |= {"constants": {"C0Y": written_constant("C0Y", size, size, "urad")}}
    said = _said(bare(**found, rms_um=size, worst_um=size), paper)
    assert "C0Y" in said
    assert "nan" not in said


def test_a_figure_that_is_not_finite_is_refused_by_name() -> None:
    with pytest.raises(SummaryError, match="mean of EXX of errors"):
        pdf(bare(errors={"EXX": written_error([0.0, float("nan")], 1.0)}))


def test_readings_that_contradict_each_other_leave_no_uncertainty(paper: Path) -> None:
    withheld = answer(verdict="contradict", withheld=True)
    summary = bare(**AT_ODDS, answer=withheld, readings=24, errors={"EXX": written_error([0.0], 9.0)})
    said, result = _said(summary, paper), result_json(summary)
    assert "READINGSCONTRADICT" in said
    assert plain(CONTRADICT) in said
    assert "23.4" not in said
    assert [result[name] for name in ("U_um", "U_axis_um", "U_worst_um", "k", "rms_um", "worst_um")] == [None] * 6
    assert (result["agreement"]["contradict"], result["agreement"]["text"]) == (True, CONTRADICT)


def test_what_is_printed_anyway_says_on_each_page_that_readings_contradict(paper: Path) -> None:
    summary = replace(five_axis_summary(20), **AT_ODDS)
    assert result_json(summary)["U_um"] == 3.3
    paper.write_bytes(pdf(summary))
    for page in range(1, 4):
        assert plain(CONTRADICT) in of_paper(paper, page)


@pytest.mark.parametrize("language", sorted(LANGUAGES))
def test_the_first_page_is_short(language: str, paper: Path) -> None:
    with speaking(language):
        paper.write_bytes(pdf(five_axis_summary()))
    assert len(words_of(paper, 1)) <= 190


LISTED = 1000
_MANY = LISTED + 3


@pytest.mark.long
def test_the_first_readings_are_listed_and_the_file_of_all_is_named(paper: Path) -> None:
    summary = five_axis_summary(_MANY)
    kept = readings_csv(summary)
    assert kept.count(b"\n") == _MANY + 1
    said = _said(summary, paper)
    assert plain(f"The first {LISTED} of {_MANY} readings are listed here") in said
    assert hashlib.sha256(kept).hexdigest() in said
    assert f"{LISTED}set-up" in said
    assert f"{LISTED + 1}set-up" not in said
