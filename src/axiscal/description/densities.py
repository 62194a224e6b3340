"""What readings of a set-up are off beside normal noise: within a bound, by a dead band, to one side by chips."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import replace

import numpy as np

from axiscal.description.campaign_schema import SetupTable
from axiscal.document import shown
from axiscal.exceptions import DescriptionError, UnitError
from axiscal.machine import Machine
from axiscal.measurement.instrument import model_of
from axiscal.measurement.instruments.kind import Nominal
from axiscal.measurement.setup import FINEST, Setup, Unknown
from axiscal.units import EXAMPLES, parse_quantity

At = Callable[..., AbstractContextManager[None]]
"""Places failures at the keys of a set-up."""
_WIDEST = 1e-2
"""m or rad: what is off by more is no instrument."""
_CHIP = 20e-6
"""m: a fine chip or burr, where nobody says how large they are (an assumption)."""


def dense(table: SetupTable, machine: Machine, at: At, setup: Setup) -> Setup:
    """Return a set-up whose readings are not all normal, as its table says; raises DescriptionError or UnitError.

    A dead band along which the set-up moves is a lag, whose sign follows from the side of approach; across it, or
    where more than one axis moves, nobody knows its sign: a bound.
    """
    with at("bound"):
        bound = _size(table.bound, setup)
    with at("dead_band"):
        band = _size(table.dead_band, setup)
    with at("one_sided"):
        chips = _chips(table.one_sided, setup)
    if band and "lag" in (unknown.name for unknown in setup.unknowns):
        with at("dead_band"):
            raise DescriptionError("a dead band is a lag, which is among the unknowns already", "Keep one of them")
    if band and lags(setup, machine):
        setup, band = replace(setup, unknowns=(*setup.unknowns, Unknown("lag", band))), 0.0
    bound += band
    noise = math.hypot(setup.noise, bound / math.sqrt(3.0))
    return replace(setup, noise=noise, bound=bound, one_sided=chips)


def lags(setup: Setup, machine: Machine) -> bool:
    """Whether the side of approach says on which side of a dead band each reading is."""
    linear = [k for k in setup.moves if not machine.axes[k].rotary]
    if "lag" not in model_of(setup).unknown_reads or setup.moves != tuple(linear) or len(linear) != 1 or setup.chart:
        return False
    nominal = Nominal(machine, np.array([setup.park]), setup.moves, approaches=np.ones((1, len(machine.axes))))
    return bool(model_of(setup).unknown_effect(setup, "lag", np.array(setup.direction), nominal)[0])


def _size(text: str | None, setup: Setup) -> float:
    """Return half the width, m or rad; 0 where there is none."""
    if text is None:
        return 0.0
    reads = model_of(setup).reads
    size = parse_quantity(text, reads)
    if not FINEST <= size <= _WIDEST:
        raise DescriptionError(f"{shown(text)} is no half of a width", f'Give one such as "{EXAMPLES[reads]}"')
    return size


def _chips(text: str | None, setup: Setup) -> float:
    """Return by how much chips shift a reading, m or rad, with their side."""
    if text is None:
        return 0.0
    sign, size = text.strip()[:1], text.strip()[1:].strip()
    remedy = 'Write "+" or "-", with their usual size behind it if it is known, such as "+ 20 um"'
    if sign not in ("+", "-"):
        raise DescriptionError(f"{shown(text)} does not say to which side", remedy)
    if model_of(setup).reads == "angle":
        raise DescriptionError("chips shift what touches a surface, and this instrument reads an angle", "Take it out")
    try:
        found = _size(size, setup) if size else _CHIP
    except UnitError as fault:
        raise UnitError(fault.what, remedy) from None
    return found if sign == "+" else -found
