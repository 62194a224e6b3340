"""What is said of a machine that is not like its sisters."""

from __future__ import annotations

from collections.abc import Iterator

from axiscal.estimation.estimation import Estimation
from axiscal.estimation.membership_words import STRANGE, farthest, membership_words
from axiscal.language.spoken import capital, said
from axiscal.report.summary import Finding


def strangers(estimation: Estimation) -> Iterator[Finding]:
    """Yield a warning where the readings say that the machine is none of its type."""
    member = estimation.membership
    if member is None or member.sister >= STRANGE:
        return
    found, unlike = farthest(estimation), membership_words(estimation)
    text = "{unlike}. What its type has taught hardly counts; its bands are those of any machine."
    yield Finding("not-a-sister", None if found is None else found.name, capital(said(text, unlike=unlike)))
