"""A figure on a page: as one SVG, or as one for each width of screen, of which the page shows one."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

from markupsafe import Markup

from axiscal.present.drawing.colours import IN_DARK, IN_LIGHT, on_paper, variables
from axiscal.present.drawing.strokes import text_safe
from axiscal.present.drawing.svg_picture import Figure, picture

SCREENS = (1400.0, 768.0, 390.0)
"""Pixels of a computer, a tablet and a telephone."""
_LIGHT = {**IN_LIGHT, "--paper": "#ffffff", "--ink": "#1b2328", "--soft": "#55606a"}
_DARK = {**IN_DARK, "--paper": "#13181b", "--ink": "#e8eaea", "--soft": "#9eaab2"}
_FONT = "system-ui,-apple-system,'Segoe UI',Roboto,'Noto Sans','Liberation Sans','DejaVu Sans',sans-serif"

FONT = "Libertinus Serif"
"""One of the letters that the typesetter brings along."""


_LOWER = 0.75
"""Share of the height on a screen that a picture has on paper; a matter of taste."""

_PANEL = 360
"""Pixels: a third of a page on a screen, and the whole of a telephone's."""
WIDTHS = {"large": 1110, "medium": 700, "small": 360}
"""Pixels that a picture as wide as its page has on a screen, on a tablet and on paper, and on a telephone."""


def shown(figure: Figure, label: str) -> Markup:
    """Return a figure as markup.  label : what it shows, for people who hear the page"""
    if not figure.get("wide"):
        return Markup(picture(figure, _PANEL, label))
    return Markup("".join(
        f'<div class="at-{name}">{picture(figure, width, label)}</div>'
        for name, width in WIDTHS.items()
    ))  # fmt: skip


def paper_svg(figure: Figure, width: int) -> str:
    """Return a figure as the text of an SVG file."""
    lower = {**figure["layout"], "height": _LOWER * figure["layout"]["height"]}
    return alone(picture({**figure, "layout": lower}, width))


def alone(svg: str) -> str:
    """Return an SVG element of a page as the text of a file."""
    return on_paper(svg).replace("<svg ", f'<svg xmlns="http://www.w3.org/2000/svg" font-family="{FONT}" ', 1)


class Drawing(NamedTuple):
    """What a file shows at one width.  width, height : pixels; body : SVG elements"""

    width: float
    height: float
    body: str


def picture_file(drawings: Sequence[Drawing], label: str) -> str:
    """Return the text of an SVG file that shows the largest drawing for which there is room.

    drawings : from the widest to the narrowest; label : what they show, for people who hear it
    """
    widest = drawings[0]
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{widest.width:g}" height="{widest.height:g}" role="img" '
        f'aria-label="{text_safe(label)}"><title>{text_safe(label)}</title><style>{_style(drawings)}</style>'
        f'<rect width="100%" height="100%" fill="var(--paper)"/>{"".join(map(_shown, drawings))}</svg>\n'
    )


def _style(drawings: Sequence[Drawing]) -> str:
    """Return colours for both kinds of light, and which drawing is shown at which width."""
    rules = [f":root{{{variables(_LIGHT)}font-family:{_FONT}}}"]
    rules.append(f"@media(prefers-color-scheme:dark){{:root{{{variables(_DARK)}}}}}")
    rules += [f".w{each.width:g}{{display:none}}" for each in drawings[1:]]
    for wider, each in pairwise(drawings):
        size = f":root{{width:{each.width:g}px;height:{each.height:g}px}}"
        shown = f".w{wider.width:g}{{display:none}}.w{each.width:g}{{display:inline}}{size}"
        rules.append(f"@media(max-width:{wider.width - 1:g}px){{{shown}}}")
    return "".join(rules)


def _shown(each: Drawing) -> str:
    box = f'viewBox="0 0 {each.width:g} {each.height:g}"'
    return f'<svg class="w{each.width:g}" width="100%" height="100%" {box}>{each.body}</svg>'
