"""The report: one HTML file that carries everything it needs and asks the network for nothing."""

from __future__ import annotations

from typing import Any

from markupsafe import Markup

from axiscal.language.spoken import capital, later, resaid, said
from axiscal.present import figures, gallery, sentences
from axiscal.present.data_files import listed
from axiscal.present.drawing.shown import shown
from axiscal.present.drawn_by_standards import circle_picture
from axiscal.present.found_and_left import found_and_left_shown
from axiscal.present.sentences import UNSAID, files_of_controls, pairs, words
from axiscal.present.standalone import environment, inlined
from axiscal.present.statement import answered, statement
from axiscal.present.summary import Summary

FILTERS = {
    "figure": sentences.figure,
    "quantity": sentences.quantity,
    "unit": sentences.unit_text,
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
    "beginning": capital,
}
_CODES = {
    "accepted": later("accepted mistake"),
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
_CIRCLE = 340.0
"""Pixels of the picture of a ball bar: a third of a page on a screen, and the whole of a telephone's."""


def render(summary: Summary) -> str:
    """Return the report as one self-contained HTML page in the language that is spoken.

    Raises SummaryError for figures that are not finite.
    """
    summary = resaid(summary)
    drawn = {
        "draw": shown,
        "draw_circle": lambda circle: Markup(circle_picture(circle, _CIRCLE)),
        "picture": "" if summary.bent is None else found_and_left_shown(summary.bent),
        "code": Markup("<code>{}</code>").format,
    }
    templates = environment("axiscal.present")
    templates.filters |= FILTERS
    page = templates.get_template("report.html").render(report_values(summary) | drawn | inlined())
    return page.encode("utf-8", "replace").decode("utf-8")  # a file name may hold bytes that are no text


def report_values(summary: Summary) -> dict[str, Any]:
    """Return what both reports, the page and the PDF, are filled with, in the language that is spoken."""
    return {
        "s": summary,
        "groups": gallery.groups(summary.curves, summary.chain),
        "reversal_groups": gallery.groups(summary.reversals, summary.chain),
        "planes": gallery.plane_panels(summary),
        "constants": sentences.constant_rows(summary),
        "positioning": [(each, figures.positioning_figure(each)) for each in summary.positioning],
        **answered(summary)._asdict(),
        "stated": statement(summary),
        "files_of": files_of_controls(summary.tables),
        "codes": {code: said(words) for code, words in _CODES.items()},
        "unsaid": said(UNSAID),
        "volume_words": sentences.volume_words(summary),
        "first_number": sentences.first_number_words(summary),
        "pairs": pairs(summary),
        "words": words(),
        "before": [row for row in summary.history if not row.position],
        "listed": listed(summary),
        "flagged": {warning.error: warning.code for warning in summary.warnings if warning.error},
    }
