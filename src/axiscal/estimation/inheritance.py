"""A finished campaign as the prior of the next: its result, widened by the drift since then.

Between two campaigns each error keeps a share ρ of its value. The stated prior supplies the rest: mean ρ m, covariance
ρ² C + (1 − ρ²) C₀ (a stationary first-order drift). With ρ = 1 nothing has changed, with ρ = 0 all is new.
"""

from __future__ import annotations

import json

import numpy as np

from axiscal.description.campaign import CampaignDescription, description_of, with_mounted
from axiscal.estimation.carried_over import carried_over
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.promise.problem import Inherited
from axiscal.exceptions import RecordError
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.record.events import Created, Mounted, Recorded, Warmed
from axiscal.record.payload import PayloadError, decode
from axiscal_core.machine import Machine


def case_of(description: CampaignDescription) -> Case:
    """Return the case of a campaign, with the prior that an earlier campaign leaves it."""
    if not description.prior_text:
        return Case(description)
    stated = Case(description)
    found = inherited(description.prior_text, stated.errors)
    return Case(description, drifted(found, stated.errors.covariance(), description.kept))


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


def inherited(text: str, errors: Machine) -> Inherited:
    """Return what the campaign in a heritage text knew; errors that it did not have are as their prior states.

    Its curves are read at the knots of today's; what these hold and its own could not is as the prior states.
    """
    last = last_estimation(text)
    before, belief = last.case.errors, last.printed.belief
    across = carried_over(before, errors)
    factor, beyond = belief.factor[: before.size], across.beyond()
    unknown = np.diag(across.rests) + beyond @ beyond.T
    return across.prior(belief.mean[: before.size], factor @ factor.T, unknown)


def drifted(found: Inherited, stated: Array, kept: float) -> Inherited:
    """Return the result after each error kept a share ρ.  stated : (size, size) C₀."""
    return Inherited(kept * found.mean, kept**2 * found.covariance + (1 - kept**2) * stated)
