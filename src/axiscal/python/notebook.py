"""What a notebook shows: tables with a caption, and pictures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

from axiscal.present.drawing.svg_picture import Figure, alone, picture


def html_table(heads: Sequence[str], rows: Sequence[Sequence[str]], caption: str) -> str:
    """Return a table with a caption."""
    head = "".join(f"<th>{escape(text)}</th>" for text in heads)
    body = "".join("<tr>" + "".join(f"<td>{escape(text)}</td>" for text in row) + "</tr>" for row in rows)
    return f"<table><caption>{escape(caption)}</caption><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


LINE, FILL = "#1f5fa8", "rgba(31, 95, 168, 0.18)"
_WIDE, _NARROW, HEIGHT = 640, 360, 260
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
