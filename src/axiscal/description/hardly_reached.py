"""What is said before anybody mounts it: balls that can be read in few poses only, artefacts that no set-up reads."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from axiscal.description.campaign import CampaignDescription
from axiscal.document import Document, shown
from axiscal.language.spoken import joined, listed, said
from axiscal.machine import Machine
from axiscal.measurement.charts.held import Balls, Held
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.numerics.spread import even_points

_FEW = 0.05
"""Share of the turns below which a ball tells little of a rotary axis."""
_TRIED = 4000
"""Places tried: a share of a twentieth is then known to a tenth of itself."""
_FINE, _APART = math.radians(5.0), math.radians(30.0)
"""To which an interval is rounded, and how far two are apart: nobody needs them closer, and few places are tried."""


def hardly_reached(description: CampaignDescription) -> str | None:
    """Return a sentence about balls that are reached in less than a twentieth of the turns; None without any."""
    found = [text for setup in description.setups for text in _of_setup(description.machine, setup)]
    return said("{balls}: stand them elsewhere, or widen cone.", balls=listed("; ", found)) if found else None


def _of_setup(machine: Machine, setup: Setup) -> Iterator[str]:
    chart, artefact = setup.chart, setup.artefact
    each = chart.each if isinstance(chart, Balls) else (chart,) if isinstance(chart, Held) else ()
    for part, ball in zip(each, setup.balls, strict=False):
        low, high = np.array([part.bounds(k)[:2] for k in range(part.size)]).reshape(-1, 2).T
        places = low + (high - low) * even_points(_TRIED, part.size).reshape(_TRIED, part.size)
        taken = places[part.feasible(part.poses(places))]
        share = len(taken) / _TRIED
        if 0 < share < _FEW and artefact is not None:
            axes = [machine.axes[k].name for k in part.turning]
            reached = ", ".join(f"{name} {_intervals(at)}" for name, at in zip(axes, taken.T, strict=True))
            where = {"setup": setup.name, "ball": artefact.balls[ball].name, "artefact": artefact.name}
            text = '"{setup}" reaches ball {ball} of {artefact} in {share:.1%} of the turns ({reached})'
            yield said(text, share=share, reached=reached, **where)


def _intervals(values: Array) -> str:
    """Say between which angles values lie, rad."""
    ordered = np.sort(values)
    pieces = np.split(ordered, np.flatnonzero(np.diff(ordered) > _APART) + 1)
    ends = [(np.floor(piece[0] / _FINE) * _FINE, np.ceil(piece[-1] / _FINE) * _FINE) for piece in pieces]
    return " and ".join(f"{math.degrees(first):.0f} to {math.degrees(last):.0f} deg" for first, last in ends)


def unused_artefacts(description: CampaignDescription) -> str | None:
    """Return a sentence about artefacts that no set-up names; None where all are read."""
    data = Document.parse(description.text, description.source).data
    read = {table.get("artefact") for table in data.get("setups", [])}
    left = [shown(table["name"]) for table in data.get("artefacts", []) if table["name"] not in read]
    if not left:
        return None
    text = "nothing reads {names}: write artefact = {first} in a set-up, or take its table out."
    return said(text, names=joined(left), first=left[0])
