"""docs/study.md: its example is followed word for word, and gives the answer that the page shows."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from axiscal.ports.study.study_case import FIGURES
from tests.docs.howtos import DOCS, follow

PAGE = DOCS / "study.md"


@pytest.mark.long
def test_the_example_gives_an_answer_to_each_question_that_is_answered_there(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert [status for _, status in follow(PAGE, tmp_path)] == [0, 0]
    said = capsys.readouterr().out
    (shown,) = re.findall(r"^```text\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    compared = re.findall(r"^.* besides .*?: ", shown, re.MULTILINE)
    assert len(compared) == 2
    assert all(words in said for words in compared)
    assert (tmp_path / "results" / "study.html").is_file()


def test_every_figure_is_named() -> None:
    text = PAGE.read_text(encoding="utf-8")
    assert all(f"`{name}`" in text for name in FIGURES)
