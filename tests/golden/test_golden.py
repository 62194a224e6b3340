"""Campaigns give what they gave, and show it alike on every surface: one in the quick tests, all in the long ones."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.cli.outputs import standing_screen
from axiscal.language.spoken import speaking
from axiscal.web.desk import Desk
from tests.golden.__main__ import EXPECTED, compared
from tests.golden.comparing import of_values
from tests.golden.given import names
from tests.golden.running import LANGUAGES, Texts, all_played
from tests.golden.surfaces import (
    Row,
    Shown,
    differing,
    of_page,
    of_paper,
    of_screen,
    of_state,
    plain,
    statement_of,
    written_screens,
)

ROOT = Path(__file__).resolve().parents[2]
_CUT = re.compile("…|and[0-9]+more|und[0-9]+weitere")
"""Where a terminal's sentence ends before the whole one does, its blanks taken out."""


class Played(NamedTuple):
    """What campaigns gave: their texts by name, the folder in which they lie by language, what ended otherwise."""

    texts: dict[str, Texts]
    folder: Path
    broken: list[str]


@pytest.fixture(scope="module")
def played(tmp_path_factory: pytest.TempPathFactory) -> Played:
    """All campaigns, played once."""
    folder = tmp_path_factory.mktemp("played")
    texts, broken = all_played(names(), folder)
    return Played(texts, folder, broken)


def test_a_small_campaign_gives_what_it_gave() -> None:
    path = {"PYTHONPATH": str(ROOT / "src")}
    command = [sys.executable, "-m", "tests.golden", "--only", "programs"]
    found = subprocess.run(command, cwd=ROOT, env=os.environ | path, capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stdout + found.stderr


@pytest.mark.long
def test_all_campaigns_give_what_they_gave(played: Played) -> None:
    assert [f"{name}/{each}" for name, each in compared(played.texts, EXPECTED)] + played.broken == []


@pytest.mark.long
@pytest.mark.parametrize("campaign", names())
def test_five_surfaces_show_one_answer(
    campaign: str, played: Played, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for language in LANGUAGES:
        monkeypatch.setenv("AXISCAL_LANGUAGE", language)
        texts = played.texts[campaign]
        screens = list(written_screens(texts.get(f"{language}/screens.txt", texts["screens.txt"])))
        for record in sorted((played.folder / language / campaign).rglob("*.axiscal")):
            answer, surfaces = standing(record, language, tmp_path)
            out = record.parent
            if (out / "result.json").is_file():
                document = json.loads((out / "result.json").read_text(encoding="utf-8"))
                assert_same(document["rows"], answer["rows"])
                assert_same(document["answer"]["aims"], answer["aims"])
                page = of_page((out / "report.html").read_text(encoding="utf-8"))
                surfaces += [page, *(screen for folder, screen in screens if folder == out.name)]
                paper = of_paper(out / "report.pdf")
                assert page.first in paper
                assert page.below in paper
                assert plain("".join(cell for line in page.cells for cell in line)) in paper
            for shown in surfaces:
                if "more" in answer:  # those of a plan are held by tests/present/test_plan_screen.py
                    assert list(differing(shown, answer["rows"], answer)) == []
                assert shown.first == surfaces[0].first
                assert surfaces[0].below.startswith(_CUT.split(shown.below)[0])


def standing(record: Path, language: str, folder: Path) -> tuple[dict[str, Any], list[Shown]]:
    """Return the answer of the operator's page as a document, and what it and `status` show."""
    copy = Path(shutil.copy(record, folder / f"{language}.axiscal"))
    with Campaign.open(copy) as campaign, speaking(language):
        desk = Desk(campaign, lambda: None)
        desk.think()
        state = desk.state.model_dump(mode="json")["answer"]
        screen = standing_screen(campaign)
    return state["document"], [of_state(state), of_screen(screen)]


def assert_same(first: list[Row], second: list[Row]) -> None:
    """Fail unless two documents have the same rows: processors that play and read them differ by 1e-5."""
    assert list(of_values(first, second, "rows", 0.0)) == []


@pytest.mark.long
@pytest.mark.parametrize("campaign", names())
def test_the_second_page_of_a_report_is_redone_with_a_pocket_calculator(campaign: str, played: Played) -> None:
    for path in sorted(played.folder.glob(f"*/{campaign}/**/report.html")):
        if (stated := statement_of(path.read_text(encoding="utf-8"))) is not None:
            assert stated.faults == []
            paper = of_paper(path.with_suffix(".pdf"), 2)
            assert [text for text in stated.texts if text not in paper] == []


@pytest.mark.long
def test_most_campaigns_leave_results_in_both_languages(played: Played) -> None:
    assert sum(1 for _ in played.folder.rglob("result.json")) >= 2 * 20
