"""The instruments by name."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from axiscal.measurement.instruments.displacement import Indicator, Interferometer, Length, Probe, Straightedge
from axiscal.measurement.instruments.distance import BallBar, RTest, TouchedSphere, Tracer, Tracker
from axiscal.measurement.instruments.rotation import Autocollimator, Level
from axiscal.measurement.setup import Setup

_OURS = (
    *(Interferometer, Indicator, Probe, Length, Straightedge, Level),
    *(Autocollimator, BallBar, RTest, TouchedSphere, Tracker, Tracer),
)
INSTRUMENTS: Mapping[str, type[Setup]] = MappingProxyType({each.instrument: each for each in _OURS})
"""Those that a campaign may name; packages and files bring others."""
