"""What is known of the machine, in the words of every screen: the result, or before the first reading the plan."""

from __future__ import annotations

from typing import Self

from axiscal.answers.answer import AnswerDocument, PlannedAnswer, ResultAnswer
from axiscal.answers.answer_of_campaign import results_beside
from axiscal.answers.answer_words import answer_text
from axiscal.campaign.agreement_words import agreement_words
from axiscal.campaign.campaign import Campaign
from axiscal.campaign.evidence import evidence_words
from axiscal.present.plan_words import plan_text
from axiscal.present.sentences import spelt


class KnownInWords(AnswerDocument):
    """The result, or the plan, in words and as their document.  first : the first line in parts; rows : with heading"""

    first: list[str]
    rows: list[list[str]]
    sentences: list[str]
    document: ResultAnswer | PlannedAnswer

    @classmethod
    def of_campaign(cls, campaign: Campaign, answer: ResultAnswer | PlannedAnswer) -> Self:
        """Return the answer of a campaign with its words."""
        record, results = campaign.path.name, results_beside(campaign.path).name
        if isinstance(answer, PlannedAnswer):
            text = plan_text(answer, record)
        else:
            agreement = agreement_words(campaign.so_far()) if answer.readings else ""
            text = answer_text(answer, agreement, record, results, evidence_words(campaign))
        return cls(
            first=[spelt(part) for part in text.first.parts],
            rows=[[spelt(cell) for cell in row] for row in text.rows],
            sentences=[spelt(sentence) for sentence in text.sentences],
            document=answer,
        )
