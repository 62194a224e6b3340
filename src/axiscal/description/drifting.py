"""How fast the zero of a set-up may wander: as stated, or as zeros of its instrument usually do."""

from __future__ import annotations

from collections.abc import Sequence

from axiscal.description.campaign_schema import SetupTable
from axiscal.document import shown
from axiscal.exceptions import DescriptionError, UnitError
from axiscal.measurement.instrument import Instrument
from axiscal.measurement.setup import SaidOfDrift, Unknown
from axiscal.units import parse_quantity

_FASTEST = 1e-3 / 60
"""A zero that wanders by more than 1 mm (1 mrad) a minute is loose."""


def stated_drift(text: str, usual: Instrument) -> float:
    """Return the rate that a set-up states, m/s or rad/s; raises DescriptionError or UnitError for none."""
    if text.strip() == "0":
        return 0.0
    angular = usual.reads == "angle"
    remedy = f'Give one such as "{"2 urad/h" if angular else "2 um/h"}"'
    try:
        rate = parse_quantity(text, "rotation_speed" if angular else "speed")
    except UnitError as fault:
        raise UnitError(fault.what, remedy) from None
    if not 0 <= rate <= _FASTEST:
        raise DescriptionError(f"{shown(text)} is no rate at which a zero wanders", remedy)
    return rate


def usual_drift(table: SetupTable, usual: Instrument, moves: Sequence[int], unknowns: Sequence[Unknown]) -> float:
    """Return the rate where none is stated: that of the instrument for one axis under a zero that is not known.

    Where several axes move, or the zero is known, it stands still in the model.
    """
    open_zero = any(unknown.name.startswith("zero") for unknown in unknowns)
    return usual.wanders[table.warm] if open_zero and len(moves) == 1 else 0.0


def drift_of(
    table: SetupTable, usual: Instrument, moves: Sequence[int], unknowns: Sequence[Unknown], by_default: bool
) -> tuple[float, SaidOfDrift]:
    """Return the rate of a set-up's zero, m/s or rad/s, and who says so.

    moves, unknowns : of the set-up; by_default : whether zeros wander of which nothing is stated
    """
    if table.drift is not None:
        rate = stated_drift(table.drift, usual)
        return rate, "stated" if rate > 0 else "denied"
    rate = usual_drift(table, usual, moves, unknowns) if by_default else 0.0
    return rate, "usual" if rate > 0 else "nothing"
