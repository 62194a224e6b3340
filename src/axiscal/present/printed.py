"""The report on paper: the same summary, set by typst into a PDF that asks for no network and no font of the system."""

from __future__ import annotations

import contextlib
import json
import re
from collections.abc import Sequence
from datetime import UTC, date, datetime
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Literal

from axiscal.exceptions import PrintingError
from axiscal.language.spoken import capital, resaid, said, spoken_now
from axiscal.present import figures, gallery
from axiscal.present.data_files import listed
from axiscal.present.drawing.shown import alone, paper_svg
from axiscal.present.drawing.svg_picture import Figure
from axiscal.present.drawn_by_standards import circle_picture
from axiscal.present.found_and_left import found_and_left
from axiscal.present.sentences import (
    UNSAID,
    approach_words,
    as_read,
    constant_rows,
    curve_note,
    figure,
    files_of_controls,
    iso_name,
    left_out_words,
    pairs,
    position_heading,
    position_text,
    quantity,
    setup_rows,
    spelt,
    standardised,
    values_text,
    volume_words,
    words,
)
from axiscal.present.standalone import static_text
from axiscal.present.statement import answered, statement
from axiscal.present.summary import CurveSummary, HistoryRow, Rejection, Summary

_PAPER = 840
"""Pixels that the picture of the volume is drawn in: its words are then as large as the notes under it."""
_WIDE, _PANEL = 680, 230
"""Pixels that a picture as wide as the page, and a third of it, are drawn in; a matter of taste."""


_LEFT_OPEN = {name: f"{{{name}}}" for name in ("control", "number", "last")}
"""Names that the template fills in itself."""


def pdf(summary: Summary) -> bytes:
    """Return the report in the language that is spoken, as PDF/A-2b where letters hold all of its signs.

    Raises SummaryError for an infinite figure.
    """
    summary = resaid(summary)
    with TemporaryDirectory(prefix="axiscal-", ignore_cleanup_errors=True) as name:
        folder = Path(name)
        document = _Document(summary, folder).content()
        text = json.dumps(document, ensure_ascii=False, allow_nan=False).encode("utf-8", "replace")
        (folder / "data.json").write_bytes(text)
        (folder / "report.typ").write_text(static_text("report.typ", "templates"), encoding="utf-8")
        return _set(folder / "report.typ", _moment(_day(summary)))


def _set(template: Path, moment: int) -> bytes:
    """Return what typst makes of a template beside its data.

    The system's fonts give the signs that its own fonts lack. A sign in no font becomes a box, and the PDF is then
    none for archives, which forbid boxes.
    """
    import typst

    for system in (False, True):
        with contextlib.suppress(typst.TypstError):
            return _compiled(template, moment, system, "a-2b")
    try:
        return _compiled(template, moment, True, None)
    except typst.TypstError as failure:
        what = "report.pdf could not be set: {reason}"
        remedy = "report.html beside it says the same; please report this defect of axiscal"
        raise PrintingError(what, remedy, reason=str(failure).splitlines()[0][:200]) from None


def _compiled(template: Path, moment: int, system: bool, standard: Literal["a-2b"] | None) -> bytes:
    import typst

    fonts = typst.Fonts(include_system_fonts=system)
    compiler = typst.Compiler(str(template), root=str(template.parent), font_paths=fonts)
    made = compiler.compile(pdf_standards=standard or [], timestamp=moment)
    assert isinstance(made, bytes)  # one document, in one file
    return made


def _day(summary: Summary) -> date:
    """Return when the campaign was begun: the same campaign gives the same bytes."""
    try:
        return date.fromisoformat(summary.date[:10])
    except ValueError:
        return date(1970, 1, 1)


def _moment(day: date) -> int:
    return int(datetime(day.year, day.month, day.day, tzinfo=UTC).timestamp())


class _Document:
    """What the template is filled with; pictures are written into a folder as they are met."""

    def __init__(self, summary: Summary, folder: Path) -> None:
        self._summary, self._folder, self._count = summary, folder, 0

    def content(self) -> dict[str, Any]:
        """Return the whole."""
        return {**self._first(), **self._figures(), **self._pictures(), **self._last()}

    def _first(self) -> dict[str, Any]:
        s, page = self._summary, answered(self._summary)
        number = f" {s.particulars.number}" if s.particulars.number else ""
        return {
            "language": spoken_now(),
            "messages": {message: said(message, **_LEFT_OPEN) for message in _in_template()},
            "title": s.title,
            "day": [_day(s).year, _day(s).month, _day(s).day],
            "machine": s.machine,
            "operator": s.particulars.operator or said(UNSAID),
            "heading": said("Calibration report{number}, {date}", number=number, date=s.date),
            "record": ""
            if s.record is None
            else said("{file}, event {number}", file=s.record.file, number=s.record.event),
            "mark": spelt(s.agreement.mark),
            "verdict": s.answer.verdict,
            "first": [spelt(part) for part in page.first.parts],
            "rows": [[spelt(cell) for cell in row] for row in page.rows],
            "sentences": [spelt(each) for each in page.sentences],
            "commands": page.commands,
            "picture": None if s.bent is None else self._file(alone(found_and_left(s.bent, _PAPER))),
            "volume_words": volume_words(s),
            "pairs": pairs(s),
            "setups": setup_rows(s),
        }

    def _figures(self) -> dict[str, Any]:
        s = self._summary
        readings = listed(s)
        return {
            "stated": statement(s)._asdict(),
            "constants": constant_rows(s),
            "readings": [_reading_row(row) for row in readings.rows],
            "other_readings": readings.words,
            "position_heading": position_heading(readings.rows),
        }

    def _pictures(self) -> dict[str, Any]:
        s = self._summary
        return {
            "positioning": [self._named(each.axis, self._drawn(figures.positioning_figure(each), _PANEL))
                            for each in s.positioning],
            "circles": [self._named(each.setup, self._file(alone(circle_picture(each, _PANEL)))) for each in s.circles],
            "true": s.truth is not None,
            "groups": [*self._groups(s.curves), *self._groups(s.reversals)],
            "planes": [
                {"name": each.plane.name, "words": each.plane.caption, "maps": [
                    {"name": "", "words": words, "note": "", "file": self._drawn(drawn, _PANEL)}
                    for drawn, words in each.maps
                ]}
                for each in gallery.plane_panels(s)
            ],
            "iso": [
                {"heading": said("ISO 230-2, axis {axis}", axis=block.axis),
                 "note": left_out_words(block), "figures": [
                    [iso_name(name), quantity(value, block.value_unit), _uncertain(block.uncertainties.get(name))]
                    for name, value in block.figures.items()
                ]}
                for block in s.iso230
            ],
        }  # fmt: skip

    def _named(self, name: str, file: str) -> dict[str, str]:
        return {"name": name, "words": "", "note": "", "file": file}

    def _groups(self, curves: Sequence[CurveSummary]) -> list[dict[str, Any]]:
        return [
            {
                "heading": said("{axis} axis", axis=group.axis),
                "note": group.note,
                "rows": [[self._panel(panel) for panel in row] for row in group.rows],
            }
            for group in gallery.groups(curves, self._summary.chain)
        ]

    def _panel(self, panel: gallery.Panel) -> dict[str, str]:
        curve, drawn = panel.curve, self._drawn(panel.figure, _WIDE // 2 if panel.figure["wide"] else _PANEL)
        return {"name": curve.name, "words": curve.caption, "note": curve_note(curve), "file": drawn}

    def _last(self) -> dict[str, Any]:
        s = self._summary
        people = (said("Operator"), s.particulars.operator), (said("Responsible"), s.particulars.responsible)
        programs = ", ".join(f"{name} {version}" for name, version in sorted(s.versions.items()))
        return {
            "rejected": [_rejected(each) for each in s.rejected],
            "unseen": [spelt(each) for each in s.observability],
            "questions": list(s.questions),
            "warnings": [spelt(w.text) for w in s.warnings],
            "files": [
                {"controller": each.controller, "sentence": spelt(each.sentence), "files": list(each.files)}
                for each in files_of_controls(s.tables)
            ],
            "checksums": [[name, value] for name, value in s.checksums.items()],
            "versions": f"{said('Programs:')} {programs}",
            "words": words(),
            "signs": [f"{role}{f': {name}' if name else ''}, {said('date, signature')}" for role, name in people],
        }

    def _drawn(self, drawn: Figure, width: int) -> str:
        return self._file(paper_svg(drawn, width))

    def _file(self, svg: str) -> str:
        self._count += 1
        name = f"figure-{self._count}.svg"
        (self._folder / name).write_bytes(svg.encode("utf-8", "replace"))
        return name


@cache
def _in_template() -> tuple[str, ...]:
    """Return the messages of the template."""
    return tuple(re.findall(r'said\("([^"]*)"\)', static_text("report.typ", "templates")))


def _uncertain(value: float | None) -> str:
    return "" if value is None else figure(value)


def _rejected(each: Rejection) -> str:
    value = quantity(each.value_um, each.unit)
    reading = said("reading {number}", number=each.reading)
    return capital(f"{reading}, {each.setup}, {position_text(each.position)}, {value}: {each.reason}")


def _reading_row(row: HistoryRow) -> list[str]:
    z = standardised(row)
    return [
        f"{row.reading}{' ×' if row.rejected else ''}",
        row.setup or "",
        position_text(row.position),
        approach_words(row),
        values_text(row.values, row.unit),
        "" if row.innovation is None else as_read(row.innovation),
        "" if z is None else as_read(z),
        figure(row.rms_um),
    ]
