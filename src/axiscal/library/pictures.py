"""Pictures for notebooks: plotly figures."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import plotly.graph_objects as plotly
from plotly.subplots import make_subplots

from axiscal.library.drawn_line import DrawnLine

_LINE, _FILL = "#1f5fa8", "rgba(31, 95, 168, 0.18)"
_COLUMNS = 3
"""A matter of taste."""


def curve_figure(line: DrawnLine) -> Any:
    """Return one curve with the band that holds it with 95 %."""
    figure = plotly.Figure(_traces(line))
    figure.update_layout(title=line.name, showlegend=False, template="plotly_white")
    figure.update_xaxes(title=f"position, {line.position_unit}")
    return figure.update_yaxes(title=line.unit)


def curves_figure(lines: Sequence[DrawnLine]) -> Any:
    """Return all curves side by side, each over its own travel."""
    columns = min(_COLUMNS, max(len(lines), 1))
    rows = max(1, math.ceil(len(lines) / columns))
    titles = [f"{line.name}, {line.unit}" for line in lines]
    figure = make_subplots(rows=rows, cols=columns, subplot_titles=titles)
    for index, line in enumerate(lines):
        for trace in _traces(line):
            figure.add_trace(trace, row=index // columns + 1, col=index % columns + 1)
    return figure.update_layout(showlegend=False, template="plotly_white", height=240 * rows)


def plan_figure(document: dict[str, Any]) -> Any:
    """Return the accuracy of a plan after each reading against its minutes.  document : `axiscal-plan/1`"""
    points = document["points"]
    minutes = [0.0, *(point["minutes"] for point in points)]
    rms = [document["before_rms_um"], *(point["rms_um"] for point in points)]
    figure = plotly.Figure(plotly.Scatter(x=minutes, y=rms, mode="lines+markers", line={"color": _LINE, "shape": "hv"}))
    if document["bound_rms_um"] is not None:
        figure.add_hline(document["bound_rms_um"], line_dash="dot", annotation_text="no plan can beat")
    figure.update_layout(template="plotly_white")
    return figure.update_xaxes(title="minutes").update_yaxes(title="RMS, um", rangemode="tozero")


def _traces(line: DrawnLine) -> list[Any]:
    there_and_back = np.concatenate([line.at, line.at[::-1]])
    around = np.concatenate([line.middle + line.half, (line.middle - line.half)[::-1]])
    band = plotly.Scatter(x=there_and_back, y=around, fill="toself", fillcolor=_FILL, line={"width": 0})
    return [band, plotly.Scatter(x=line.at, y=line.middle, line={"color": _LINE})]
