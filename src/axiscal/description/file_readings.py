"""The readings of a file with what it says of its set-up: where the probe of a printer stands beside the nozzle."""

from __future__ import annotations

import math
from pathlib import Path

from axiscal.description.campaign import CampaignDescription, with_offset
from axiscal.description.placed_readings import placed_readings
from axiscal.description.setup_of_reading import setup_of
from axiscal.exceptions import InputError, ReadingError
from axiscal.measurement.readers.csv_readings import RawReading
from axiscal.measurement.reading import Reading
from axiscal.units import format_quantity

_SAME = 1e-4
"""m, to which a probe may stand elsewhere than stated: nobody measures it better."""


def file_readings(
    raw: tuple[RawReading, ...], campaign: CampaignDescription, file: str | Path
) -> tuple[CampaignDescription, tuple[Reading, ...]]:
    """Return a campaign that says where its probe stood, and its readings as of `placed_readings`.

    Raises ReadingError at the line that does not fit.
    """
    told = next((row for row in raw if row.beside is not None), None)  # all readings of a file are by one probe
    if told is not None and told.beside is not None:
        try:
            campaign = _with_beside(campaign, setup_of(told, campaign)[0].name, told.beside)
        except InputError as failure:
            raise ReadingError(failure.what, failure.remedy, file, told.line) from None
    return campaign, placed_readings(raw, campaign, file)


def _with_beside(campaign: CampaignDescription, name: str, beside: tuple[float, float]) -> CampaignDescription:
    own = campaign.setup(name).offset
    if own is None:
        return with_offset(campaign, name, beside)
    if math.dist(beside, own[:2]) > _SAME:
        said, stated = (" ".join(format_quantity(each, "mm", 6) for each in pair) for pair in (beside, own[:2]))
        what = 'the probe stands {said} beside the nozzle along x and y by this file, and {stated} by "{setup}"'
        raise ReadingError(what, "Correct offset in campaign.toml", said=said, setup=name, stated=stated)
    return campaign
