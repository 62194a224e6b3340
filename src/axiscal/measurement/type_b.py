"""Type B: what an instrument or a temperature is off by although no reading shows it (GUM 4.3).

A row is one cause that a class of instruments has. Its column b is the effect of one standard deviation on each number
that is read; all readings that share the cause have it in common. It moves no estimate, and U has what it does to the
estimate.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal

import numpy as np

from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal_core.instrument import At

Distribution = Literal["normal", "rectangular"]
_STDS: dict[Distribution, float] = {"normal": 1.0, "rectangular": 1 / float(np.sqrt(3.0))}
"""Standard deviation of a distribution of size one: that of a rectangular one is its half width."""
Shared = Literal["set-up", "instrument", "machine"]
"""Whose readings have one unknown in common: of one set-up, of all set-ups of one instrument, all."""


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
    """One cause.

    name : of the cause, and of the size in `Setup.stated` that replaces the default
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
    size: float
    unit: str
    source: str
    shared: Shared
    effect: Callable[[Read, float], Array]
    distribution: Distribution = "normal"
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
        return self in setup.type_b and self.applies(setup) and not own & set(self.covered)


def scaled(read: Read, size: float) -> Array:
    """Return a strain of lengths, (k, r)."""
    return size * read.along


def constant(read: Read, size: float) -> Array:
    """Return the size itself, (k, r)."""
    return size * read.ones


def of_reading(read: Read, size: float) -> Array:
    """Return a share of what was read, from its mean where the zero is open, (k, r)."""
    zeroed = any(unknown.name.startswith("zero") for unknown in read.setup.unknowns)
    return size * (read.values - read.values.mean(axis=1, keepdims=True) if zeroed else read.values)


def _unlike(read: Read, size: float) -> Array:
    """Return what another expansion does, by as much as the material is warm or may be, (k, r)."""
    setup = read.setup
    warmer = dict(setup.stated).get("temperature", TEMPERATURE.size) if setup.warmer is None else setup.warmer
    return size * warmer * read.along


def _warm(setup: Setup, cause: str, measured: bool | None = None) -> bool:
    """Whether a cause of the material's temperature counts.  measured : only where that is, or is not, measured"""
    balls = setup.artefact is not None and setup.artefact.calibrated is not None
    measures = balls or setup.against_length  # compares positions with them, or a wavelength
    if not setup.at_20 or not measures or measured not in (None, setup.warmer is not None):
        return False
    stated = {"temperature", "expansion"} & set(dict(setup.stated))
    grown = any(unknown.name == "growth" for unknown in setup.unknowns)
    return not (grown and (cause in stated or not stated))


_EXPANDS = "steel, 11.7 um/m/K; ISO 1, ISO/TR 230-9"
TEMPERATURE = TypeB(
    "temperature", 1.0, "K", f"assumption; {_EXPANDS}", "machine",
    lambda read, size: size * read.setup.expansion * read.along,
    applies=partial(_warm, cause="temperature", measured=False),
)  # fmt: skip
MEASURED_TEMPERATURE = replace(
    TEMPERATURE, size=0.3, source=f"assumption, if it was measured; {_EXPANDS}",
    applies=partial(_warm, cause="temperature", measured=True),
)  # fmt: skip
EXPANSION = TypeB(
    "expansion", 1e-6, "um/m/K", "steels differ by as much (GUM H.1)", "machine", _unlike,
    applies=partial(_warm, cause="expansion"),
)  # fmt: skip
WARM = TEMPERATURE, MEASURED_TEMPERATURE, EXPANSION
"""Of what compares positions with a length; a set-up has keys of its own for them."""
AIR = TypeB(
    "air", float(np.hypot(1.0 * 0.5, 0.27 * 2.0)) * 1e-6, "um/m",
    "1 ppm/K of 0.5 K, 0.27 ppm/hPa of 2 hPa (Birch and Downs 1994; the room is an assumption)", "machine", scaled,
)  # fmt: skip
"""Of what compares positions with the wavelength."""
GAIN = TypeB(
    "gain", 0.01, "mm/m", "assumption: 1 %, at least 1 um", "instrument", of_reading, least=1e-6, of_values=True,
)  # fmt: skip
