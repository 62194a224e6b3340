"""Type B: what an instrument or a temperature is off by although no reading shows it (GUM 4.3).

A row of `TYPE_B` is one cause. Its column b is the effect of one standard deviation on each number that is read; all
readings that share the cause have it in common. It moves no estimate, and U has what it does to the estimate.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal

import numpy as np

from axiscal.measurement.instruments.displacement import SQUARE
from axiscal.measurement.instruments.distance import Distance
from axiscal.measurement.setup import Setup
from axiscal.measurement.touched import touch_frames
from axiscal.numerics import Array
from axiscal_core.instrument import At

Distribution = Literal["normal", "rectangular"]
_STDS: dict[Distribution, float] = {"normal": 1.0, "rectangular": 1 / float(np.sqrt(3.0))}
"""Standard deviation of a distribution of size one: that of a rectangular one is its half width."""
Shared = Literal["set-up", "instrument", "machine"]
"""Whose readings have one unknown in common: of one set-up, of all set-ups of one instrument, all."""

WITH_LIGHT = ("interferometer", "tracer", "tracker")
"""Instruments that compare positions with the wavelength."""
_OF_AIR = float(np.hypot(1.0 * 0.5, 0.27 * 2.0)) * 1e-6
"""Strain: 1 ppm/K of 0.5 K, 0.27 ppm/hPa of 2 hPa."""


@dataclass(frozen=True, eq=False)
class Read:
    """The readings of one set-up.

    at : places of r readings; ways : (k, r, 3) along which each of their numbers reads; values : (k, r)
    """

    setup: Setup
    at: At
    ways: Array
    values: Array

    @property
    def along(self) -> Array:
        """How far the tool is from where lengths count, along what each number reads, (k, r), m."""
        along: Array = np.sum(self.ways * (self.at.tcp - self.setup.middle(self.at)), axis=2)
        return along

    @property
    def ones(self) -> Array:
        """1 for each number, (k, r)."""
        return np.ones(self.values.shape)


@dataclass(frozen=True)
class TypeB:
    """One row of the table.

    name : of the cause, and of the size in `Setup.stated` that replaces the default; instruments : that have it
    size : default, in SI units: standard deviation, or half width of a rectangular distribution
    unit : in which the size is shown; source : where the default comes from
    shared : whose readings have it in common
    effect : what it does to the numbers of a set-up at a size, (k, r) m or rad
    applies : whether a set-up has it; covered : unknowns of a set-up that hold it already
    longer : added to the size for each metre of a bar
    least : m, what an indicator shows between two of its numbers, or one and nought, is off by as much at least
    of_values : it follows from what was read, so that it cannot judge the readings
    """

    name: str
    instruments: tuple[str, ...]
    distribution: Distribution
    size: float
    unit: str
    source: str
    shared: Shared
    effect: Callable[[Read, float], Array]
    applies: Callable[[Setup], bool] = lambda setup: True
    covered: tuple[str, ...] = ()
    longer: float = 0.0
    least: float = 0.0
    of_values: bool = False

    def column(self, read: Read) -> Array:
        """Return what one standard deviation does to each number, (k, r), m or rad."""
        size = dict(read.setup.stated).get(self.name, self.size + self.longer * (read.setup.length or 0.0))
        shown = _STDS[self.distribution] * self.effect(read, size)
        highest, lowest = shown.max(axis=1, initial=0.0), shown.min(axis=1, initial=0.0)
        apart = float(np.max(highest - lowest))
        if self.least and self.name not in dict(read.setup.stated) and 0 < apart < self.least:
            shown = shown * min(self.least / apart, 1 / size)  # never more than all of the reading
        return shown

    def met(self, setup: Setup) -> bool:
        """Whether a set-up has this cause and nothing else holds it."""
        own = {unknown.name for unknown in setup.unknowns}
        return setup.instrument in self.instruments and self.applies(setup) and not own & set(self.covered)


def _scaled(read: Read, size: float) -> Array:
    return size * read.along


def _distant(read: Read, size: float) -> Array:
    """Return a strain of the distance from the station, (k, r)."""
    stations = np.array(read.setup.standing)
    strained: Array = size * np.linalg.norm(read.at.tcp - stations[:, None], axis=2)
    return strained


def _by_light(read: Read, size: float) -> Array:
    return _distant(read, size) if isinstance(read.setup, Distance) else _scaled(read, size)


def _constant(read: Read, size: float) -> Array:
    return size * read.ones


def _unlike(read: Read, size: float) -> Array:
    """Return what another expansion does, by as much as the material is warm or may be, (k, r)."""
    setup = read.setup
    warmer = dict(setup.stated).get("temperature", TEMPERATURE.size) if setup.warmer is None else setup.warmer
    return size * warmer * read.along


def _of_reading(read: Read, size: float) -> Array:
    zeroed = any(unknown.name.startswith("zero") for unknown in read.setup.unknowns)
    return size * (read.values - read.values.mean(axis=1, keepdims=True) if zeroed else read.values)


def _larger(read: Read, size: float) -> Array:
    """Return what a larger sphere and stylus do: in the mean of opposite sides its pole alone shows them, (k, r)."""
    touched = touch_frames(read.setup.machine, read.at.poses)
    met = touched.sum(axis=1) if read.setup.three_touches else touched[:, 2]
    larger: Array = -size * np.sum(read.ways * met, axis=2)
    return larger


def _bowed(read: Read, size: float) -> Array:
    """Return a bow, (k, r), whose sag is `size` times its length."""
    way = read.setup.travelled(read.at.poses)
    span = float(np.ptp(way))
    bowed: Array = size * span * (2 * (way - way.min()) / (span or 1.0) - 1) ** 2 * read.ones
    return bowed


def _warm(setup: Setup, cause: str, measured: bool | None = None) -> bool:
    """Whether a cause of the material's temperature counts.  measured : only where that is, or is not, measured"""
    balls = setup.artefact is not None and setup.artefact.calibrated is not None
    measures = balls or setup.against_length  # compares positions with them, or a wavelength
    if not setup.at_20 or not measures or measured not in (None, setup.warmer is not None):
        return False
    stated = {"temperature", "expansion"} & set(dict(setup.stated))
    grown = any(unknown.name == "growth" for unknown in setup.unknowns)
    return not (grown and (cause in stated or not stated))


_ALL_LENGTHS = (*WITH_LIGHT, "gauge", "rtest", "sphere")
_ASSUMED = "assumption"
_REFRACTION = "1 ppm/K of 0.5 K, 0.27 ppm/hPa of 2 hPa (Birch and Downs 1994; the room is an assumption)"
_EXPANDS = "steel, 11.7 um/m/K; ISO 1, ISO/TR 230-9"

TEMPERATURE = TypeB(
    "temperature", _ALL_LENGTHS, "normal", 1.0, "K", f"assumption; {_EXPANDS}", "machine",
    lambda read, size: size * read.setup.expansion * read.along,
    partial(_warm, cause="temperature", measured=False),
)  # fmt: skip
MEASURED_TEMPERATURE = replace(
    TEMPERATURE, size=0.3, source=f"assumption, if it was measured; {_EXPANDS}",
    applies=partial(_warm, cause="temperature", measured=True),
)  # fmt: skip

TYPE_B = (
    TypeB(
        "scale", ("interferometer",), "normal", 1e-6, "um/m",
        "no certificate; a free red helium-neon laser is known to 1.5 ppm (Stone et al. 2009)", "instrument", _by_light,
    ),
    TypeB(
        "scale", ("gauge",), "normal", 20e-6, "um/m", "assumption; a gauge block has 1 um/m", "instrument", _scaled,
    ),
    TypeB("air", WITH_LIGHT, "normal", _OF_AIR, "um/m", _REFRACTION, "machine", _by_light),
    TypeB(
        "cosine", ("interferometer",), "rectangular", 1e-3, "mrad", "beam set by eye; 1 − cos is half its square",
        "set-up", lambda read, size: size**2 / 2 * read.along,
    ),
    TypeB(
        "dead_path", ("interferometer",), "normal", 0.2, "mm", "assumption; its air is as above", "set-up",
        lambda read, size: dict(read.setup.stated).get("air", _OF_AIR) * size * read.ones, covered=("zero",),
    ),
    TEMPERATURE,
    MEASURED_TEMPERATURE,
    TypeB(
        "expansion", _ALL_LENGTHS, "normal", 1e-6, "um/m/K", "steels differ by as much (GUM H.1)", "machine", _unlike,
        partial(_warm, cause="expansion"),
    ),
    TypeB(
        "scale", ("tracer", "tracker"), "normal", 1.5e-6, "um/m", "assumption; its maker states an MPE", "instrument",
        _by_light,
    ),
    TypeB(
        "length", ("ballbar",), "normal", 1e-6, "um", "assumption: 1 um and 2 um/m", "instrument", _constant,
        covered=("zero",), longer=2e-6,
    ),
    TypeB(  # each leg has half of the angle between two
        "square", ("straightedge",), "normal", 10e-6, "urad", _ASSUMED, "set-up",
        lambda read, size: size / np.sqrt(2.0) * read.setup.travelled(read.at.poses) * read.ones,
        lambda setup: any(unknown.name in SQUARE for unknown in setup.unknowns),
    ),
    TypeB("bow", ("straightedge",), "normal", 2e-6, "um/m", _ASSUMED, "set-up", _bowed),
    TypeB(
        "gain", ("indicator", "straightedge", "rtest"), "normal", 0.01, "mm/m", "assumption: 1 %, at least 1 um",
        "instrument", _of_reading, least=1e-6, of_values=True,
    ),
    TypeB("gain", ("level",), "normal", 0.02, "mm/m", "assumption: 2 %", "instrument", _of_reading, of_values=True),
    TypeB(
        "gain", ("autocollimator",), "normal", 0.01, "mm/m", "assumption: 1 %", "instrument", _of_reading,
        of_values=True,
    ),
    TypeB("radius", ("sphere",), "normal", 1e-6, "um", _ASSUMED, "instrument", _larger, covered=("radius",)),
    TypeB("pre_travel", ("probe",), "normal", 1e-6, "um", _ASSUMED, "instrument", _constant, covered=("zero",)),
)  # fmt: skip
"""What no reading shows, by instrument."""

_OWN_KEYS = ("temperature", "expansion")
"""Keys of a set-up of their own."""


def _by_itself(read: Read, size: float, name: str) -> Array:
    """Return what the class of an instrument shows of a cause of its own, (k, r)."""
    return size * read.setup.own_slopes(read.at, (name,))[:, :, 0].T


def rows_of(instrument: type[Setup]) -> Iterator[TypeB]:
    """Yield the causes of an instrument: of the table, and those that its class names."""
    yield from (row for row in TYPE_B if instrument.instrument in row.instruments)
    for name, size, unit in instrument.type_b:
        effect, of = partial(_by_itself, name=name), (instrument.instrument,)
        yield TypeB(name, of, "normal", size, unit, "its class", "instrument", effect, covered=(name,))


def type_b_names(instrument: type[Setup]) -> dict[str, TypeB]:
    """Return the causes of an instrument that the key type_b of a set-up may state, by name."""
    return {row.name: row for row in rows_of(instrument) if row.name not in _OWN_KEYS}
