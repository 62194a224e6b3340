"""The report page where there is little, too much or too large to show, and thousands of readings."""

from __future__ import annotations

import hashlib
import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from axiscal.errors.iso230 import words
from axiscal.estimation.promise.agreement import Agreement
from axiscal.exceptions import SummaryError
from axiscal.language.spoken import speaking
from axiscal.machine import load_machine
from axiscal.machine.questions import which_way
from axiscal.present.rendering import pdf, render
from axiscal.present.result_document import LISTED, readings_csv, result_json
from axiscal.present.summary import ConstantSummary, CurveSummary, HistoryRow, Summary, Uncertainty
from tests.generators.answers import answer
from tests.present.test_page import five_axis_summary

EXPANDED = Uncertainty(23.4, (11.0, 12.0, 13.0), 51.0, 1.65, "for a tool of 120 mm")


def _bare(**changes: Any) -> Summary:
    first = HistoryRow(0, None, None, None, None, None, 14.2, 31.0, 0.0)
    figures = 0, 0.0, 14.2, 31.0, 0.0, [first], EXPANDED, answer(verdict="nothing", readings=0, compared=0, minutes=0.0)
    empty = Summary("t", "m", "", "c.toml", "2026-03-14", [], "nothing measured", *figures)
    return replace(empty, **changes)


def _plain_curve(mean: list[float], std: float) -> CurveSummary:
    size = len(mean)
    where = [float(n) for n in range(size)]
    return CurveSummary("EXX", "X", words("EXX"), where, mean, [std] * size, [std] * size, [std] * size, "mm", "um")


def test_a_campaign_without_readings_has_a_page() -> None:
    page = render(_bare(curves=[_plain_curve([0.0, 0.0], 9.0)]))
    assert "<strong>NO READINGS YET</strong>" in page
    stated = ("u", "14.2\u00a0µm"), ("U in space", "23.4\u00a0µm"), ("U along y", "± 12.0\u00a0µm")
    for name, size in stated:
        assert re.search(rf"<th>[^<]*{name}[^<]*</th><td>{size}</td>", page), name
    assert "<td>for a tool of 120 mm</td>" in page
    assert "hardly touched by the readings" in page
    assert "truth" not in page[: page.index("<script>")].split("</style>")[1].replace('"truth"', "")


def test_what_nobody_has_said_stands_on_the_page() -> None:
    assert "What nobody has said" not in render(_bare())
    assert "<li>Which way do C and B count?" in render(_bare(questions=which_way(load_machine("dmu60"))))


@pytest.mark.parametrize("size", [1e-300, 1e-12, 1e12, 1e150])
def test_extreme_figures_still_make_a_page(size: float) -> None:
    curve = _plain_curve([size, -size, size], size)
    constant = ConstantSummary("C0Y", words("C0Y"), size, size, size, "urad")
    page = render(_bare(curves=[curve], constants=[constant], rms_um=size, worst_um=size))
    assert page.count('class="picture"') == 3  # the curve, at three widths
    assert not re.search(r"\b(?:nan|inf)\b", page.split("<main>")[1].split("</main>")[0])


def test_a_figure_that_is_not_finite_is_refused_by_name() -> None:
    with pytest.raises(SummaryError, match="mean of EXX is nan"):
        render(_bare(curves=[_plain_curve([0.0, float("nan")], 1.0)]))


@pytest.mark.parametrize("field", ["mean", "std", "std_seen", "prior_std"])
def test_a_curve_whose_lengths_differ_is_refused_by_name(field: str) -> None:
    curve = replace(_plain_curve([0.0, 1.0], 1.0), **{field: [1.0]})  # type: ignore[arg-type]
    with pytest.raises(SummaryError, match=f"{field} of EXX has 1 values for 2 positions"):
        render(_bare(curves=[curve]))


CONTRADICT = "The readings contradict each other (p = 1e-09)"
AT_ODDS: dict[str, Any] = {"agreement": Agreement(24, 11, 80.0, 1e-9), "agreement_words": CONTRADICT}


def test_readings_that_contradict_each_other_leave_no_uncertainty() -> None:
    withheld = answer(verdict="contradict", withheld=True)
    summary = _bare(**AT_ODDS, answer=withheld, readings=24, curves=[_plain_curve([0.0], 9.0)])
    page, result = render(summary), result_json(summary)
    assert "<strong>READINGS CONTRADICT</strong>" in page
    assert f"<p>{AT_ODDS['agreement_words']}.</p>" in page
    assert "23.4" not in page
    assert "14.2\u00a0µm RMS" not in page
    assert f'<p class="mark">{CONTRADICT}</p>' in page
    assert [result[name] for name in ("U_um", "U_axis_um", "U_worst_um", "k", "rms_um", "worst_um")] == [None] * 6
    assert (result["agreement"]["contradict"], result["agreement"]["text"]) == (True, CONTRADICT)


def test_what_is_printed_anyway_says_on_each_page_that_readings_contradict() -> None:
    summary = _bare(**AT_ODDS, readings=24)
    assert result_json(summary)["U_um"] == 23.4
    assert f'<p class="mark">{CONTRADICT}</p>' in render(summary)
    assert 'class="mark"' not in render(_bare())


_MANY = LISTED + 3


@pytest.mark.parametrize("language", ["en", "de"])
def test_the_page_lists_the_first_ones_and_names_the_file_of_all(language: str) -> None:
    summary = five_axis_summary(_MANY)
    kept = readings_csv(summary)
    assert kept.count(b"\n") == _MANY + 1
    with speaking(language):
        page = render(summary)
    listing = page[page.index('<section id="details">') :]
    listing = listing[: listing.index("</table>")]
    assert [int(number) for number in re.findall(r'<td class="n">(\d+)</td><td>set-up', listing)] == [
        *range(1, LISTED + 1)
    ]
    assert hashlib.sha256(kept).hexdigest() in listing
    assert "data/readings.csv" in listing


@pytest.mark.long
def test_the_paper_does_the_same(tmp_path: Path) -> None:
    if shutil.which("pdftotext") is None:
        pytest.skip("Debian package poppler-utils is not installed")
    summary = five_axis_summary(_MANY)
    (tmp_path / "report.pdf").write_bytes(pdf(summary))
    command = ["pdftotext", "-layout", str(tmp_path / "report.pdf"), "-"]
    words = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    flat = re.sub(r"\s+", " ", words)
    assert f"The first {LISTED} of {_MANY} readings are listed here" in flat
    assert hashlib.sha256(readings_csv(summary)).hexdigest() in flat.replace(" ", "")
    numbers = [int(each) for each in re.findall(r"^\s*(\d+)(?: ×)?\s+set-up", words, re.MULTILINE)]
    assert numbers == [*range(1, LISTED + 1)]
