"""Pictures of joints that are not what the paper assumes: what both methods miss, and one curve by both."""

from __future__ import annotations

import numpy as np

from axiscal.numerics import Array
from axiscal.ports.paper.beyond import Compared
from axiscal.present.drawing.svg_picture import Figure
from axiscal.present.figures import axis_style, layout

_MICRO = 1e6
"""um in a metre."""
_MARGIN = {"l": 54, "r": 10, "t": 10, "b": 42}
"""Pixels; a matter of taste."""


def decrease(found: Compared) -> Figure:
    """Return what both methods miss against the number of readings, um, logarithmic."""
    count = list(found.scenario.readings)
    traces = [
        _line(count, np.median(missed, axis=0) * _MICRO, colour, "lines+markers")
        for missed, colour in ((found.linear, "var(--soft)"), (found.whole, "var(--accent)"))
    ]
    y = axis_style("missed, um", type="log")
    return {"data": traces, "layout": layout(axis_style("readings"), y, 300, margin=_MARGIN)}


def curve(found: Compared) -> Figure:
    """Return the height of one machine along one axis: the truth and both estimates, um."""
    sets = (
        (found.by_linear, "var(--soft)"),
        (found.real, "var(--truth)"),
        (found.by_whole, "var(--accent)"),
    )
    traces = [_line(found.along.tolist(), values * _MICRO, colour, "lines") for values, colour in sets]
    return {"data": traces, "layout": layout(axis_style(found.unit), axis_style("z, um"), 300, margin=_MARGIN)}


def _line(x: list[float] | list[int], y: Array, colour: str, mode: str) -> Figure:
    style = {"line": {"color": colour, "width": 2}, "marker": {"color": colour, "size": 6}}
    return {"type": "scatter", "mode": mode, "x": x, "y": y.tolist(), **style}
