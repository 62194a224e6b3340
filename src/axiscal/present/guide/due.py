"""What is due beside the readings: the temperature, and the place that shows whether a zero has wandered."""

from __future__ import annotations

import re
from dataclasses import dataclass
from datetime import UTC, datetime

from axiscal.campaign.campaign import Campaign

_DEGREES = re.compile(r"(-?[0-9]+(?:[.,][0-9]+)?)\s*(?:°\s*C|degC)\b")
_EVERY = 30.0
"""Minutes after which the temperature is asked for again: a workshop moves by tenths of a kelvin in that time."""


@dataclass(frozen=True, slots=True)
class Due:
    """temperature : last noted, degC; minutes_ago : since then; ask : whether to note it now

    marker : seconds of machine time until a place is read again that shows a drift, None where none is planned
    """

    temperature: float | None
    minutes_ago: float
    ask: bool
    marker: float | None


def due(campaign: Campaign) -> Due:
    """Return what is due now."""
    warm, ago = _temperature(campaign)
    return Due(warm, ago, warm is None or ago >= _EVERY, _marker(campaign))


def _temperature(campaign: Campaign) -> tuple[float | None, float]:
    for note in reversed(campaign.state.notes):
        if (found := _DEGREES.search(note.text)) is not None:
            ago = (datetime.now(UTC) - datetime.fromisoformat(note.at)).total_seconds() / 60
            return float(found[1].replace(",", ".")), max(ago, 0.0)
    return None, 0.0


def _marker(campaign: Campaign) -> float | None:
    places, read = campaign.state.coming, {reading.place for reading in campaign.state.readings}
    first = next((n for n, place in enumerate(places) if place in read), None)
    return None if first is None else campaign.seconds(places[:first]) - campaign.seconds()
