"""Ways to measure side by side: accuracy against minutes, as a picture and a table on one page."""

from __future__ import annotations

from collections.abc import Sequence

from axiscal.answers.digits import numbers
from axiscal.planning.what_if import PLANNED, TRADITIONAL, Alternative
from axiscal.present import figures, sentences
from axiscal.present.drawing.shown import shown
from axiscal.present.drawing.svg_picture import Figure
from axiscal.present.figures import axis_style, layout, line_trace, mark_trace
from axiscal.present.standalone import page_of
from axiscal.units import to_unit

_OURS = "var(--accent)"


def render(title: str, found: Sequence[Alternative], questions: Sequence[str] = ()) -> str:
    """Return the page as self-contained HTML.  questions : what the descriptions leave open"""
    rows = [
        {"colour": colour(i, each), "dashed": each.name == TRADITIONAL, **table_row(each)}
        for i, each in enumerate(found)
    ]
    drawn = shown(figure(found), "Accuracy against minutes for each way to measure")
    return page_of("axiscal.present", "what_if.html", title=title, questions=questions, rows=rows, picture=drawn)


def figure(found: Sequence[Alternative]) -> Figure:
    """Return RMS against minutes of machine time, a line for each way."""
    drawn = [draw(each, colour(i, each)) for draw in (_trace, _end) for i, each in enumerate(found)]
    y = axis_style("standard uncertainty, RMS, µm", type="log")
    x = axis_style("minutes of machine time", rangemode="tozero")
    return {
        "data": sorted(drawn, key=lambda trace: trace["line" if "line" in trace else "marker"]["color"] == _OURS),
        "layout": layout(x, y, 420, margin={"l": 56, "r": 16, "t": 10, "b": 46}),
        "wide": True,
    }


def colour(index: int, each: Alternative) -> str:
    """Return the colour of a way: ours stands out, the traditional one is grey."""
    fixed = {PLANNED: _OURS, TRADITIONAL: "var(--soft)"}
    return fixed.get(each.name, figures.colour(index))


def table_row(each: Alternative) -> dict[str, str | int]:
    """Return one way as the table shows it; an empty bound is not known."""
    return {
        "name": each.name,
        "readings": each.readings,
        "minutes": f"{to_unit(each.seconds[-1], 'min'):.1f}",
        "rms": sentences.figure(to_unit(each.rms[-1], "um")),
        "worst": sentences.figure(to_unit(each.worst[-1], "um")),
        "bound": "" if each.bound is None else sentences.figure(to_unit(each.bound, "um")),
        "mounted": " · ".join(each.setups),
    }


def _trace(each: Alternative, hue: str) -> Figure:
    minutes = numbers([to_unit(s, "min") for s in each.seconds], each.name)
    rms = numbers([to_unit(r, "um") for r in each.rms], each.name)
    return line_trace(minutes, rms, hue, 3 if each.name == PLANNED else 1.8, "dash" if each.name == TRADITIONAL else "")


def _end(each: Alternative, hue: str) -> Figure:
    """Return the dot where a way ends."""
    x, y = to_unit(each.seconds[-1], "min"), to_unit(each.rms[-1], "um")
    return mark_trace([x], [y], hue, 9 if each.name == PLANNED else 7)
