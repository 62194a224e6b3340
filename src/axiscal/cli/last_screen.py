"""The last screen of a command, with what to do next as commands that can be typed as they stand."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ending import count_reached
from axiscal.estimation.estimation import Estimation
from axiscal.guide.stopping import results_beside
from axiscal.language.spoken import said
from axiscal.report.answer import Answer
from axiscal.report.answering import answer_of
from axiscal.report.screen import Shown, screen
from axiscal.report.summarising import agreement_of
from axiscal.report.summary import Summary


def written_screen(summary: Summary, campaign: Campaign, record: Path, out: Path) -> str:
    """Return the screen of a campaign whose results are written.  record : where it stays"""
    assert summary.answer is not None
    commands = _after_the_end(summary, campaign, record, out)
    report = str(out / "report.pdf")
    left_out = len(summary.rejected)
    shown = Shown(summary.readings, left_out, summary.agreement, summary.withheld, commands, report)
    return screen(summary.answer, shown)


def standing_screen(campaign: Campaign, known: Estimation) -> str:
    """Return the screen of a campaign as it stands."""
    answer, agreement = answer_of(campaign, known, {}), agreement_of(known, campaign.path)
    refused = sum(doubt.rejected for doubt in known.outliers)
    commands = _under_way(campaign, answer)
    return screen(answer, Shown(len(known.readings), refused, agreement, known.agreement.withheld, commands))


def _after_the_end(summary: Summary, campaign: Campaign, record: Path, out: Path) -> Sequence[str]:
    assert summary.answer is not None
    if summary.answer.verdict in ("more", "contradict", "nothing"):
        return [f"axiscal undo {record}", _reading(campaign, record)]
    offered = [offer.controller for offer in summary.tables if offer.axis]
    wanted = [name for name in reversed(campaign.description.controls) if name in offered]
    verify = f"axiscal verify {record}"
    if not wanted:
        return [verify]
    folder = out / "tables" / wanted[0]
    return [said("load {folder} (README.txt there), then", folder=str(folder)), verify]


def _under_way(campaign: Campaign, answer: Answer) -> Sequence[str]:
    """Return how to go on; of one that has ended, how to write its results again."""
    going_on = answer.verdict in ("more", "contradict", "nothing") and campaign.state.finished is None
    if going_on:
        return [_reading(campaign, campaign.path)]
    return [f"axiscal finish {campaign.path} --out {results_beside(campaign.path)}"]


def _reading(campaign: Campaign, record: Path) -> str:
    """Return how further readings are asked for: one by one where as many were taken as the target names."""
    full = count_reached(campaign.description.target, len(campaign.state.readings)) is not None
    return f"axiscal next {record} --beyond" if full else f"axiscal measure {record}"
