"""The instruments by name: what each reads, and what a description that is silent may assume of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from axiscal.measurement.instruments.displacement import Displacement, Length
from axiscal.measurement.instruments.distance import SHIFTS, TURNS, ZEROS, Distance, Nest, Tracker
from axiscal.measurement.instruments.kind import CARRIED, Instrument, Kind, Rotation
from axiscal.measurement.setup import Setup, Unknown
from axiscal.numerics import Array
from axiscal_core.instrument import TOOL


def _open(names: Sequence[str], std: float) -> tuple[Unknown, ...]:
    return tuple(Unknown(name, std) for name in names)


_CARRIED = _open(TOOL, CARRIED)
_CUP, _TRACED, _THREE = _open(SHIFTS, 1e-4), _open(SHIFTS, 5e-3), _open(ZEROS, 1e-3)
"""Open: a cup is set to a tenth of a millimetre, a tracer stands within five; zeros are known before to one."""
_LASER, _GAUGE, _INCLINED = ((5e-6 / 3600, 3e-6 / 3600), (10e-6 / 3600, 3e-6 / 3600), (2e-6 / 3600, 2e-6 / 3600))
"""Drifts by the hour, as a rule and where all is warm: see the sources and assumptions below."""
_TRACKED = *_THREE, *_open(TURNS, 1e-3)
"""Open of a station that is set up by eye: three lengths, and turns of a milliradian (an assumption)."""
_ZERO = Unknown("zero", 1e-3)
_SLOPE = Unknown("slope", 1e-3)

LENGTH = "gauge"
"""A length between two places: a gauge block, a step gauge, a bar of two balls, a ruler, or calipers on a workpiece."""

_OURS = (
    Instrument("interferometer", Displacement, 0.3e-6, (_ZERO,), 1800.0, 1.0, 3.0, _LASER, "line", "free", True, True),
    Instrument("indicator", Displacement, 1.0e-6, (_ZERO,), 600.0, 1.0, 5.0, _GAUGE, display=True),
    Instrument("probe", Displacement, 1.0e-6, (_ZERO,), 600.0, 0.5, 6.0, _GAUGE, "reach", "retracted"),
    Instrument(LENGTH, Length, 20e-6, (), 120.0, 0.0, 20.0, (0.0, 0.0), "length"),
    Instrument("straightedge", Displacement, 1e-6, (_ZERO, _SLOPE), 1200.0, 1.0, 5.0, _GAUGE, "reach", display=True),
    Instrument("level", Rotation, 2.0e-6, (_ZERO,), 300.0, 5.0, 5.0, _INCLINED),
    Instrument("autocollimator", Rotation, 0.5e-6, (_ZERO,), 1800.0, 1.0, 3.0, _INCLINED, "line"),
    Instrument("ballbar", Distance, 0.5e-6, (_ZERO, *_CUP, *_CARRIED), 900.0, 0.5, 1.0, _GAUGE, "bar"),
    Instrument("rtest", Nest, 0.7e-6, (*_THREE, *_CARRIED), 900.0, 1.0, 3.0, _GAUGE, "ball", "held"),
    Instrument("sphere", Nest, 1.5e-6, (), 300.0, 1.0, 15.0, _GAUGE, "ball", "retracted"),
    Instrument("tracker", Tracker, 10e-6, (*_TRACKED, *_CARRIED), 3600.0, 2.0, 5.0, _LASER, "sight", "free", True),
    Instrument("tracer", Distance, 0.3e-6, (_ZERO, *_TRACED, *_CARRIED), 1800.0, 1.0, 3.0, _LASER, "sight", light=True),
)  # fmt: skip
INSTRUMENTS: Mapping[str, Instrument] = MappingProxyType({instrument.name: instrument for instrument in _OURS})
"""The indicator is a dial or lever gauge; the straightedge is read by an indicator and lies at an unknown angle; the
level is an electronic one; a sphere is touched from all sides by a probe in the spindle, and mounted ball by ball; the
tracer is a length-only interferometer that follows the tool from a station nobody knows well. What carries a ball or a
mirror in the spindle is known to a tenth of a millimetre (an assumption). The noise of a length is that of calipers up
to 150 mm, whose maximum permissible error is 20 um as a rule.

Drifts: of a laser 1 ppm/K of 0.2 m of dead path at 1 K/h, 0.2 um/h (user's guides of HP 5528A and Agilent 5530), and of
the machine 5 um/h, an assumption; of what touches 10 um/h in the first hour after power-up or a spindle run and 3 um/h
after, an assumption, as ISO 230-3 and ISO/TR 16015 define a test and give no number; 2 urad/h is one as well."""

PRINTER_PROBE = replace(INSTRUMENTS["probe"], noise=5e-6, setup_time=60.0)
"""The probe of a 3D printer, which is there already. What owners have shown of Klipper's PROBE_ACCURACY, a standard
deviation of ten readings, goes from 0.8 um (docked microswitches) to 13 um (inductive ones); 5 um is an assumption."""


HALVES = replace(INSTRUMENTS[LENGTH], model=Displacement, unknowns=(Unknown("zero", 1e-2),))
"""A length in records of before: half of what it is too long at each end, from a zero that nobody knows."""


def instrument_of(setup: Setup) -> Instrument:
    """Return the instrument of a set-up, with its usual figures."""
    if setup.instrument == LENGTH and setup.start is None:
        return HALVES
    return setup.written or INSTRUMENTS[setup.instrument]


def model_of(setup: Setup) -> type[Kind]:
    """Return what a set-up sees."""
    return instrument_of(setup).model


def values_of(setup: Setup) -> int:
    """Return how many numbers a reading of a set-up has."""
    return len(model_of(setup).names_of(setup))


def scales_of(setup: Setup) -> Array:
    """Return by what each number of a reading is multiplied within rows, so that all are equally noisy, (k,)."""
    return np.array(model_of(setup).scales or (1.0,) * values_of(setup))


def reads_angles(setup: Setup) -> bool:
    """Return whether a set-up reads angles, at least with its first number."""
    return model_of(setup).reads == "angle"
