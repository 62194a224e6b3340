"""The verdict on an estimate in a sentence."""

from __future__ import annotations

from axiscal.estimation.ruling import Ruling

NOT_KNOWN = "Not known: the readings contradict every explanation that was tried"


def verdict_words(ruling: Ruling) -> str:
    """Return what the readings say of the model, and what was made of that."""
    return f"Verdict: {ruling.verdict}. {_said(ruling)}"


def _said(ruling: Ruling) -> str:
    if ruling.verdict == "contradicted":
        return f"{NOT_KNOWN}. No accuracy is promised, and no target counts as reached."
    if ruling.verdict == "widened":
        said = "The readings contradict the model: means and bands are those of all that explains them"
        factor = f"; no explanation is believed, so variances count {ruling.inflated:.2g} times" * (ruling.inflated > 1)
        return f"{said}, the model as it is keeps {ruling.model:.0%} of the belief{factor}."
    if ruling.verdict == "unchecked":
        return "The readings do not contradict the model, and could hardly have done so."
    return "The readings could have contradicted the model, and did not."
