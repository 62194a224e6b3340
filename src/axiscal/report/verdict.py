"""The verdict on an estimate in a sentence."""

from __future__ import annotations

from axiscal.estimation.checks import Checks
from axiscal.estimation.ruling import Ruling
from axiscal.language.spoken import later, put, said
from axiscal.units import to_unit

_NOTABLE = 1.005
"""Times the uncertainties of the model, from which on it is told what is counted besides: it is printed in percent."""
_CHANCE, _RARE = 0.05, 1e-12
"""What chance does less often than once in twenty is said, and no chance is said to be smaller than it can be known."""
NOT_KNOWN = later("Not known: the readings contradict every explanation that was tried")
_VERDICTS = {
    "holds": later("holds"),
    "widened": later("widened"),
    "contradicted": later("contradicted"),
    "unchecked": later("unchecked"),
}


def verdict_words(ruling: Ruling) -> str:
    """Return what the readings say of the model, and what was made of that."""
    words = _meant(ruling)
    return said("Verdict: {verdict}. {words}", verdict=said(_VERDICTS[ruling.verdict]), words=words)


def checks_words(found: Checks | None) -> str:
    """Return what check readings say of the promise; empty where there were too few."""
    if found is None:
        return ""
    sizes = found.promised, found.found, found.low, found.high
    promised, seen, low, high = (float(to_unit(each, "um")) for each in sizes)
    told = said(
        "The model promised U = {promised:.2g} um; {count} check readings, predicted from the others before they were "
        "used, say {seen:.2g}, between {low:.2g} and {high:.2g} um (95 %)",
        promised=promised,
        count=found.count,
        seen=seen,
        low=low,
        high=high,
    )
    if found.chance >= _CHANCE:
        return put("{told}.", told=told)
    doubted = "{told}: not believed (by chance once in {times:.2g})."
    return said(doubted, told=told, times=float(1 / max(found.chance, _RARE)))


def _meant(ruling: Ruling) -> str:
    if ruling.verdict == "contradicted":
        nothing = "{not_known}. No accuracy is promised, and no target counts as reached."
        return said(nothing, not_known=said(NOT_KNOWN))
    if ruling.verdict == "widened":
        explained = (
            "The readings contradict the model: means and bands are those of all that explains them, the model as it "
            "is keeps {share:.0%} of the belief."
        )
        inflated = (
            "The readings contradict the model: means and bands are those of all that explains them, the model as it "
            "is keeps {share:.0%} of the belief; no explanation is believed, so variances count {times:.2g} times."
        )
        share, times = float(ruling.model), float(ruling.inflated)
        return said(inflated if ruling.inflated > 1 else explained, share=share, times=times)
    if ruling.verdict == "unchecked":
        hardly = said("The readings do not contradict the model, and could hardly have done so.")
        if not ruling.defence.leaves and ruling.defence.rests:
            hardly = said(
                "The readings do not contradict the model; too much of what is promised rests on statements alone."
            )
        return hardly
    held = said("The readings could have contradicted the model, and did not.")
    if not ruling.raised > _NOTABLE:
        return held
    larger = (
        "{held} What they would not have shown is counted by uncertainties {more:.0%} larger than those of the model."
    )
    return said(larger, held=held, more=ruling.raised - 1)
