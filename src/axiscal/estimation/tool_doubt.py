"""What a tool that nobody measured hides: where it turns with the axes it acts as a rotary axis that lies elsewhere."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from axiscal.errors.gauge import Hidden, unseen_factor
from axiscal.estimation.accuracy.yardstick import Yardstick
from axiscal.measurement.instruments.kind import TOOL
from axiscal.measurement.observation import Observation
from axiscal.numerics import Array
from axiscal.units import format_quantity

_SAID = 0.1
"""Share of the variance that cannot be seen from which it is said."""


def tool_doubt(observation: Observation, yardstick: Yardstick, factor: Array, rows: Array) -> Iterator[Hidden]:
    """Yield what of the unseen an exactly known tool would show, where that is a good part of it.

    factor : (n, n) of the prior covariance; rows : (m, n) readings spread over all that is allowed, over their noise
    """
    columns = [yardstick.errors.size + n for n, unknown in enumerate(observation.unknowns) if unknown.name in TOOL]
    if not columns:
        return
    known = factor.copy()
    known[columns] = 0.0
    whole = yardstick.unseen_rms
    left = replace(yardstick, unseen=unseen_factor(known, rows)[: yardstick.errors.size]).unseen_rms
    hides = float(np.sqrt(max(whole**2 - left**2, 0.0)))
    if hides**2 > _SAID * whole**2:
        sizes = f"{format_quantity(hides, 'um', 2)} of the {format_quantity(whole, 'um', 2)} that cannot be seen"
        yield Hidden((), f"{_subject(observation)}; that makes {sizes}. {_remedy(observation)}.", hides)


def _subject(observation: Observation) -> str:
    stds = {name: format_quantity(max(found), "um", 3) for name, found in _stds(observation).items() if found}
    length, aside = stds.get("length"), stds.get("aside")
    said = [f"of another length (known to {length})"] * bool(length)
    said += [f"that sits aside (known to {aside})"] * bool(aside)
    return f"A tool {' or '.join(said)} looks like rotary axes that lie elsewhere"


def _stds(observation: Observation) -> dict[str, list[float]]:
    """Return how well it is known how long tools are, and how far aside they sit, m."""
    *across, along = TOOL
    tools = {"length": (along,), "aside": tuple(across)}
    return {key: [u.std for u in observation.unknowns if u.name in names] for key, names in tools.items()}


def _remedy(observation: Observation) -> str:
    owned = any(unknown.name in TOOL and unknown.owner == "tool" for unknown in observation.unknowns)
    if owned:
        where = 'tool_length = "5 um" and tool_eccentricity; write "0 um" if the zeros were set with this tool'
    else:
        where = 'tool_x, tool_y, tool_z under unknowns, such as tool_z = "5 um"'
    return f"Measure the tool and state how well it is known, {where}"
