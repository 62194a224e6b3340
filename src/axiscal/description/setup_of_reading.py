"""Which set-up of a campaign a reading of a file belongs to, where the file names it, and where it names none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from axiscal.description.campaign import CampaignDescription
from axiscal.exceptions import ReadingError
from axiscal.language.spoken import WORDS, joined, said
from axiscal.machine.error_names import error_named
from axiscal.machine.kinematics import in_frame
from axiscal.measurement.charts.kinds import Circle
from axiscal.measurement.readers.csv_readings import RawReading
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal_core.machine import Machine

_ALONG = 1 - 1e-9
"""Rounding of a unit vector that points along an axis."""


def setup_of(row: RawReading, campaign: CampaignDescription) -> tuple[Setup, int]:
    """Return the set-up of a reading, and −1 where it reads against the error that the file names."""
    if row.setup:
        return campaign.setup(row.setup), 1
    if row.test is not None:
        return _tested(row, campaign)
    if not row.error:
        if len(campaign.setups) > 1 or len(campaign.setups[0].moves) > 1:
            what = "the readings name neither set-up nor axis, and the campaign has more than one of them"
            remedy = "Give the columns setup and X_mm, or a campaign of one set-up with one moving axis"
            raise ReadingError(what, remedy)
        return campaign.setups[0], 1
    component = 2 if row.error == "z" else error_named(row.error).component % 3
    moving = {campaign.machine.index(name) for name in row.position}
    reads = (s for s in campaign.setups if s.reads == row.dimension and moving <= set(s.moves))
    ways = ((setup, float(_direction_in_frame(setup, campaign.machine)[component])) for setup in reads)
    fitting = [(setup, along) for setup, along in ways if abs(along) > _ALONG]
    if len(fitting) != 1:
        what = "several set-ups read {error} while {moving} moves"
        what = what if fitting else "no set-up reads {error} while {moving} moves"
        remedy = "Describe exactly one set-up for it, or give READINGS.csv with a column setup"
        error = said("a length along z") if row.error == "z" else row.error
        raise ReadingError(what, remedy, error=error, moving=", ".join(row.position))
    ((setup, along),) = fitting
    return setup, 1 if along > 0 else -1


_ASKS = WORDS["tests"]
_ASIDE = 0.1
"""Of a direction, along an axis: less is across it, and of what is along it this much less than all."""


def _tested(row: RawReading, campaign: CampaignDescription) -> tuple[Setup, int]:
    """Return the only set-up that reads what a test reads, and −1 where it reads against the way of its axis.

    Raises ReadingError for none, and for several.
    """
    fitting = [setup for setup in campaign.setups if _reads_test(row, setup, campaign.machine)]
    if len(fitting) == 1:
        against = row.test == "positioning" and _along(fitting[0], campaign.machine) < 0
        return fitting[0], -1 if against else 1
    what, names = _ASKS[row.test or "circle"], joined([each.name for each in fitting])
    what = "several set-ups read what this test reads: {names}" if fitting else what
    if not fitting and any(_reads_test(replace(row, axis=""), setup, campaign.machine) for setup in campaign.setups):
        what = "the file says that {axis} was tested, and no set-up reads what it reads along {axis}"
    remedy = "Say which axis was read, such as --axis X, or name the set-up in a column setup"
    raise ReadingError(what, remedy, names=names, axis=row.axis)


def _reads_test(row: RawReading, setup: Setup, machine: Machine) -> bool:
    if row.test == "circle":
        return isinstance(setup.chart, Circle)
    axis, reads = machine.axes[setup.moves[0]], setup.reads
    if len(setup.moves) != 1 or reads != row.dimension:
        return False
    fits = reads == "angle" or abs(_along(setup, machine)) < _ASIDE
    if row.test == "positioning":
        fits = abs(_along(setup, machine)) > 1 - _ASIDE
    return fits and row.axis in ("", axis.name) and axis.rotary == (row.target_dimension == "angle")


def _along(setup: Setup, machine: Machine) -> float:
    """Return the cosine between the direction of a set-up and the way of its axis, or what that turns about."""
    return float(_direction_in_frame(setup, machine) @ np.array(machine.axes[setup.moves[0]].direction))


def _direction_in_frame(setup: Setup, machine: Machine) -> Array:
    """Return the direction of a set-up in the frame of the first axis that it moves, (3,)."""
    way: Array = in_frame(machine, setup.moves[0], np.array(setup.park)) @ np.array(setup.direction)
    return way
