"""A finished campaign as the prior of the next: its result, widened by the drift since then.

Between two campaigns each error keeps a share ρ of its value. The stated prior supplies the rest: mean ρ m, covariance
ρ² C + (1 − ρ²) C₀ (a stationary first-order drift). With ρ = 1 nothing has changed, with ρ = 0 all is new.
"""

from __future__ import annotations

import json
import math

import numpy as np

from axiscal.description.campaign import CampaignDescription, description_of, with_mounted
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation
from axiscal.exceptions import RecordError
from axiscal.measurement.reading import Reading
from axiscal.record.events import Created, Mounted, Recorded, Warmed
from axiscal.record.payload import PayloadError, decode
from axiscal_core.machine import Machine
from axiscal_core.normal import Normal

_ALIKE = 1e-9
"""Of the whole: what is less is rounding."""


def case_of(description: CampaignDescription) -> Case:
    """Return the case of a campaign, with the prior that an earlier campaign leaves it."""
    if not description.prior_text:
        return Case(description)
    last, errors, kept = last_estimation(description.prior_text), description.machine, description.kept
    found = carried_over(last.printed.belief, last.case.errors, errors)
    root = np.hstack([kept * found.factor, math.sqrt(1 - kept**2) * errors.root()])
    return Case(description, Normal.of_factor(kept * found.mean, root))


def last_campaign(text: str) -> tuple[CampaignDescription, tuple[Reading, ...]]:
    """Return description and readings of the campaign in a heritage text; raises RecordError if it is none."""
    try:
        document = json.loads(text)
        created = decode("created", json.dumps(document["created"]))
        events = [decode("recorded", json.dumps(fields)) for fields in document["readings"]]
        anew = [decode("mounted", json.dumps(fields)) for fields in document.get("mounted", ())]
        warm = [decode("warmed", json.dumps(fields)) for fields in document.get("warmed", ())]
    except (PayloadError, ValueError, KeyError, TypeError) as error:
        remedy = "Start the campaign anew"
        raise RecordError("the last campaign cannot be read: {reason}", remedy, reason=error) from None
    assert isinstance(created, Created)
    readings = tuple(event.reading for event in events if isinstance(event, Recorded))
    description = description_of(created)
    mounted = [each for each in anew if isinstance(each, Mounted)]
    return with_mounted(description, mounted, [each for each in warm if isinstance(each, Warmed)]), readings


def last_estimation(text: str) -> Estimation:
    """Return what the campaign in a heritage text came to know; raises RecordError if it is none."""
    description, readings = last_campaign(text)
    return concluded(case_of(description), readings)


def carried_over(belief: Normal, before: Machine, errors: Machine) -> Normal:
    """Return a belief over the errors of one description as one over those of another: curves at the knots of today's.

    Of M, which takes them there, (1 − M M⁺) L is what today's prior, L Lᵀ, holds and the other knots cannot. That, and
    an error that is new, is as stated; the rest of a curve is that of before.
    """
    size, matrix = errors.size, np.zeros((errors.size, before.size))
    beyond, rests, others = errors.root(), np.zeros(size), {term.name: term for term in before.terms}
    for term in errors.terms:
        if term.name in others:
            own, other = term.columns, others[term.name]
            matrix[own, other.columns] = held = term.taken_from(other)
            beyond[own] -= held @ np.linalg.pinv(held, rcond=_ALIKE) @ beyond[own]
            rests[own] = term.loosened(other.rest)
    root = np.hstack([matrix @ belief.factor[: before.size], beyond, np.diag(np.sqrt(rests))])
    return Normal.of_factor(matrix @ belief.mean[: before.size], root)
