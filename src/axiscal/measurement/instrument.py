"""The instruments by name: what each reads, and what a description that is silent may assume of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from axiscal.measurement.setup import Unknown

Reads = Literal["length", "angle"]

UNKNOWN_NAMES = ("zero", "slope")


@dataclass(frozen=True, slots=True)
class Instrument:
    """Usual figures of a kind of instrument; every one of them can be replaced in the description of a set-up.

    reads : a displacement along the set-up's direction ("length") or a rotation about it ("angle")
    noise : standard deviation of one reading, m or rad
    unknowns : what each new mounting leaves open, with prior standard deviations
    setup_time, settle, reading_time : s
    """

    name: str
    reads: Reads
    noise: float
    unknowns: tuple[Unknown, ...]
    setup_time: float
    settle: float
    reading_time: float


_ZERO_LENGTH = Unknown("zero", 1e-3)
_ZERO_ANGLE = Unknown("zero", 1e-3)

INSTRUMENTS: Mapping[str, Instrument] = MappingProxyType(
    {
        instrument.name: instrument
        for instrument in (
            Instrument("interferometer", "length", 0.3e-6, (_ZERO_LENGTH,), 1800.0, 1.0, 3.0),
            Instrument("indicator", "length", 1.0e-6, (_ZERO_LENGTH,), 600.0, 1.0, 5.0),
            Instrument("probe", "length", 1.0e-6, (_ZERO_LENGTH,), 600.0, 0.5, 6.0),
            Instrument("straightedge", "length", 1.0e-6, (_ZERO_LENGTH, Unknown("slope", 1e-3)), 1200.0, 1.0, 5.0),
            Instrument("level", "angle", 2.0e-6, (_ZERO_ANGLE,), 300.0, 5.0, 5.0),
            Instrument("autocollimator", "angle", 0.5e-6, (_ZERO_ANGLE,), 1800.0, 1.0, 3.0),
        )
    }
)
"""The instruments that read one length or one angle at a time. The indicator is a dial or lever gauge; the straightedge
is read by an indicator and lies at an unknown angle; the level is an electronic one."""

NOT_YET = ("ballbar", "rtest", "tracker", "tracer")
"""Names that are reserved in descriptions; their readings are not a single length or angle along a fixed direction."""
