"""A record of one axis read out and on its way back, with a step where it turned: a jump of the zero, or backlash."""

from pathlib import Path

import numpy as np

from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import campaign_from_texts
from axiscal.machine import load_machine
from axiscal.measurement.reading import Place
from tests.generators.texts import FOUR_READINGS

OUT = 10
"""Readings before the axis turns."""
PLACES = [
    *(Place("laser", (x,), (1,)) for x in np.linspace(0.05, 0.95, OUT).tolist()),
    *(Place("laser", (x,), (-1,)) for x in np.linspace(0.95, 0.05, OUT).tolist()),
]
NOISE = np.random.default_rng(1).normal(0, 0.5e-6, len(PLACES)).tolist()
"""m, of the reading at each: as the set-up states."""


def value_at(place: Place, step: float) -> float:
    """Return what a laser shows at a place, m.  step : by how much less on the way back, m"""
    (x,), (side,) = place.pose, place.approach
    return 20e-6 * x - (step if side < 0 else 0.0) + float(NOISE[PLACES.index(place)])


def begun_out_and_back(record: Path, count: int, step: float) -> Path:
    """Begin a record, take so many readings out and back, and leave the next place asked for."""
    text = FOUR_READINGS.replace("readings = 4", f"readings = {2 * OUT}")
    described = campaign_from_texts(text, "campaign.toml", load_machine("one-axis").text, "one-axis")
    with Campaign.create(
        record, described, lambda case, known, readings, *_: tuple(PLACES[len(readings) :])
    ) as campaign:
        for place in PLACES[:count]:
            campaign.record(value_at(place, step), at=place)
        campaign.next()
    return record
