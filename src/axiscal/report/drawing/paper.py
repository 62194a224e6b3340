"""A figure as a file of its own on paper: SVG with the colours and the letters of paper, at a width that paper has."""

from __future__ import annotations

from axiscal.report.drawing.colours import on_paper
from axiscal.report.drawing.shown import at_width, seen_first
from axiscal.report.drawing.svg_picture import Figure, picture

FONT = "Libertinus Serif"
"""One of the letters that the typesetter brings along."""


_LOWER = 0.75
"""Share of the height on a screen that a picture has on paper; a matter of taste."""


def paper_svg(figure: Figure, width: int) -> str:
    """Return a figure as the text of an SVG file; of scales and views to choose from the first."""
    first = {key: value for key, value in seen_first(figure).items() if key != "ranges"}
    first["layout"] = {**first["layout"], "height": _LOWER * first["layout"]["height"]}
    return alone(picture(at_width(first, width), width))


def alone(svg: str) -> str:
    """Return an SVG element of a page as the text of a file."""
    return on_paper(svg).replace("<svg ", f'<svg xmlns="http://www.w3.org/2000/svg" font-family="{FONT}" ', 1)
