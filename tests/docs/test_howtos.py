"""Every how-to and the page of studies are followed word for word, and every link of the docs leads somewhere."""

import csv
import re
import subprocess
import sys
from contextlib import chdir
from pathlib import Path

import pytest

from axiscal.cli.app import run
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


SLOW = {"tonight", "tracer-on-a-large-machine"}


@pytest.mark.parametrize(
    "page", [pytest.param(page, id=page.stem, marks=[pytest.mark.long] * (page.stem in SLOW)) for page in PAGES]
)
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


@pytest.mark.parametrize(
    "page", [*sorted(DOCS.parent.glob("*.md")), *sorted(DOCS.rglob("*.md"))], ids=lambda page: page.stem
)
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


@pytest.mark.long
def test_the_page_of_virtual_machines_is_followed_word_for_word(tmp_path: Path) -> None:
    page = DOCS / "study.md"
    for name, text in files(page).items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    first = next(words for words in commands(page) if words[0] == "python")
    words = " ".join(first).replace("--machines 20", "--machines 1").split()
    ran = subprocess.run(
        [sys.executable, DOCS.parent / words[1], *words[2:]], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    dial, laser = csv.DictReader((tmp_path / "cases.csv").read_text(encoding="utf-8").splitlines())
    assert (dial["campaign"], laser["campaign"]) == ("dial.toml", "laser.toml")
    assert (dial["readings"], laser["readings"], dial["error"], laser["error"]) == ("12", "12", "", "")
    assert float(laser["minutes"]) - float(dial["minutes"]) == pytest.approx(35, abs=1)
    assert all(0 < float(row["true_rms_um"]) < float(row["U_um"]) for row in (dial, laser))
    assert "laser.toml instead of dial.toml: minutes +34.62" in ran.stdout
