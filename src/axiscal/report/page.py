"""The report: one HTML file that carries everything it needs and asks the network for nothing."""

from __future__ import annotations

import math

from jinja2 import Environment

from axiscal.report import arrow_pictures, figures, gallery, headline, plane_maps, sentences, side_by_side, whiskers
from axiscal.report.drawing.shown import shown
from axiscal.report.glossary import WORDS
from axiscal.report.identity import pairs
from axiscal.report.standalone import environment, inlined
from axiscal.report.summary import Summary

_FILTERS = {
    "figure": sentences.figure,
    "short": sentences.short,
    "quantity": sentences.quantity,
    "unit": sentences.unit_text,
    "duration": sentences.duration,
    "count": sentences.count,
    "iso_name": sentences.iso_name,
    "position": sentences.position_text,
    "standardised": sentences.standardised,
    "spelt": sentences.spelt,
    "curve_note": sentences.curve_note,
}
CODES = {
    "lack-of-fit": "more detail than the model follows",
    "aliasing": "targets too regular",
    "prior-misfit": "not as stated beforehand",
    "drift": "drift",
    "outlier": "reading that does not fit",
    "unobservable": "cannot be seen",
}
"""What the kinds of warnings are called on a page."""
_GLYPHS = "●■◆▲✚✖▼⬟★⬢"


def render(summary: Summary) -> str:
    """Return the report as one self-contained HTML page; raises SummaryError for figures that are not finite."""
    known = math.inf if summary.withheld else 1.0
    values = {
        "s": summary,
        "draw": shown,
        "groups": gallery.groups(summary.curves, summary.chain),
        "reversal_groups": gallery.groups(summary.reversals, summary.chain),
        "planes": plane_maps.panels(summary),
        "scales": whiskers.scales([each for each in summary.constants if ": " not in each.name]),
        "setup_scales": whiskers.scales([each for each in summary.constants if ": " in each.name]),
        "volume": [] if summary.volume is None else arrow_pictures.volume_panels(summary.volume),
        "magnified": 1.0 if summary.volume is None else arrow_pictures.magnification(summary.volume),
        "sides": side_by_side.sides(summary),
        "controls": list(side_by_side.effects(summary)),
        "axis_rows": side_by_side.axis_rows(summary),
        "files_of": side_by_side.files_of_controls(summary.tables),
        "codes": CODES,
        "pairs": pairs(summary),
        "words": WORDS,
        "accuracy": figures.accuracy(summary) if summary.history else None,
        "innovations": figures.innovations(summary),
        "places": figures.places(summary),
        "iso_figures": [figures.iso230(block) for block in summary.iso230],
        "unseen": sentences.unseen_size(summary),
        "occasion": sentences.occasion(summary),
        "holds_for": headline.expanded_words(summary),
        "errors": headline.errors_named(summary),
        "table_lines": [sentences.spelt(line) for line in headline.table_lines(summary)],
        "u_target": sentences.target_text(known * summary.expanded.space, summary.target_u_um, summary.unshown_u),
        "rms_target": sentences.target_text(known * summary.rms_um, summary.target_rms_um, summary.unshown),
        "worst_target": sentences.target_text(known * summary.worst_um, summary.target_worst_um, summary.unshown),
        "glyphs": _GLYPHS,
        "flagged": {warning.error: warning.code for warning in summary.warnings if warning.error},
        **inlined(),
    }
    page = _environment().get_template("report.html").render(values)
    return page.encode("utf-8", "replace").decode("utf-8")  # a file name may hold bytes that are no text


def _environment() -> Environment:
    templates = environment("axiscal.report")
    templates.filters.update(_FILTERS)
    return templates
