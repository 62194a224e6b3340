"""The verdict on an estimate in a sentence."""

from __future__ import annotations

from axiscal.estimation.checks import Checks
from axiscal.estimation.ruling import Ruling
from axiscal.units import to_unit

_CHANCE, _RARE = 0.05, 1e-12
"""What chance does less often than once in twenty is said, and no chance is said to be smaller than it can be known."""
NOT_KNOWN = "Not known: the readings contradict every explanation that was tried"


def verdict_words(ruling: Ruling) -> str:
    """Return what the readings say of the model, and what was made of that."""
    return f"Verdict: {ruling.verdict}. {_said(ruling)}"


def checks_words(found: Checks | None) -> str:
    """Return what check readings say of the promise; empty where there were too few."""
    if found is None:
        return ""
    sizes = found.promised, found.found, found.low, found.high
    promised, seen, low, high = (f"{to_unit(each, 'um'):.2g}" for each in sizes)
    said = f"The model promised U = {promised} um; {found.count} check readings, predicted from the others before they "
    said += f"were used, say {seen}, between {low} and {high} um (95 %)"
    doubted = f": not believed (by chance once in {1 / max(found.chance, _RARE):.2g})"
    return f"{said}{doubted if found.chance < _CHANCE else ''}."


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
