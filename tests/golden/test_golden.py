"""Campaigns give what they gave, and show it alike on every surface: five in the quick tests, all in the long ones."""

import json
import re
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.cli.outputs import standing_screen
from axiscal.language.spoken import speaking
from axiscal.present.answer_of_campaign import standing_answer
from axiscal.web.desk import Desk
from tests.golden.__main__ import EXPECTED, compared
from tests.golden.comparing import of_values
from tests.golden.given import names
from tests.golden.running import LANGUAGES, Texts, all_played
from tests.golden.surfaces import (
    Row,
    Shown,
    differing,
    of_paper,
    of_screen,
    of_state,
    plain,
    statement_of,
    written_screens,
)

SMALL = ("contradict", "manners", "plans", "programs")
"""Played in the quick tests, and looked at in both languages."""
CAMPAIGNS = [pytest.param(name, marks=() if name in SMALL else pytest.mark.long) for name in names()]
_CUT = re.compile("…|and[0-9]+more|und[0-9]+weitere")
"""Where a terminal's sentence ends before the whole one does, its blanks taken out."""


class Played(NamedTuple):
    """What campaigns gave: their texts by name, the folder in which they lie by language, what ended otherwise."""

    texts: dict[str, Texts]
    folder: Path
    broken: list[str]


def _played(chosen: Sequence[str], folder: Path) -> Played:
    texts, broken = all_played(chosen, folder)
    return Played(texts, folder, broken)


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Played:
    """The small campaigns, played once."""
    return _played(SMALL, tmp_path_factory.mktemp("small"))


@pytest.fixture(scope="module")
def others(tmp_path_factory: pytest.TempPathFactory) -> Played:
    """All other campaigns, played once."""
    return _played([name for name in names() if name not in SMALL], tmp_path_factory.mktemp("others"))


@pytest.fixture
def played(campaign: str, request: pytest.FixtureRequest) -> Played:
    """What was played together with a campaign."""
    found: Played = request.getfixturevalue("small" if campaign in SMALL else "others")
    return found


@pytest.mark.parametrize("campaigns", ["small", pytest.param("others", marks=pytest.mark.long)])
def test_campaigns_give_what_they_gave(campaigns: str, request: pytest.FixtureRequest) -> None:
    found: Played = request.getfixturevalue(campaigns)
    assert [f"{name}/{each}" for name, each in compared(found.texts, EXPECTED)] + found.broken == []


@pytest.mark.parametrize("campaign", CAMPAIGNS)
def test_every_surface_shows_one_answer(
    campaign: str, played: Played, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for language in LANGUAGES if campaign in SMALL else LANGUAGES[:1]:
        monkeypatch.setenv("AXISCAL_LANGUAGE", language)
        texts = played.texts[campaign]
        screens = list(written_screens(texts.get(f"{language}/screens.txt", texts["screens.txt"])))
        for record in sorted((played.folder / language / campaign).rglob("*.axiscal")):
            answer, surfaces = standing(record, language, tmp_path)
            out = record.parent
            result = out / "result.json"
            document = json.loads(result.read_text(encoding="utf-8")) if result.is_file() else None
            if document and document["answer"]["withheld"] == answer.get("withheld"):  # not what is written `--anyway`
                assert_same(document["rows"], answer["rows"])
                assert_same(document["answer"]["aims"], answer["aims"])
                surfaces += [screen for folder, screen in screens if folder == out.name]
                paper = of_paper(out / "report.pdf", 1)
                assert surfaces[0].first in paper
                assert surfaces[0].below in paper
                assert plain("".join(cell for line in surfaces[0].cells for cell in line)) in paper
            for shown in surfaces:
                if "more" in answer:  # those of a plan are held by test_screens_say_results.py
                    assert list(differing(shown, answer["rows"], answer)) == []
                assert shown.first == surfaces[0].first
                assert surfaces[0].below.startswith(_CUT.split(shown.below)[0])


def standing(record: Path, language: str, folder: Path) -> tuple[dict[str, Any], list[Shown]]:
    """Return the answer of the operator's page as a document, and what it and `status` show."""
    copy = Path(shutil.copy(record, folder / f"{language}.axiscal"))
    with Campaign.open(copy) as campaign, speaking(language):
        desk = Desk(campaign)
        desk.think()
        state = desk.state.model_dump(mode="json")["answer"]
        screen = standing_screen(campaign)
        rows = [row.model_dump(mode="json") for row in standing_answer(campaign).rows]
    return state["document"] | {"rows": rows}, [of_state(state), of_screen(screen)]


def assert_same(first: list[Row], second: list[Row]) -> None:
    """Fail unless two documents have the same rows: processors that play and read them differ by 1e-5."""
    assert list(of_values(first, second, "rows", 0.0)) == []


@pytest.mark.parametrize("campaign", CAMPAIGNS)
def test_the_second_page_of_a_report_is_redone_with_a_pocket_calculator(campaign: str, played: Played) -> None:
    for path in sorted(played.folder.glob(f"*/{campaign}/**/report.pdf")):
        if (stated := statement_of(path)) is not None:
            assert stated.parts
            assert stated.faults == []


@pytest.mark.long
def test_most_campaigns_leave_results_in_both_languages(others: Played) -> None:
    assert sum(1 for _ in others.folder.rglob("result.json")) >= 2 * 20
