"""The last screen of a command: of results that are written, and of a campaign as it stands."""

from __future__ import annotations

from pathlib import Path

from axiscal.answers.answer_of_campaign import standing_answer
from axiscal.answers.answer_words import screen
from axiscal.campaign.campaign import Campaign
from axiscal.estimation.agreement_words import agreement_words
from axiscal.language.spoken import speaking
from axiscal.present.guide.stopping import results_beside
from axiscal.present.plan_answer import coming_answer
from axiscal.present.plan_words import plan_screen
from axiscal.present.summary import Summary
from axiscal.present.whose_language import chosen


def written_screen(summary: Summary, record: Path, out: Path) -> str:
    """Return the screen of a campaign whose results are written.  record : where it stays"""
    with speaking(chosen(None)):
        return screen(summary.answer, summary.agreement.words, str(record), str(out), str(out / "report.pdf"))


def standing_screen(campaign: Campaign) -> str:
    """Return the screen of a campaign as it stands: before the first reading, of its plan."""
    path, known = campaign.path, campaign.so_far()
    words = agreement_words(known) if known.readings else ""
    planned = coming_answer(campaign)
    with speaking(chosen(None)):
        if planned is not None:
            return plan_screen(planned, str(path))
        return screen(standing_answer(campaign), words, str(path), str(results_beside(path)))
