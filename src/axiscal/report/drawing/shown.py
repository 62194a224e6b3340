"""A figure on a page: as one SVG, or as one for each width of screen and each view, of which the page shows one."""

from __future__ import annotations

from markupsafe import Markup

from axiscal.report.drawing.strokes import text_safe
from axiscal.report.drawing.svg_picture import Figure, picture

_PANEL = 360
"""Pixels: a third of a page on a screen, and the whole of a telephone's."""
_WIDTHS = {"large": 1110, "medium": 700, "small": 360}
"""Pixels that a picture as wide as its page has on a screen, on a tablet and on paper, and on a telephone."""


def shown(figure: Figure, label: str) -> Markup:
    """Return a figure as markup.  label : what it shows, for people who hear the page"""
    views = figure.get("views")
    if views is None:
        return Markup(_by_width(figure, label))
    return Markup("".join(
        f'<div data-view-of="{text_safe(name)}">{_by_width(_seen_as(figure, view), label)}</div>'
        for name, view in views.items()
    ))  # fmt: skip


def seen_first(figure: Figure) -> Figure:
    """Return a figure in the view that its page shows first."""
    views = figure.get("views")
    return figure if views is None else _seen_as(figure, next(iter(views.values())))


def _seen_as(figure: Figure, view: Figure) -> Figure:
    """Return a figure with the abscissa, and without the traces, that a view asks for."""
    layout = figure["layout"]
    x = {**layout["xaxis"], "title": {"text": view["title"]}, "range": [0, max(1, *view["x"])]}
    data = [{**trace, "x": view["x"]} for index, trace in enumerate(figure["data"]) if index not in view["hidden"]]
    return {**figure, "data": data, "layout": {**layout, "xaxis": x, "annotations": view["annotations"]}}


def _by_width(figure: Figure, label: str) -> str:
    if not figure.get("wide"):
        return picture(figure, figure["layout"].get("width", _PANEL), label)
    return "".join(
        f'<div class="at-{name}">{picture(at_width(figure, width), width, label)}</div>'
        for name, width in _WIDTHS.items()
    )


def at_width(figure: Figure, width: int) -> Figure:
    """Return a figure for a width: on a telephone there is no room for names beside lines, a legend has them."""
    layout = figure["layout"]
    if width > _WIDTHS["small"] or "annotations" not in layout:
        return figure
    kept = [label for label in layout["annotations"] if label["x"] != 1]
    return {**figure, "layout": {**layout, "annotations": kept, "margin": {**layout["margin"], "r": 12}}}
