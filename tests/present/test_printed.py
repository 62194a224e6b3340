"""The report on paper: a whole PDF, the same again, every text as text; judged by poppler."""

from __future__ import annotations

from pathlib import Path

from axiscal.present.rendering import pdf
from tests.generators.results import HOSTILE, golden_result, with_every_text
from tests.golden.surfaces import lines_of


def _words(made: bytes, folder: Path) -> str:
    (folder / "report.pdf").write_bytes(made)
    return lines_of(folder / "report.pdf")


def test_the_same_result_gives_the_same_bytes_and_a_pdf_for_archives() -> None:
    made = pdf(golden_result("iso_test/out"), {})
    assert made.startswith(b"%PDF-")
    assert b"pdfaid:part" in made
    assert pdf(golden_result("iso_test/out"), {}) == made


def test_any_text_is_only_text(tmp_path: Path) -> None:
    attack = "#panic[x] $x$ *b* " + HOSTILE
    found = golden_result("mill/out")
    codes = {"identity": {"begun": "2026-03-14", "place": attack}, "answer": found.answer, "rows": ()}
    attacked = with_every_text(found, attack).model_copy(update=codes)
    assert "#panic[x] $x$ *b*" in _words(pdf(attacked, {}), tmp_path)
