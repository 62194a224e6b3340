"""The report on paper, and the Digital Calibration Certificate: the same summary as PDF by typst, and as signed XML.

The PDF asks for no network and no font of the system.
"""

from __future__ import annotations

from datetime import UTC, date, datetime
from itertools import count
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Literal

from markupsafe import Markup

from axiscal.answers.answer import number
from axiscal.estimation.accuracy.expanded import BAND, LEVEL
from axiscal.exceptions import PrintingError
from axiscal.language.spoken import resaid
from axiscal.present.drawing.svg_picture import alone, paper_svg
from axiscal.present.drawn_by_standards import circle_picture
from axiscal.present.found_and_left import found_and_left
from axiscal.present.page import report_values
from axiscal.present.sentences import environment
from axiscal.present.statement import in_space
from axiscal.present.summary import Summary
from axiscal.record.signing import signed_xml

_PAPER = 840
"""Pixels that the picture of the volume is drawn in: its words are then as large as the notes under it."""
_WIDE, _PANEL = 340, 230
"""Pixels that the picture of a curve alone, and one of many, are drawn in; a matter of taste."""
_ESCAPED = str.maketrans({"\\": r"\\", '"': r"\"", "\n": r"\n", "\r": r"\r", "\t": r"\t"})


def pdf(summary: Summary) -> bytes:
    """Return the report in the language that is spoken, as PDF/A-2b where letters hold all of its signs.

    Raises SummaryError for an infinite figure.
    """
    with TemporaryDirectory(prefix="axiscal-", ignore_cleanup_errors=True) as name:
        file = Path(name) / "report.typ"
        file.write_bytes(filled(summary, Path(name)).encode("utf-8", "replace"))
        begun = datetime.fromisoformat(summary.date).replace(tzinfo=UTC)  # the same campaign gives the same bytes
        return _set(file, int(begun.timestamp()))


def filled(summary: Summary, folder: Path) -> str:
    """Return the report as typst sets it, in the language that is spoken; its pictures are written into a folder."""
    summary, numbers = resaid(summary), count(1)

    def kept(svg: str) -> str:
        file = f"figure-{next(numbers)}.svg"
        (folder / file).write_bytes(svg.encode("utf-8", "replace"))
        return file

    drawn = {
        "draw": lambda figure: kept(paper_svg(figure, _WIDE if figure.get("wide") else _PANEL)),
        "draw_circle": lambda circle: kept(alone(circle_picture(circle, _PANEL))),
        "picture": "" if summary.bent is None else kept(alone(found_and_left(summary.bent, _PAPER))),
        "day": date.fromisoformat(summary.date),
    }
    templates = environment("axiscal.present", _literal)
    return templates.get_template("report.typ").render(report_values(summary) | drawn)


def _literal(value: object) -> Markup:
    """Return a value as typst writes it in code: a text in quotes, an array, a number."""
    if isinstance(value, Markup):  # of a macro, whose values are literals already
        return value
    if isinstance(value, str):
        return Markup(f'"{value.translate(_ESCAPED)}"')
    if isinstance(value, list | tuple):
        return Markup(f"({''.join(f'{_literal(each)},' for each in value)})")
    return Markup(value)


def _set(template: Path, moment: int) -> bytes:
    """Return what typst makes of a template beside its data.

    The system's fonts give the signs that its own fonts lack. A sign in no font becomes a box, and the PDF is then
    none for archives, which forbid boxes.
    """
    import typst

    reason = ""
    tries: tuple[tuple[bool, Literal["a-2b"] | None], ...] = ((False, "a-2b"), (True, "a-2b"), (True, None))
    for system, standard in tries:
        fonts = typst.Fonts(include_system_fonts=system)
        compiler = typst.Compiler(str(template), root=str(template.parent), font_paths=fonts)
        try:
            made = compiler.compile(pdf_standards=standard, timestamp=moment)
            assert isinstance(made, bytes)  # one document, in one file
            return made
        except typst.TypstError as failure:
            reason = str(failure).splitlines()[0][:200]
    what = "report.pdf could not be set: {reason}"
    remedy = "report.html beside it says the same; please report this defect of axiscal"
    raise PrintingError(what, remedy, reason=reason)


VERSION = "3.3.0"
_UNITS = {
    "um": r"\micro\metre",
    "mm": r"\milli\metre",
    "urad": r"\micro\radian",
    "deg": r"\degree",
    "arcsec": r"\arcsecond",
}
_UNSAID = "not stated"
_UNKNOWN_COUNTRY = "ZZ"


def certificate(summary: Summary) -> bytes:
    """Return the certificate as XML; raises SummaryError for a figure that is not finite, RecordError for a bad key."""
    templates, told = environment("axiscal.present"), summary.particulars
    templates.filters |= {
        "plain": _plain,
        "si": lambda unit: _plain(_UNITS.get(str(unit), str(unit))),
        "figure": lambda value: f"{number(value, 'a figure of the certificate'):.6g}",
        "half": lambda std: BAND * std,
    }
    templates.globals |= {"unsaid": _UNSAID, "band": BAND, "level": LEVEL, "level_percent": f"{LEVEL:.0%}", "zip": zip}
    known = "" if summary.record is None else summary.record.hash
    text = templates.get_template("certificate.xml").render(
        s=summary,
        told=told,
        country=told.country.upper() or _UNKNOWN_COUNTRY,
        identifier=" ".join(part for part in (summary.particulars.number, known) if part) or summary.title,
        measured=[row for row in summary.answer.rows if row.measured],
        whole="space" if summary.expanded.along == "xyz" else in_space(summary.expanded),
        curves=[*summary.curves, *summary.reversals],
        constants=[each for each in summary.constants if ": " not in each.name],
    )
    document = "".join(f"{line}\n" for line in text.splitlines() if line).encode()
    return signed_xml(document, "Digital Calibration Certificate")


def _plain(text: str) -> str:
    """Return text as the schema takes it: words with one space between them, no sign that XML cannot hold."""
    kept = "".join(each if each.isprintable() else " " for each in text)
    return " ".join(kept.encode("utf-8", "replace").decode("utf-8").split()) or _UNSAID
