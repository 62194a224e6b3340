"""Drawings as SVG files: for paper, and for screens of several widths, light and dark."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

from axiscal.present.drawing.strokes import on_paper, page_colours, text_safe, variables

SCREENS = (1400.0, 768.0, 390.0)
"""Pixels of a computer, a tablet and a telephone."""
_GROUND = '<rect width="100%" height="100%" fill="var(--paper)"/>'
_FONT = "system-ui,-apple-system,'Segoe UI',Roboto,'Noto Sans','Liberation Sans','DejaVu Sans',sans-serif"

FONT = "Libertinus Serif"
"""One of the letters that the typesetter brings along."""


class Drawing(NamedTuple):
    """What a file shows at one width.  width, height : pixels; body : SVG elements"""

    width: float
    height: float
    body: str

    def on_paper(self) -> str:
        """Return the text of an SVG file for paper."""
        size = f'viewBox="0 0 {self.width:g} {self.height:g}" width="{self.width:g}" height="{self.height:g}"'
        return f'<svg xmlns="http://www.w3.org/2000/svg" font-family="{FONT}" {size}>{on_paper(self.body)}</svg>'


def picture_file(drawings: Sequence[Drawing], label: str) -> str:
    """Return the text of an SVG file that shows the largest drawing for which there is room.

    drawings : from the widest to the narrowest; label : what they show, for people who hear it
    """
    widest = drawings[0]
    shown = (
        f'<svg class="w{each.width:g}" width="100%" height="100%" viewBox="0 0 {each.width:g} {each.height:g}">'
        f"{each.body}</svg>"
        for each in drawings
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{widest.width:g}" height="{widest.height:g}" role="img" '
        f'aria-label="{text_safe(label)}"><title>{text_safe(label)}</title><style>{_style(drawings)}</style>'
        f"{_GROUND}{''.join(shown)}</svg>\n"
    )


def _style(drawings: Sequence[Drawing]) -> str:
    """Return colours for both kinds of light, and which drawing is shown at which width."""
    svg = "".join(each.body for each in drawings) + _GROUND
    light, dark = (variables(svg, values) for values in page_colours())
    rules = [f":root{{{light}font-family:{_FONT}}}", f"@media(prefers-color-scheme:dark){{:root{{{dark}}}}}"]
    rules += [f".w{each.width:g}{{display:none}}" for each in drawings[1:]]
    for wider, each in pairwise(drawings):
        size = f":root{{width:{each.width:g}px;height:{each.height:g}px}}"
        shown = f".w{wider.width:g}{{display:none}}.w{each.width:g}{{display:inline}}{size}"
        rules.append(f"@media(max-width:{wider.width - 1:g}px){{{shown}}}")
    return "".join(rules)
