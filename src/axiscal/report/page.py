"""The report: one HTML file that carries everything it needs and asks the network for nothing."""

from __future__ import annotations

from jinja2 import Environment
from markupsafe import Markup

from axiscal.language.spoken import capital, later, resaid, said
from axiscal.report import arrow_pictures, figures, gallery, headline, plane_maps, sentences, side_by_side, whiskers
from axiscal.report.drawing.shown import shown
from axiscal.report.glossary import words
from axiscal.report.identity import UNSAID, pairs
from axiscal.report.listed import listed
from axiscal.report.standalone import environment, inlined
from axiscal.report.summary import Summary

_FILTERS = {
    "figure": sentences.figure,
    "short": sentences.short,
    "quantity": sentences.quantity,
    "unit": sentences.unit_text,
    "duration": sentences.duration,
    "iso_name": sentences.iso_name,
    "approach_words": sentences.approach_words,
    "as_read": sentences.as_read,
    "left_out_words": sentences.left_out_words,
    "values_text": sentences.values_text,
    "position": sentences.position_text,
    "position_heading": sentences.position_heading,
    "standardised": sentences.standardised,
    "spelt": sentences.spelt,
    "curve_note": sentences.curve_note,
    "percent": sentences.percent,
    "beginning": capital,
}
_CODES = {
    "accepted": later("accepted mistake"),
    "aliasing": later("targets too regular"),
    "prior-misfit": later("not as stated beforehand"),
    "copies": later("readings that come twice"),
    "resolution": later("steps of the display"),
    "drift": later("drift"),
    "outlier": later("reading that does not fit"),
    "unobservable": later("cannot be seen"),
    "not-a-sister": later("not like its sisters"),
    "not-gaussian": later("not linear enough"),
}
"""What the kinds of warnings are called on a page."""
_GLYPHS = "●■◆▲✚✖▼⬟★⬢"


def render(summary: Summary) -> str:
    """Return the report as one self-contained HTML page in the language that is spoken.

    Raises SummaryError for figures that are not finite.
    """
    summary = resaid(summary)
    magnified = 1.0 if summary.volume is None else arrow_pictures.magnification(summary.volume)
    values = {
        "s": summary,
        "draw": shown,
        "groups": gallery.groups(summary.curves, summary.chain),
        "reversal_groups": gallery.groups(summary.reversals, summary.chain),
        "planes": plane_maps.panels(summary),
        "scales": whiskers.scales([each for each in summary.constants if ": " not in each.name]),
        "setup_scales": whiskers.scales([each for each in sentences.of_read_setups(summary) if ": " in each.name]),
        "volume": [] if summary.volume is None else arrow_pictures.volume_panels(summary.volume),
        "sides": side_by_side.sides(summary),
        "controls": list(side_by_side.effects(summary)),
        "axis_rows": side_by_side.axis_rows(summary),
        "files_of": side_by_side.files_of_controls(summary.tables),
        "codes": {code: said(words) for code, words in _CODES.items()},
        "unsaid": said(UNSAID),
        "strong": Markup("<strong>{}</strong>").format,
        "code": Markup("<code>{}</code>").format,
        "link": Markup('<a href="{}">{}</a>').format,
        "volume_words": sentences.volume_words(summary, magnified),
        "first_number": sentences.first_number_words(summary),
        "pairs": pairs(summary),
        "words": words(),
        "accuracy": figures.accuracy(summary) if summary.history else None,
        "innovations": figures.innovations(summary),
        "places": figures.places(summary),
        "iso_figures": [figures.iso230(block) for block in summary.iso230],
        "before": [row for row in summary.history if not row.position],
        "listed": listed(summary),
        "unseen": sentences.unseen_size(summary),
        "occasion": sentences.occasion(summary),
        "where": headline.in_space(summary.expanded),
        "holds_for": headline.expanded_words(summary),
        "errors": headline.errors_named(summary),
        "table_lines": [sentences.spelt(line) for line in headline.table_lines(summary)],
        "target": headline.targets(summary).u,
        "standard": headline.standard_words(summary),
        "targets": headline.target_lines(summary),
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
