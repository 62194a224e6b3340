"""The report as a PDF that carries everything it needs: `paper/report.typ` lays out the result document."""

from __future__ import annotations

import json
from collections.abc import Mapping
from datetime import UTC, datetime
from importlib import resources
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Literal

from axiscal.exceptions import PrintingError
from axiscal.language.spoken import resaid, spoken_now
from axiscal.present.drawing.svg_picture import Drawing
from axiscal.present.found_and_left import found_and_left_drawing
from axiscal.present.result_document import result_json
from axiscal.present.summary import Summary

_PAPER = 840
"""Pixels that the picture of the volume is drawn in: its words are then as large as the notes of the report."""
_LEAST, _FLAT = 300, 0.72
"""Pixels that the picture of a set-up is wide at least, and how high for its width; a matter of taste."""


def pdf(summary: Summary) -> bytes:
    """Return the report in the language that is spoken, as PDF/A-2b where letters hold all of its signs.

    Raises SummaryError for a figure that is not finite.
    """
    summary = resaid(summary)
    wide = max(_LEAST, _PAPER / max(2, len(summary.schematics)))
    shown = (Drawing(wide, _FLAT * wide, each.svg(wide, _FLAT * wide)) for each in summary.schematics)
    pictures = {f"setup-{n}.svg": each.on_paper() for n, each in enumerate(shown)}
    if summary.bent is not None:
        pictures["volume.svg"] = found_and_left_drawing(summary.bent, _PAPER).on_paper()
    return printed(result_json(summary), pictures)


def printed(document: Mapping[str, Any], pictures: Mapping[str, str]) -> bytes:
    """Return a result document in the language that is spoken as a PDF; the same one has the same bytes.

    pictures : the text of SVG files, by name
    """
    own = resources.files("axiscal.present").joinpath("paper")
    texts = {file.name: file.read_text(encoding="utf-8") for file in own.iterdir()}
    texts |= {"result.json": json.dumps(document), **pictures}
    with TemporaryDirectory(prefix="axiscal-", ignore_cleanup_errors=True) as name:
        for file, text in texts.items():
            (Path(name) / file).write_bytes(text.encode("utf-8", "replace"))
        day = datetime.fromisoformat(document["identity"]["begun"]).replace(tzinfo=UTC)
        return _set(Path(name), {"language": spoken_now(), "pictures": " ".join(pictures)}, int(day.timestamp()))


def _set(folder: Path, inputs: dict[str, str], moment: int) -> bytes:
    """Return what typst makes of a folder.

    The system's fonts give the signs that its own fonts lack. A sign in no font becomes a box, and the PDF is then
    none for archives, which forbid boxes.
    """
    import typst

    reason = ""
    tries: tuple[tuple[bool, Literal["a-2b"] | None], ...] = ((False, "a-2b"), (True, "a-2b"), (True, None))
    for system, standard in tries:
        fonts = typst.Fonts(include_system_fonts=system)
        compiler = typst.Compiler(str(folder / "report.typ"), root=str(folder), font_paths=fonts, sys_inputs=inputs)
        try:
            made = compiler.compile(pdf_standards=standard, timestamp=moment)
            assert isinstance(made, bytes)  # one document, in one file
            return made
        except typst.TypstError as failure:
            reason = str(failure).splitlines()[0][:200]
    what = "report.pdf could not be set: {reason}"
    remedy = "result.json beside it says the same; please report this defect of axiscal"
    raise PrintingError(what, remedy, reason=reason)
