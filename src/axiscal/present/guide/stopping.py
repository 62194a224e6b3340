"""What there would be if the campaign ended now: the table of each control, tried as it would be loaded."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

from axiscal.campaign.campaign import Campaign
from axiscal.exceptions import ReadingError, TableError
from axiscal.record.opening import file_name
from axiscal.tables import registry


@dataclass(frozen=True, slots=True)
class TableLeft:
    """What is to be expected over the volume without and with the table of one control: RMS, m.

    refusal : why there is no table for it, "" where there is one
    """

    controller: str
    before: float
    expected: float
    refusal: str = ""


def controls_of(campaign: Campaign) -> tuple[str, ...]:
    """Return the controls that hold tables: those of the campaign first, then all others."""
    names = dict.fromkeys((*campaign.description.controls, *registry.CONTROLLERS))
    return tuple(name for name in names if name != "csv")


def table_left(campaign: Campaign, controller: str) -> TableLeft:
    """Return what the table of a control would do if the readings so far were all; nothing is written."""
    estimation = campaign.estimate(ended=True)
    try:
        offered = registry.offered(estimation, controller)
    except (TableError, ReadingError) as refusal:
        return TableLeft(controller, 0.0, 0.0, f"{refusal.what}.")
    return TableLeft(controller, math.hypot(offered.effect.before, offered.unknown), offered.expected)


def results_beside(record: Path) -> Path:
    """Return the folder for the results of a record, beside it."""
    return (file := file_name(record)).with_name(f"{file.stem}-results")
