"""Causes in campaign.toml that readings do not show: temperatures, type_b, and the reference of the target."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from axiscal.description.campaign_schema import CampaignTable, SetupTable
from axiscal.description.type_b import WITH_LIGHT, type_b_names
from axiscal.description.vectors import At
from axiscal.document import Document, meant, shown
from axiscal.exceptions import DescriptionError, UnitError
from axiscal.language.spoken import said
from axiscal.machine import Machine
from axiscal.measurement.artefact import Artefact
from axiscal.measurement.instrument import Instrument, model_of
from axiscal.measurement.instruments.kind import Nominal
from axiscal.measurement.setup import FINEST, STEEL, SaidOfDrift, Setup, Unknown, Vector
from axiscal.units import EXAMPLES, dimension_of, parse_quantity

_WIDEST = 1e-2
"""m or rad: what is off by more is no instrument."""
_CHIP = 20e-6
"""m: a fine chip or burr, where nobody says how large they are (an assumption)."""

_REFERENCE = 293.15
"""20 degC (ISO 1), K."""
_ALONG = 0.99
"""Cosine; growth along an axis is meant where the direction is within 8 deg of it, and no set-up is between."""


class Material(NamedTuple):
    """What a set-up says of the measured material.

    warmer : K, than 20 °C, None where nobody says; expansion : 1/K
    unknowns : its growth, where it is stated how well that is known; stated : K and 1/K, how well by name
    """

    warmer: float | None
    expansion: float
    unknowns: tuple[Unknown, ...]
    stated: tuple[tuple[str, float], ...]


def refers_to_20(table: CampaignTable, artefacts: Mapping[str, Artefact], document: Document) -> bool:
    """Return whether what is found refers to 20 °C: as stated, else where a set-up compares positions with a length.

    Raises DescriptionError where it is to be as read, and a set-up brings its lengths to 20 °C.
    """
    said = table.target.refers_to
    if said is None:
        return any(_against_length(setup, artefacts) for setup in table.setups)
    warm = next((setup.name for setup in table.setups if setup.temperature is not None), None)
    if said == "as read" and warm is not None:
        what = '"{setup}" states a temperature, which brings its lengths to 20 degC, and the target is "as read"'
        fault = DescriptionError(what, "Take temperature out there, or refers_to here", setup=warm)
        raise document.fault(fault, "target", "refers_to")
    return said == "20 degC"


def _against_length(setup: SetupTable, artefacts: Mapping[str, Artefact]) -> bool:
    artefact = artefacts.get(setup.artefact or "")
    return setup.instrument in WITH_LIGHT or (artefact is not None and artefact.calibrated is not None)


def material_of(
    table: SetupTable, usual: Instrument, machine: Machine, direction: Vector, moves: Sequence[int], at: At
) -> Material:
    """Return what a set-up says of the material; raises DescriptionError or UnitError."""
    expansion = STEEL if table.expansion is None else table.expansion
    said = {"temperature": table.temperature_std, "expansion": table.expansion_std}
    stated = tuple((name, size) for name, size in said.items() if size is not None)
    if table.temperature is None:
        return Material(None, expansion, (), stated)
    with at("temperature"):
        _refuse_growth(usual, machine, direction, moves)
    warmer = table.temperature - _REFERENCE
    std = math.hypot(expansion * (said["temperature"] or 0.0), warmer * (said["expansion"] or 0.0))
    return Material(warmer, expansion, (Unknown("growth", std),) if std > 0 else (), stated)


def _refuse_growth(usual: Instrument, machine: Machine, direction: Vector, moves: Sequence[int]) -> None:
    linear = [machine.axes[index] for index in moves if not machine.axes[index].rotary]
    along = len(linear) == 1 and abs(sum(a * b for a, b in zip(linear[0].direction, direction, strict=True)))
    if "growth" not in usual.model.unknown_reads or not along or along < _ALONG:
        what = "a temperature corrects a length along the one linear axis that moves, and this set-up reads none"
        raise DescriptionError(what, "Take temperature out, or name the axis in moves")


def stated_of(table: SetupTable, usual: Instrument, at: At) -> tuple[tuple[str, float], ...]:
    """Return the sizes under type_b, by name; raises DescriptionError or UnitError."""
    known, found = type_b_names(usual.name), list[tuple[str, float]]()
    for name, text in table.type_b.items():
        with at("type_b", name):
            if name not in known:
                remedy = meant(name, known)
                what = "{name} is not known of an instrument such as this {instrument}"
                raise DescriptionError(what, remedy, name=shown(name), instrument=usual.name)
            dimension = dimension_of(known[name].unit)
            size = parse_quantity(text, dimension)
            if size < 0:
                remedy = 'Give a size such as "{example}"'
                raise DescriptionError("{text} is negative", remedy, text=shown(text), example=EXAMPLES[dimension])
        found.append((name, size))
    return tuple(found)


def dense(table: SetupTable, machine: Machine, at: At, setup: Setup) -> Setup:
    """Return a set-up whose readings are not all normal, as its table says; raises DescriptionError or UnitError.

    A dead band along the moving axis is a lag: its sign follows from the side of approach. Across it, or with several
    moving axes, the sign is unknown: a bound.
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
        remedy = 'Give one such as "{example}"'
        raise DescriptionError("{text} is no half of a width", remedy, text=shown(text), example=EXAMPLES[reads])
    return size


def _chips(text: str | None, setup: Setup) -> float:
    """Return by how much chips shift a reading, m or rad, with their side."""
    if text is None:
        return 0.0
    sign, size = text.strip()[:1], text.strip()[1:].strip()
    remedy = 'Write "+" or "-", with their usual size behind it if it is known, such as "+ 20 um"'
    if sign not in ("+", "-"):
        raise DescriptionError("{text} does not say to which side", remedy, text=shown(text))
    if model_of(setup).reads == "angle":
        raise DescriptionError("chips shift what touches a surface, and this instrument reads an angle", "Take it out")
    try:
        found = _size(size, setup) if size else _CHIP
    except UnitError as fault:
        raise UnitError(fault.what, remedy) from None
    return found if sign == "+" else -found


_FASTEST = 1e-3 / 60
"""A zero that wanders by more than 1 mm (1 mrad) a minute is loose."""


def stated_drift(text: str, usual: Instrument) -> float:
    """Return the rate that a set-up states, m/s or rad/s; raises DescriptionError or UnitError for none."""
    if text.strip() == "0":
        return 0.0
    angular = usual.model.reads == "angle"
    remedy = said('Give one such as "{example}"', example="2 urad/h" if angular else "2 um/h")
    try:
        rate = parse_quantity(text, "rotation_speed" if angular else "speed")
    except UnitError as fault:
        raise UnitError(fault.what, remedy) from None
    if not 0 <= rate <= _FASTEST:
        raise DescriptionError("{text} is no rate at which a zero wanders", remedy, text=shown(text))
    return rate


def drift_of(
    table: SetupTable, usual: Instrument, moves: Sequence[int], unknowns: Sequence[Unknown], by_default: bool
) -> tuple[float, SaidOfDrift]:
    """Return the rate of a set-up's zero, m/s or rad/s, and who says so.

    Where none is stated it is the instrument's, for one axis under a zero that is not known; else it stands still.
    moves, unknowns : of the set-up; by_default : whether zeros wander of which nothing is stated
    """
    if table.drift is not None:
        rate = stated_drift(table.drift, usual)
        return rate, "stated" if rate > 0 else "denied"
    wanders = by_default and len(moves) == 1 and any(unknown.name.startswith("zero") for unknown in unknowns)
    rate = usual.wanders[table.warm] if wanders else 0.0
    return rate, "usual" if rate > 0 else "nothing"
