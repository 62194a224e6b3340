"""Sixth stage: whether the readings contradict the model, what explains them then, and what may be promised.

    known = ruled(concluded(case, readings))
    known.ruling.verdict

Rules in this order: `contradicted` where the test fires and the likeliest explanation itself fits with p < 0.001, or
the readings scatter five times as much as the model says; `widened` where the test fires, or the odds against the model
were twenty to one at any time, those with the stated scales against any too; `unchecked` where the readings could vouch
for no less than 1.25 times the promise, or where a step, a detail or what two axes do together, as large as curves are
and anywhere, would with more than 5 % spoil the promise unseen, or where so much of it rests on what is stated alone
that more than 2 % of machines that are as stated are far worse, or where it is small beside a noise that nothing tells
from the machine. A promise of which none of that would be so were it up to a fifth larger is made so much larger, and
holds, unless a target counts by the promise as it is (`unchecked = "allow"`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from axiscal.accuracy.expanded import Expanded, expanded
from axiscal.accuracy.yardstick import Accuracy
from axiscal.belief import Belief
from axiscal.estimation.bands import Banded
from axiscal.estimation.believed import plausible_with_sides, with_sides
from axiscal.estimation.checks import checked
from axiscal.estimation.defence import RAISED, Defence
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.knowledge import Knowledge
from axiscal.estimation.ruling import Ruling, VerdictWord
from axiscal.estimation.vouching import defended
from axiscal.inference.averaging import Average, average
from axiscal.inference.contradiction import FEWEST, FITS, MOST, SURE, Comparison, compared
from axiscal.inference.evidence import Evidence
from axiscal.inference.fit import drawn
from axiscal.inference.terms import evidence_of
from axiscal.inference.widening import posterior
from axiscal.measurement.departures import every_departure
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.numerics.stages import stage
from axiscal.numerics.threads import one_thread
from axiscal.numerics.ties import ALIKE

GROSS = 5.0
"""So many times as much as the model says: no band of it means anything."""
_A_SLIP = 0.9
"""Share of what explains the readings from which one that others contradict is a bad reading and nothing else."""
_BELIEVED, _TELLING = 0.5, 5
"""No explanation is believed by half, and there are readings enough to tell a factor on the variance."""


def ruling_of(known: Estimation) -> Ruling:
    """Return the verdict on an estimation, found now where it was not asked before."""
    found = known.ruling or ruled(known).ruling
    assert found is not None
    return found


@one_thread()
@stage("whether the readings contradict the model")
def ruled(known: Estimation) -> Estimation:
    """Return what is known with the verdict; means and bands are the mixture's where that is `widened`."""
    if known.ruling is not None:
        return known
    readings: Sequence[Reading] = with_sides(known)
    defence = defended(known)
    if len(readings) < FEWEST:
        comparison, own = Comparison((), 1.0, 1.0), _expanded(known.banded)
        return replace(known, ruling=Ruling("unchecked", comparison, own, defence, known.accuracy.rms))
    readings, comparison = _compared(known, readings)
    mixture = _average(known, readings)
    comparison = _beside_what_is_stated(known, readings, comparison, mixture)
    verdict, raised = _verdict(known, comparison, defence), 1.0
    factor = _inflation(known, comparison, mixture) if verdict in ("widened", "contradicted") else 1.0
    moved = mixture.moved + _brought_back(known, readings) if verdict == "widened" else None
    own, bands = _expanded(known.banded), known.banded
    wide, figures = _no_narrower(known, own, mixture, moved, factor)
    if verdict == "holds" and defence.unchecked:
        raised = (1 + ALIKE) * defence.held_from / defence.promise
        bands = _raised(known.banded, raised)
        wide, figures = max((wide, figures), (bands, _expanded(bands)), key=lambda each: each[1].space)
    if verdict == "widened":
        bands = wide
    standard, accuracy = _accuracy(wide).rms, known.accuracy if bands is known.banded else _accuracy(bands)
    vouched = defence.promising(accuracy.rms).at_least(standard)
    checks = checked(known.case, readings, own.space)
    ruling = Ruling(
        verdict, comparison, figures, vouched, standard, mixture.model, factor, raised, checks, tuple(readings)
    )  # fmt: skip
    return replace(known, ruling=ruling, banded=bands, accuracy=accuracy)


def _no_narrower(
    known: Estimation, own: Expanded, mixture: Average, moved: Array | None, factor: float
) -> tuple[Banded, Expanded]:
    """Return of mixture and model what promises less, and its expanded uncertainties: of one distribution all figures.

    own : those of the model; moved : None where means stay the model's
    """
    wide = _mixed(known, mixture, moved, factor)
    found = _expanded(wide)
    if found.space >= own.space:
        return wide, found
    if moved is None:
        return known.banded, own
    wide = _mixed(known, mixture, moved, factor * (own.space / found.space) ** 2)
    return wide, _expanded(wide)


def _compared(known: Estimation, trusted: Sequence[Reading]) -> tuple[Sequence[Reading], Comparison]:
    """Return which readings count, and how departures explain them.

    A reading that others contradict is left out only where it is a bad reading by nine to one: a step, or a detail that
    readings nearby have missed, contradicts it as well, and would be hidden by leaving it out. So would a bad one
    beside it: where two contradict each other and no third one decides, nobody knows which.
    """
    observation, prior, every = known.case.observation, known.case.inherited, plausible_with_sides(known)
    if len(every) > len(trusted):
        readings, used = drawn(every, MOST), {id(each) for each in trusted}
        found = compared(observation, readings, prior)
        whole = sum(each.odds for each in found.explanations)
        bad = sum(odds for odds, each in zip(found.slips, readings, strict=True) if id(each) not in used)
        if found.contradicted and bad < _A_SLIP * whole:
            return readings, found
    chosen = drawn(trusted, MOST)
    return chosen, compared(observation, chosen, prior)


def _beside_what_is_stated(
    known: Estimation, readings: Sequence[Reading], comparison: Comparison, mixture: Average
) -> Comparison:
    """Return how departures explain readings at the stated scales where these say so and the learnt ones do not.

    Scales that were learnt make room for whatever it is. Where a departure with the stated ones is likelier by twenty
    to one than the model with any scales, the odds are an e-value as those of the stated model are.
    """
    if known.fit is None or comparison.contradicted or mixture.evalue < SURE:
        return comparison
    found = compared(known.stated.observation, readings, known.case.inherited)
    return replace(found, evalue=mixture.evalue, highest=mixture.evalue, fits=comparison.fits)


def _brought_back(known: Estimation, readings: Sequence[Reading]) -> Array | float:
    """Return by how much readings that were left out move the model's mean of errors and unknowns."""
    trusted = with_sides(known)
    if len(readings) <= len(trusted):
        return 0.0
    observation, prior = known.case.observation, known.case.inherited
    every, fewer = (Evidence(observation, drawn(each, MOST), (), prior) for each in (readings, trusted))
    return posterior(every, np.zeros(0)).mean - posterior(fewer, np.zeros(0)).mean


def _verdict(known: Estimation, comparison: Comparison, defence: Defence) -> VerdictWord:
    if known.misfit() > GROSS or (comparison.contradicted and comparison.fits < FITS):
        return "contradicted"
    if comparison.contradicted:
        return "widened"
    target = known.stated.description.target
    farthest = 1.0 if target.unchecked and target.accurate else RAISED
    return "unchecked" if defence.held_from > farthest * defence.promise else "holds"


def _raised(model: Banded, times: float) -> Banded:
    """Return case and knowledge with the same means, and bands so many times as wide: what no reading sees as well."""
    rests = {term.name: times * term.rest for term in model.case.errors.terms}
    wider = model.case.with_rests(rests, times)
    observation, belief = replace(model.knowledge.observation, errors=wider.errors), model.knowledge.belief
    return Banded(wider, Knowledge(observation, Belief(belief.mean, times**2 * belief.covariance)))


def _average(known: Estimation, readings: Sequence[Reading]) -> Average:
    observation, prior = known.case.observation, known.case.inherited
    evidence, terms = evidence_of(observation, readings, known.fit, prior)
    return average(evidence, every_departure(observation, tuple(drawn(readings, MOST))), terms)


def _mixed(known: Estimation, mixture: Average, moved: Array | None, factor: float) -> Banded:
    """Return case and knowledge with the moments of the mixture, all variances times a factor.

    moved : from the model's mean of errors and unknowns to the mixture's; None where the model's is believed
    """
    case = known.banded.case
    rests = {f.name: float(np.hypot(f.rest, np.sqrt(mixture.rests.get(f.name, 0.0)))) for f in case.errors.terms}
    wider = case.with_rests(rests)
    added = mixture.about_model if moved is None else mixture.about_mixture
    observation = replace(known.banded.knowledge.observation, errors=wider.errors)
    mixed = Banded(wider, Knowledge(observation, _belief(known.whole, moved, added)))
    return mixed if factor == 1 else _raised(mixed, math.sqrt(factor))


def _belief(belief: Belief, moved: Array | None, added: Array) -> Belief:
    """Return the belief with its first coefficients moved, and E Eᵀ added."""
    mean, covariance, size = belief.mean.copy(), belief.covariance, len(added)
    covariance[:size, :size] += added @ added.T
    if moved is not None:
        mean[:size] += moved
    return Belief(mean, (covariance + covariance.T) / 2)


def _inflation(known: Estimation, comparison: Comparison, mixture: Average) -> float:
    """Return Birge's factor where no explanation is believed, 1 where one is."""
    odds = [each.odds for each in comparison.explanations]
    believed = max([mixture.model, *(each / (1.0 + sum(odds)) for each in odds)])
    degrees = sum(each.degrees for each in known.innovations)
    if believed > _BELIEVED or degrees < _TELLING:
        return 1.0
    return max(1.0, sum(each.chi_square for each in known.innovations) / degrees)


def _accuracy(wide: Banded) -> Accuracy:
    return wide.case.yardstick.measure(wide.knowledge.belief)


def _expanded(wide: Banded) -> Expanded:
    return expanded(wide.case.yardstick, wide.knowledge.belief)
