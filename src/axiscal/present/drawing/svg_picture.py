"""Drawings as SVG files: for paper, and for screens, light and dark."""

from __future__ import annotations

from typing import NamedTuple

from axiscal.present.drawing.strokes import on_paper, page_colours, text_safe, variables

_GROUND = '<rect width="100%" height="100%" fill="var(--paper)"/>'
_FONT = "system-ui,-apple-system,'Segoe UI',Roboto,'Noto Sans','Liberation Sans','DejaVu Sans',sans-serif"

FONT = "Libertinus Serif"
"""One of the letters that the typesetter brings along."""


class Drawing(NamedTuple):
    """What a file shows.  width, height : pixels; body : SVG elements"""

    width: float
    height: float
    body: str

    def on_paper(self) -> str:
        """Return the text of an SVG file for paper."""
        size = f'viewBox="0 0 {self.width:g} {self.height:g}" width="{self.width:g}" height="{self.height:g}"'
        return f'<svg xmlns="http://www.w3.org/2000/svg" font-family="{FONT}" {size}>{on_paper(self.body)}</svg>'


def picture_file(drawing: Drawing, label: str) -> str:
    """Return the text of an SVG file, in the colours of a light or a dark screen.  label : for people who hear it"""
    size = f'viewBox="0 0 {drawing.width:g} {drawing.height:g}" width="{drawing.width:g}" height="{drawing.height:g}"'
    light, dark = (variables(drawing.body + _GROUND, values) for values in page_colours())
    style = f":root{{{light}font-family:{_FONT};max-width:100%;height:auto}}"
    style += f"@media(prefers-color-scheme:dark){{:root{{{dark}}}}}"
    name = text_safe(label)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" {size} role="img" aria-label="{name}"><title>{name}</title>'
        f"<style>{style}</style>{_GROUND}{drawing.body}</svg>\n"
    )
