"""Errors of two axes as maps: what the tool does over the plane, how well that is known, and what no curve explains."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from axiscal.accuracy.expanded import BAND
from axiscal.language.spoken import joined, said
from axiscal.report.digits import number, numbers
from axiscal.report.drawing.svg_picture import Figure
from axiscal.report.figures import axis_style, layout
from axiscal.report.plane_summary import PlaneSummary
from axiscal.report.sentences import unit_text
from axiscal.report.summary import HistoryRow, Summary

_HEIGHT = 290
"""Pixels; a matter of taste."""
_EITHER_WAY = [[0, "#0b5c8a"], [0.5, "#f4f1e8"], [1, "#c2491d"]]
"""From low to high about nought; a matter of taste."""
_WIDER = [[0, "#f4f1e8"], [1, "#5a3d7a"]]
"""From known to unknown; a matter of taste."""

Grid = Sequence[Sequence[float]]


@dataclass(frozen=True, slots=True)
class PlanePanel:
    """A plane with its maps, each with the words under it."""

    plane: PlaneSummary
    maps: Sequence[tuple[Figure, str]]


def panels(summary: Summary) -> list[PlanePanel]:
    """Return the maps of every plane, the places that were read on the first of them."""
    return [PlanePanel(plane, _maps(plane, summary.history)) for plane in summary.planes]


def _maps(plane: PlaneSummary, rows: Sequence[HistoryRow]) -> list[tuple[Figure, str]]:
    unit = unit_text(plane.value_unit)
    bands = [[BAND * value for value in row] for row in plane.whole_std]
    alone = [[plane.sign * value for value in row] for row in plane.mean]
    names = joined(plane.axes)
    whole = _map(plane, plane.whole_mean, _EITHER_WAY, both=True)
    whole["data"].append(_places(plane, rows))
    return [
        (whole, said("The tool over {axes}, their curves included, {unit}; dots: readings", axes=names, unit=unit)),
        (_map(plane, bands, _WIDER, both=False), said("95 % of it: ± so many {unit}", unit=unit)),
        (_map(plane, alone, _EITHER_WAY, both=True), said("Of it, what no sum of two curves holds, {unit}", unit=unit)),
    ]


def _map(plane: PlaneSummary, values: Grid, colours: Sequence[Sequence[object]], both: bool) -> Figure:
    """Return a map with the first axis to the right.  both : whether values lie on both sides of nought"""
    first, second = (numbers(at, f"position of {plane.name}") for at in plane.position)
    heights = [numbers(row, f"map of {plane.name}", len(first)) for row in zip(*values, strict=True)]
    largest = number(max(abs(value) for row in heights for value in row) or 1.0, plane.name)
    trace = {
        "type": "heatmap",
        "x": first,
        "y": second,
        "z": heights,
        "colorscale": colours,
        "zmin": -largest if both else 0.0,
        "zmax": largest,
        "colorbar": True,
    }
    x, y = (axis_style(f"{axis}, {unit_text(unit)}", nticks=6, showgrid=False, range=[at[0], at[-1]])
            for axis, unit, at in zip(plane.axes, plane.position_unit, (first, second), strict=True))  # fmt: skip
    return {"data": [trace], "layout": layout(x, y, _HEIGHT, margin={"l": 46, "r": 8, "t": 8, "b": 42})}


def _places(plane: PlaneSummary, rows: Sequence[HistoryRow]) -> Figure:
    """Return the readings in whose set-up both axes have a position."""
    first, second = plane.axes
    read = [row.position for row in rows if row.position and {first, second} <= set(row.position)]
    at = {name: numbers([position[axis] for position in read], axis)
          for name, axis in (("x", first), ("y", second))}  # fmt: skip
    marker = {"size": 4, "color": "#1c1b18", "line": {"color": "#f4f1e8", "width": 0.8}}
    return {"type": "scatter", "mode": "markers", **at, "marker": marker, "cliponaxis": False}
