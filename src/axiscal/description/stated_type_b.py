"""What campaign.toml says of causes that no reading shows: temperatures, type_b, and what the target refers to."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from typing import NamedTuple

from axiscal.description.campaign_schema import CampaignTable, SetupTable
from axiscal.document import Document, nearest, shown
from axiscal.exceptions import DescriptionError
from axiscal.machine import Machine
from axiscal.measurement.artefact import Artefact
from axiscal.measurement.instrument import Instrument
from axiscal.measurement.setup import STEEL, Unknown, Vector
from axiscal.promise.type_b import WITH_LIGHT, type_b_names
from axiscal.units import EXAMPLES, Dimension, dimension_of, parse_quantity

_REFERENCE = 293.15
"""20 degC (ISO 1), K."""
_ALONG = 0.99
"""Cosine; growth along an axis is meant where the direction is within 8 deg of it, and no set-up is between."""
At = Callable[..., AbstractContextManager[None]]
"""Places failures at the keys of a set-up."""


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
        what = f'"{warm}" states a temperature, which brings its lengths to 20 degC, and the target is "as read"'
        fault = DescriptionError(what, "Take temperature out there, or refers_to here")
        raise document.fault(fault, "target", "refers_to")
    return said == "20 degC"


def _against_length(setup: SetupTable, artefacts: Mapping[str, Artefact]) -> bool:
    artefact = artefacts.get(setup.artefact or "")
    return setup.instrument in WITH_LIGHT or (artefact is not None and artefact.calibrated is not None)


def material_of(
    table: SetupTable, usual: Instrument, machine: Machine, direction: Vector, moves: Sequence[int], at: At
) -> Material:
    """Return what a set-up says of the material; raises DescriptionError or UnitError."""
    with at("expansion"):
        expansion = STEEL if table.expansion is None else parse_quantity(table.expansion, "expansion")
    said = {
        "temperature": _not_negative(table.temperature_std, "temperature_difference", at, "temperature_std"),
        "expansion": _not_negative(table.expansion_std, "expansion", at, "expansion_std"),
    }
    stated = tuple((name, size) for name, size in said.items() if size is not None)
    if table.temperature is None:
        return Material(None, expansion, (), stated)
    with at("temperature"):
        _refuse_growth(usual, machine, direction, moves)
        warmer = parse_quantity(table.temperature, "temperature") - _REFERENCE
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
                near = nearest(name, known)
                remedy = f'Perhaps "{near}" is meant' if near else f"Known are {', '.join(known)}"
                what = f"{shown(name)} is not known of an instrument such as this {usual.name}"
                raise DescriptionError(what, remedy)
        size = _not_negative(text, dimension_of(known[name].unit), at, "type_b", name)
        assert size is not None
        found.append((name, size))
    return tuple(found)


def _not_negative(text: str | None, dimension: Dimension, at: At, *keys: str) -> float | None:
    if text is None:
        return None
    with at(*keys):
        size = parse_quantity(text, dimension)
        if size < 0:
            raise DescriptionError(f"{shown(text)} is negative", f'Give a size such as "{EXAMPLES[dimension]}"')
    return size
