"""The report on paper: a whole PDF, the same again, every text as text; judged by poppler."""

from __future__ import annotations

import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from axiscal.present.rendering import pdf
from tests.generators.summaries import AT_ODDS, CONTRADICT, HOSTILE, bare, five_axis_summary, with_every_text


def _words(made: bytes, folder: Path) -> str:
    if shutil.which("pdftotext") is None:
        pytest.skip("Debian package poppler-utils is not installed")
    (folder / "report.pdf").write_bytes(made)
    done = subprocess.run(
        ["pdftotext", "-layout", str(folder / "report.pdf"), "-"], capture_output=True, text=True, check=True
    )
    return done.stdout


def test_the_same_summary_gives_the_same_bytes_and_a_pdf_for_archives() -> None:
    made = pdf(five_axis_summary(20))
    assert made.startswith(b"%PDF-")
    assert b"pdfaid:part" in made
    assert pdf(five_axis_summary(20)) == made


def test_what_is_signed_stands_in_it(tmp_path: Path) -> None:
    summary = five_axis_summary(20)
    words = _words(pdf(summary), tmp_path)
    for each in (
        summary.machine,
        "TARGET REACHED",
        "Statement of uncertainty",
        "set-up 3",
        "ISO 230-2, axis X",
        "x.comp",
        "All readings",
        "date, signature",
    ):
        assert each in words
    for name in summary.errors:
        assert name in words


def test_any_text_is_only_text(tmp_path: Path) -> None:
    attack = "#panic[x] $x$ *b* " + HOSTILE
    attacked = replace(with_every_text(five_axis_summary(3), attack), date="2026-03-14")
    assert "#panic[x] $x$ *b*" in _words(pdf(attacked), tmp_path)


def test_a_campaign_without_readings_can_be_printed(tmp_path: Path) -> None:
    assert "NO READINGS YET" in _words(pdf(bare()), tmp_path)


def test_readings_that_contradict_each_other_are_marked_on_each_page(tmp_path: Path) -> None:
    pages = _words(pdf(replace(five_axis_summary(20), **AT_ODDS)), tmp_path).split("\f")[:-1]
    assert len(pages) > 2
    assert all(CONTRADICT in page for page in pages)
