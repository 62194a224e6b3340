"""The report: one HTML file that carries everything it needs and asks the network for nothing."""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Iterable
from functools import cache
from importlib import resources
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from axiscal.report import figures, gallery, whiskers, wording
from axiscal.report.summary import Summary

_FILTERS = {
    "figure": wording.figure,
    "short": wording.short,
    "quantity": wording.quantity,
    "unit": wording.unit_text,
    "duration": wording.duration,
    "count": wording.count,
    "iso_name": wording.iso_name,
    "position": wording.position_text,
    "standardised": wording.standardised,
    "curve_note": wording.curve_note,
}
_GLYPHS = "●■◆▲✚✖▼⬟★⬢"


def render(summary: Summary) -> str:
    """Return the report as one self-contained HTML page; raises SummaryError for figures that are not finite."""
    drawn = Drawings()
    scripts = [_plotly(), _static("report.js")]
    values = {
        "s": summary,
        "draw": drawn.add,
        "groups": gallery.groups(summary.curves),
        "reversal_groups": gallery.groups(summary.reversals),
        "scales": whiskers.scales(summary.constants),
        "accuracy": figures.accuracy(summary) if summary.history else None,
        "innovations": figures.innovations(summary),
        "places": figures.places(summary),
        "space": figures.space(summary),
        "iso_figures": [figures.iso230(block) for block in summary.iso230],
        "occasion": wording.occasion(summary),
        "rms_target": wording.target_text(summary.rms_um, summary.target_rms_um),
        "worst_target": wording.target_text(summary.worst_um, summary.target_worst_um),
        "glyphs": _GLYPHS,
        "flagged": {warning.error: warning.code for warning in summary.warnings if warning.error},
        "css": Markup(_static("report.css")),
        "scripts": [Markup(script) for script in scripts],
        "policy": policy(scripts),
    }
    page = _environment().get_template("report.html").render(values, figures_json=drawn.json)
    return page.encode("utf-8", "replace").decode("utf-8")  # a file name may hold bytes that are no text


class Drawings:
    """The figures of a page in the order in which the template places them."""

    def __init__(self) -> None:
        self._figures: list[figures.Figure] = []

    def add(self, figure: figures.Figure) -> int:
        """Take a figure and return the number under which the page finds it."""
        self._figures.append(figure)
        return len(self._figures) - 1

    def json(self) -> Markup:
        """Return all figures taken so far as JSON that is safe inside a script element."""
        return script_json(self._figures)


def script_json(value: Any) -> Markup:
    """Return JSON without any character that could end a script element or a line of script."""
    text = json.dumps(value, ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    return Markup(text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026"))


def policy(scripts: Iterable[str]) -> str:
    """Return a content security policy under which these scripts run, and nothing else runs or is fetched."""
    hashes = " ".join(f"'sha256-{_hash(script)}'" for script in scripts)
    return (
        f"default-src 'none'; script-src {hashes}; style-src 'unsafe-inline'; img-src data: blob:; "
        "base-uri 'none'; form-action 'none'"
    )


@cache
def _hash(script: str) -> str:
    return base64.b64encode(hashlib.sha256(script.encode()).digest()).decode("ascii")


@cache
def _plotly() -> str:
    source = resources.files("plotly").joinpath("package_data", "plotly.min.js").read_text(encoding="utf-8")
    return source.replace("\r\n", "\n")  # as the HTML parser will, or the hash would not fit


def _static(name: str) -> str:
    return resources.files("axiscal.report").joinpath("static", name).read_text(encoding="utf-8")


def _environment() -> Environment:
    environment = Environment(
        loader=PackageLoader("axiscal.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters.update(_FILTERS)
    return environment
