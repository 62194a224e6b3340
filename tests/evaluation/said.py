"""What a check says of a judgement."""

from __future__ import annotations

from axiscal.evaluation.check import Taken
from axiscal.evaluation.table_checks import Judgement
from axiscal.present.check_answer import check_answer, check_details


def said_of(judgement: Judgement) -> str:
    """Return the words for a judgement."""
    return "\n".join(check_details(check_answer(judgement, 1, 1e-6, Taken())))
