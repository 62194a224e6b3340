"""Every how-to and the page of studies are followed word for word, and every link of the docs leads somewhere."""

from __future__ import annotations

import re
from contextlib import chdir
from pathlib import Path

import pytest

from axiscal.cli.app import run
from axiscal.ports.study.study_case import FIGURES
from tests.docs.howtos import DOCS, PAGES, commands, draw, files, follow

_LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
_CODE = re.compile(r"```.*?```|`[^`\n]*`", re.DOTALL)


@pytest.mark.long
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_how_to_can_be_followed_word_for_word(page: Path, tmp_path: Path) -> None:
    done = follow(page, tmp_path)
    assert done
    assert [(words, status) for words, status in done if status != 0] == []
    assert any((tmp_path / name).exists() for name in ("rehearsal/report.pdf", "where.svg"))


@pytest.mark.parametrize("page", [page for page in PAGES if page.stem != "tour"], ids=lambda page: page.stem)
def test_its_picture_is_that_of_its_set_ups(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    kept = (DOCS / "pictures" / f"{page.stem}.svg").read_text(encoding="utf-8")
    (tmp_path / "docs" / "pictures").mkdir(parents=True)
    monkeypatch.setattr("tests.docs.howtos.DOCS", tmp_path / "docs")
    draw(page, tmp_path)
    assert (tmp_path / "docs" / "pictures" / f"{page.stem}.svg").read_text(encoding="utf-8") == kept


def test_what_the_board_s_page_shows_stands_in_the_files_that_init_writes(tmp_path: Path) -> None:
    page = DOCS / "howto" / "tonight.md"
    for name, text in files(page).items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    with chdir(tmp_path):
        assert all(run(words[1:]) == 0 for words in commands(page) if words[1] == "init")
    written = "".join(path.read_text(encoding="utf-8") for path in tmp_path.rglob("*.toml"))
    shown = re.findall(r"^```toml\n(.*?)^```", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    lines = [line for block in shown for line in block.splitlines()]
    assert len(lines) == 4
    assert [line for line in lines if line not in written] == []


def _anchor(heading: str) -> str:
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


@pytest.mark.parametrize("page", sorted(DOCS.rglob("*.md")), ids=lambda page: page.stem)
def test_every_link_leads_to_a_file_and_a_heading(page: Path) -> None:
    lost = []
    for target in _LINK.findall(_CODE.sub("", page.read_text(encoding="utf-8"))):
        if re.match(r"https?:", target):
            continue
        name, _, anchor = target.partition("#")
        file = (page.parent / name).resolve() if name else page
        if not file.exists():
            lost.append(target)
        elif anchor and file.suffix == ".md":
            headings = re.findall(r"^#+ (.+)$", file.read_text(encoding="utf-8"), re.MULTILINE)
            if anchor not in {_anchor(heading) for heading in headings}:
                lost.append(target)
    assert lost == []


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
