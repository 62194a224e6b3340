"""A report in German holds no English sentence: every sentence can be said again, and page and PDF say it."""

from __future__ import annotations

import html
import re
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.cli.app import run
from axiscal.language.spoken import Said, speaking
from axiscal.present.rendering import filled, render
from axiscal.present.summarising import Extras, summarise
from axiscal.present.summary import Summary
from tests.docs.languages import SOURCES
from tests.generators.laser_axis import CAMPAIGN

CAMPAIGNS = Path(__file__).resolve().parents[1] / "golden" / "campaigns"
GIVEN = {"outlier": "readings.csv", "drift": "readings.csv", "learnt": "equally-spaced.csv"}
"""Campaigns whose readings say something that a person has to be told."""
PROSE = re.compile(r"(?:\b[a-z]+\b[ ,;:]*){4,}")
"""Four small words in a row: a sentence of some language."""


@pytest.fixture(scope="module", params=sorted(GIVEN))
def summary(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Summary:
    """The summary of a campaign whose readings are given."""
    folder, out = CAMPAIGNS / request.param, tmp_path_factory.mktemp("german") / "out"
    run(["estimate", str(folder / "campaign.toml"), str(folder / GIVEN[request.param]), "--out", str(out)])
    with Campaign.open(out / "campaign.axiscal", write=False) as campaign:
        return summarise(campaign, campaign.estimate(ended=True), Extras())


def _sentences(summary: Summary) -> Iterator[str]:
    """Yield every text of a summary that is a sentence for people, and no name that somebody gave."""
    yield from (summary.title, summary.stopped_because, summary.agreement_words)
    yield from (summary.expanded.conditions, *summary.observability, *summary.questions)
    yield from (finding.text for finding in summary.warnings)
    yield from (curve.caption for curve in (*summary.curves, *summary.reversals))
    yield from (plane.caption for plane in summary.planes)
    yield from (constant.words for constant in summary.constants)
    yield from (row.words for row in summary.budget)
    yield from (rejection.reason for rejection in summary.rejected)
    yield from (use.instrument for use in summary.setups)
    yield from (words for *_, words in summary.mistakes)


def test_every_sentence_can_be_said_again(summary: Summary) -> None:
    assert [text for text in _sentences(summary) if not isinstance(text, Said)] == []
    assert len(list(_sentences(summary))) > 15


def test_no_english_sentence_is_left(summary: Summary) -> None:
    english, german = (_shown(summary, language) for language in ("en", "de"))
    assert len(english) > 30
    assert sorted(english & german) == []


def test_numbers_have_a_comma(summary: Summary) -> None:
    with speaking("de"):
        shown = _without_names(render(summary))
    assert re.search(r"±[0-9]+,[0-9]+", shown)
    assert "\u00a0µm ±" not in shown  # the word um is no unit
    assert re.findall(r"[^\"0-9][0-9]+\.[0-9]+[ \u00a0]?[µm]", shown) == []


@pytest.mark.parametrize("name", ["report.html", "panels.html"])
def test_templates_say_every_word(name: str) -> None:
    text = (SOURCES / "present" / "templates" / name).read_text(encoding="utf-8")
    bare = re.sub(r"<[^>]*>", " ", re.sub(r"\{\{.*?\}\}|\{%.*?%\}|\{#.*?#\}", "", text, flags=re.DOTALL))
    words = set(re.findall(r"[A-Za-z]{2,}", html.unescape(bare)))
    assert words - {"axiscal", "min", "RMS", "SHA"} == set()


@pytest.mark.long
def test_the_language_is_that_of_the_campaign_or_the_one_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("AXISCAL_LANGUAGE", raising=False)
    monkeypatch.setenv("LANG", "de_DE.UTF-8")  # the same campaign gives the same bytes on any computer
    spoken = {"": "en", 'language = "de"': "de"}
    for said, language in spoken.items():
        described = CAMPAIGN.replace('machine = "m"', 'machine = "one-axis"')
        (tmp_path / "campaign.toml").write_text(f"{described}[report]\n{said}\n", encoding="utf-8")
        record = tmp_path / f"{language}.axiscal"
        run(["start", str(tmp_path / "campaign.toml"), str(record)])
        run(["report", str(record), "--out", str(tmp_path / "said.html")])
        assert f'<html lang="{language}">' in (tmp_path / "said.html").read_text(encoding="utf-8")
    run(["report", str(record), "--out", str(tmp_path / "said.html"), "--language", "en"])
    assert '<html lang="en">' in (tmp_path / "said.html").read_text(encoding="utf-8")


def _shown(summary: Summary, language: str) -> set[str]:
    """Return all sentences of page and PDF."""
    with speaking(language), TemporaryDirectory() as folder:
        page = _without_names(render(summary))
        paper = re.findall(r'"((?:[^"\\]|\\.)*)"', filled(summary, Path(folder)))
    found = {part.strip() for text in (page, *paper) for part in re.split(r"\n|(?<=[.;:]) ", text)}
    return {text for text in found if PROSE.search(text)}


def _without_names(page: str) -> str:
    """Return what a page shows and says aloud, a line for each."""
    bare = re.sub(r"<(script|style)\b.*?</\1>", "", page, flags=re.DOTALL)
    aloud = " \n ".join(re.findall(r'(?:aria-label|title)="([^"]*)"', bare))
    return html.unescape(f"{re.sub(r'<[^>]*>', chr(10), bare)}\n{aloud}")
