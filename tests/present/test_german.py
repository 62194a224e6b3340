"""A report in German holds no English sentence: every sentence can be said again, and the report says it."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.cli.app import run
from axiscal.language.spoken import Said, speaking
from axiscal.present import rendering
from axiscal.present.answer_of_campaign import answer_of
from axiscal.present.rendering import pdf
from axiscal.present.result import Result
from axiscal.present.result_of_campaign import result_of
from tests.golden.surfaces import lines_of

CAMPAIGNS = Path(__file__).resolve().parents[1] / "golden" / "campaigns"
GIVEN = {"outlier": "readings.csv", "drift": "readings.csv", "learnt": "equally-spaced.csv"}
"""Campaigns whose readings say something that a person has to be told."""
FILLED = re.compile(r"\{\w+\}")
PROSE = re.compile(r"(?:\b[a-z]+\b[ ,;:]*){4,}")
"""Four small words in a row: a sentence of some language."""


@pytest.fixture(scope="module", params=sorted(GIVEN))
def result(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Result:
    """The result of a campaign whose readings are given."""
    folder, out = CAMPAIGNS / request.param, tmp_path_factory.mktemp("german") / "out"
    run(["estimate", str(folder / "campaign.toml"), str(folder / GIVEN[request.param]), "--out", str(out)])
    with Campaign.open(out / "campaign.axiscal", write=False) as campaign:
        return result_of(campaign, known := campaign.estimate(ended=True), answer_of(campaign, known, {}))


def _sentences(result: Result) -> Iterator[str]:
    """Yield every text of a result that is a sentence for people, and no name that somebody gave."""
    yield from (result.stopped_because, result.agreement.text)
    yield from (result.U_holds_for or "", *result.observability, *result.questions, *result.words.sentences)
    yield from (finding.text for finding in result.warnings)
    for kind in (result.errors, result.plane_errors, result.constants):
        yield from (each.words for each in kind.values())
    yield from (row.source for row in result.budget)
    yield from (row.reason for row in result.rejected)
    yield from (use.instrument for use in result.setups)
    yield from (each.text for each in result.agreement.explained)


def test_every_sentence_can_be_said_again(result: Result) -> None:
    assert [text for text in _sentences(result) if not isinstance(text, Said)] == []
    assert len(list(_sentences(result))) > 15


def test_no_english_sentence_is_left(result: Result, tmp_path: Path) -> None:
    english, german = (_shown(result, language, tmp_path / "report.pdf") for language in ("en", "de"))
    assert len(english) > 15
    assert sorted(english & german) == []


def test_every_word_of_the_layout_has_its_german() -> None:
    paper = Path(rendering.__file__).parent / "paper"
    layout = (paper / "report.typ").read_text(encoding="utf-8")
    said = set(re.findall(r'said\("([^"]+)"', layout))
    said |= {
        word
        for listed in re.findall(r'\(((?:"[^"]+",? ?)+)\)\.map\(said\)', layout)
        for word in re.findall('"([^"]+)"', listed)
    }
    german = tomllib.loads((paper / "words.toml").read_text(encoding="utf-8"))["de"]
    assert said - set(german) == set()
    assert [english for english in german if f'"{english}"' not in layout] == []
    assert [
        english for english, words in german.items() if set(FILLED.findall(english)) != set(FILLED.findall(words))
    ] == []


def _shown(result: Result, language: str, paper: Path) -> set[str]:
    """Return all sentences of the report."""
    with speaking(language):
        paper.write_bytes(pdf(result, {}))
    text = " ".join(lines_of(paper).split())
    return {part.strip() for part in re.split(r"(?<=[.;:]) ", text) if PROSE.search(part)}
