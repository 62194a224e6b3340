"""Pictures for notebooks: SVG, drawn as the pictures of a report are; and tables, whose every text is escaped."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import NamedTuple

from axiscal.numerics import Array
from axiscal.present.drawing.svg_picture import Figure, alone, picture
from axiscal.present.figures import axis_style, band, layout
from axiscal.present.plan_answer import PlanAnswer


def html_table(heads: Sequence[str], rows: Sequence[Sequence[str]], caption: str) -> str:
    """Return a table with a caption."""
    head = "".join(f"<th>{escape(text)}</th>" for text in heads)
    body = "".join("<tr>" + "".join(f"<td>{escape(text)}</td>" for text in row) + "</tr>" for row in rows)
    return f"<table><caption>{escape(caption)}</caption><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


_LINE, _FILL = "#1f5fa8", "rgba(31, 95, 168, 0.18)"
_WIDE, _NARROW, _HEIGHT = 640, 360, 260
"""Pixels; a matter of taste."""


@dataclass(frozen=True, slots=True)
class NotebookPicture:
    """A picture that a notebook shows.

    figures : side by side, each a dict of `data` and `layout` as plotly's schema names them
    """

    figures: tuple[Figure, ...]

    @property
    def svg(self) -> tuple[str, ...]:
        """Each figure as the text of an SVG file."""
        width = _WIDE if len(self.figures) == 1 else _NARROW
        return tuple(alone(picture(figure, width, figure["name"])) for figure in self.figures)

    def _repr_html_(self) -> str:
        return "".join(self.svg)


def curves_picture(lines: Sequence[DrawnLine]) -> NotebookPicture:
    """Return curves side by side, each over its own travel with the band that holds it with 95 %."""
    return NotebookPicture(tuple(_curve(line) for line in lines))


def plan_picture(plan: PlanAnswer) -> NotebookPicture:
    """Return the accuracy of a plan after each reading against its minutes."""
    bound = plan.bound_rms_um
    minutes = [0.0, *(point.minutes for point in plan.points)]
    rms = [plan.before_rms_um, *(point.rms_um for point in plan.points)]
    steps = {
        "type": "scatter",
        "mode": "lines+markers",
        "x": minutes,
        "y": rms,
        "line": {"color": _LINE, "shape": "hv"},
        "marker": {"color": _LINE, "size": 6},
    }
    floor = {"x": [minutes[0], minutes[-1]], "y": [bound, bound], "line": {"color": _LINE, "dash": "dot"}}
    data = [steps] if bound is None else [steps, {"type": "scatter", "mode": "lines", **floor}]
    drawn = layout(axis_style("minutes"), axis_style("RMS, µm", rangemode="tozero"), _HEIGHT)
    return NotebookPicture(({"name": "accuracy of a plan", "data": data, "layout": drawn},))


def _curve(line: DrawnLine) -> Figure:
    at, middle = line.at.tolist(), line.middle.tolist()
    mean = {"type": "scatter", "mode": "lines", "x": at, "y": middle, "line": {"color": _LINE}}
    x, y = axis_style(f"position, {line.position_unit}"), axis_style(f"{line.name}, {line.unit}")
    return {
        "name": line.name,
        "data": [band(at, middle, line.half.tolist(), _FILL), mean],
        "layout": layout(x, y, _HEIGHT),
    }


class DrawnLine(NamedTuple):
    """at : (m,) positions; middle : (m,) mean; half : (m,) half of the band that holds it with 95 %"""

    name: str
    at: Array
    middle: Array
    half: Array
    position_unit: str
    unit: str
