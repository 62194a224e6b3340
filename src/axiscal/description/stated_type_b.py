"""Causes in campaign.toml that readings do not show: temperatures, type_b, and the reference of the target."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from axiscal.description.campaign_schema import CampaignTable, SetupTable
from axiscal.document import Document
from axiscal.document.validation import Stated
from axiscal.exceptions import DescriptionError
from axiscal.machine.kinematics import in_frame
from axiscal.measurement.artefact import Artefact
from axiscal.measurement.setup import STEEL, Setup, Unknown
from axiscal.measurement.type_b import TEMPERATURE

REFERENCE = 293.15
"""20 degC (ISO 1), K."""
_ALONG = 0.99
"""Cosine; growth along an axis is meant where the direction is within 8 deg of it, and no set-up is between."""


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
    return setup.instrument.against_length or (artefact is not None and artefact.calibrated is not None)


def with_material(stated: Stated[SetupTable], setup: Setup) -> Setup:
    """Return a set-up with what its table says of the measured material; raises DescriptionError.

    Its growth is an unknown where it is stated how well that is known.
    """
    table = stated.table
    expansion = STEEL if table.expansion is None else table.expansion
    said = {"temperature": table.temperature_std, "expansion": table.expansion_std}
    known = {name: size for name, size in said.items() if size is not None}
    setup = replace(setup, expansion=expansion, stated=(*known.items(), *table.type_b.items()))
    if table.temperature is None:
        return setup
    if not _grows(setup):
        what = "a temperature corrects a length along the linear axes that move, and this set-up reads none"
        raise stated.misstated("temperature", what, "Take temperature out, or name the axis in moves")
    warmer = table.temperature - REFERENCE
    std = math.hypot(expansion * known.get("temperature", 0.0), warmer * known.get("expansion", 0.0))
    growth = (Unknown("growth", std),) if std > 0 and "growth" in setup.unknown_reads else ()
    return replace(setup, warmer=warmer, unknowns=(*setup.unknowns, *growth))


def _grows(setup: Setup) -> bool:
    """Return whether an instrument reads how far a machine expands: it follows the tool, or reads along what moves."""
    if not setup.directed:
        return setup.light
    machine = setup.machine
    linear, park = [k for k in setup.moves if not machine.axes[k].rotary], np.array(setup.park)
    ways = [
        float(np.array(machine.axes[k].direction) @ in_frame(machine, k, park) @ np.array(setup.direction))
        for k in linear
    ]
    return "growth" in setup.unknown_reads and math.hypot(*ways) >= _ALONG


def takes_temperature(setup: Setup) -> bool:
    """Return whether a temperature changes what the readings of a set-up say of the machine."""
    return setup.at_20 and _grows(setup)


def lacks_temperature(setup: Setup) -> bool:
    """Return whether a set-up compares a machine at 20 °C with a length, and nobody says how warm the machine is."""
    stated = "temperature" in dict(setup.stated)
    return TEMPERATURE.met(setup) and not stated and takes_temperature(setup)


def with_drift(table: SetupTable, setup: Setup, by_default: bool) -> Setup:
    """Return a set-up with the rate of its zero, and who says so.

    Where none is stated it is the instrument's, for one axis under a zero that is not known; else it stands still.
    by_default : whether zeros wander of which nothing is stated
    """
    if table.drift is not None:
        return replace(setup, drift=table.drift, drift_said="stated" if table.drift > 0 else "denied")
    zeroed = any(unknown.name.startswith("zero") for unknown in setup.unknowns)
    rate = setup.usual.wanders[table.warm] if by_default and len(setup.moves) == 1 and zeroed else 0.0
    return replace(setup, drift=rate, drift_said="usual" if rate > 0 else "nothing")
