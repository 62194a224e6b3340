"""A promise that rests on what is stated alone, said with the same words while measuring as in a report."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ending import reaches
from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.ruled import ruling_of
from axiscal.guide.not_vouched import standing_words
from axiscal.language.spoken import speaking
from axiscal.measurement.reading import Reading
from axiscal.planning.vouched import vouched_of
from axiscal.report.verdict import verdict_words

MACHINE = """
chain = "w-b-X-t"
[axes.X]
travel = ["0 mm", "1 m"]
[errors]
EXX = { std = "3 um", knots = 9 }
EXX_reversal = { std = "20 um" }
"""
TEXT = """
machine = "m.toml"
[target]
rms = "0.45 um"
readings = 40
{more}
[[setups]]
name = "laser"
instrument = "interferometer"
direction = "x"
approach = "+"
noise = "0.5 um"
drift = "0 um/h"
"""
REFUSED = "The rms target is promised, and does not count as reached. "
NAMED = (
    "These 12 readings leave as stated EXX_reversal (20 um): 100 % of the promised variance rests on what is stated "
)
NAMED += "alone, and what can be vouched for is a standard uncertainty of 15.5 um."


@contextmanager
def _read(path: Path, more: str = "") -> Iterator[Campaign]:
    """Yield a campaign that has come to a dozen places from one side only, as its machine is stated."""
    described = campaign_from_texts(TEXT.format(more=more), "c.toml", MACHINE, "m.toml")
    places = enumerate(np.linspace(0.0, 1.0, 12).tolist(), start=1)
    taken = (Reading("laser", (x,), (1,), 1e-6 * np.sin(3 * x), number=number) for number, x in places)
    with Campaign.create(path, described) as campaign:
        campaign.adopt(tuple(taken))
        yield campaign


def test_what_a_promise_rests_on_is_named_while_measuring_as_in_the_report(tmp_path: Path) -> None:
    with _read(tmp_path / "c.axiscal") as campaign:
        (said,) = standing_words(campaign)
        concluded = campaign.ruled()
        assert campaign.reached() is None
        assert reaches(campaign.description.target, concluded) is False
        assert said == REFUSED + vouched_of(concluded.case, ruling_of(concluded).defence).words
        assert said.startswith(REFUSED + NAMED)
        assert said.endswith("A reading along x while X moves and comes from both sides would show EXX_reversal.")


def test_the_next_command_says_it_in_the_language_of_whoever_asks(tmp_path: Path) -> None:
    path = tmp_path / "c.axiscal"
    with _read(path) as campaign:
        english = standing_words(campaign)
        with speaking("de"):
            german = standing_words(campaign)
    assert "EXX_reversal" in german[0]
    assert "wie angegeben" in german[0]
    with Campaign.open(path, write=False) as campaign:
        with speaking("de"):
            assert standing_words(campaign) == german
        assert standing_words(campaign) == english


def test_where_it_is_allowed_the_promise_counts_and_the_verdict_says_so(tmp_path: Path) -> None:
    with _read(tmp_path / "c.axiscal", 'unchecked = "allow"') as campaign:
        target, ruling = campaign.description.target, ruling_of(campaign.ruled())
        assert ruling.verdict == "unchecked"
        assert ruling.defence.rests
        assert not ruling.defence.leaves
        assert reaches(target, campaign.ruled()) is False, "a reversal that no reading sees is larger"
        assert (campaign.reached() or "").startswith("rms target reached in what readings can tell; with what")
        assert standing_words(campaign) == []
        words = verdict_words(ruling, target)
        assert "of what is promised rests on statements alone. The target counts by the promise all the same" in words
        assert words.endswith('unchecked = "allow" is stated.')


def test_once_it_has_ended_its_status_says_the_verdict_of_the_report(tmp_path: Path) -> None:
    path = tmp_path / "c.axiscal"
    with _read(path) as campaign:
        assert (campaign.status().verdict, campaign.status().verdict_words) == ("", "")
        campaign.finish("ended by the operator")
        said = campaign.status().verdict_words
        assert campaign.status().verdict == ruling_of(campaign.ruled()).verdict
        assert said == f"unchecked. {vouched_of(campaign.case(), ruling_of(campaign.ruled()).defence).words}"
        assert said.startswith(f"unchecked. {NAMED}")
    with Campaign.open(path, write=False) as campaign:
        assert campaign.status().verdict_words == said
        assert campaign.status().verdict == "unchecked"
