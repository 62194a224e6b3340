"""The log of measuring programs as readings of a campaign; what it lacks is said."""

from __future__ import annotations

from pathlib import Path

from axiscal.cli.printing import tell
from axiscal.description.campaign import CampaignDescription
from axiscal.description.placed_readings import logged_readings, placed_readings
from axiscal.estimation.wrong_unit import refuse_implausible
from axiscal.exceptions import ReadingError
from axiscal.measurement.reading import Reading


def placed_log(log: Path, programs: Path, description: CampaignDescription) -> tuple[Reading, ...]:
    """Return the readings of a log; raises ReadingError.  programs : the folder of the programs that wrote it"""
    found = logged_readings(log, programs, description)
    for sentence in found.said:
        tell(f"Mind: {sentence}")
    if not found.readings:
        raise ReadingError("no reading of this log is whole", "Run the programs again", log)
    placed = placed_readings(found.readings, description, log)
    refuse_implausible(placed, description, log)
    return placed
