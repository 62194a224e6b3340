"""The report as a PDF that carries everything it needs: `paper/report.typ` lays out the result document."""

from __future__ import annotations

import json
from collections.abc import Mapping
from datetime import UTC, datetime
from importlib import resources
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Literal

from axiscal.campaign.campaign import Campaign
from axiscal.estimation.estimation import Estimation
from axiscal.exceptions import PrintingError
from axiscal.language.spoken import resaid, spoken_now
from axiscal.present.drawing.svg_picture import Drawing
from axiscal.present.found_and_left import found_and_left_drawing
from axiscal.present.result import Result
from axiscal.present.schematic import read_schematics
from axiscal.present.volume_error import bent_volume
from axiscal.tables.offer import Export

_PAPER = 840
"""Pixels that the picture of the volume is drawn in: its words are then as large as the notes of the report."""
_LEAST, _FLAT = 300, 0.72
"""Pixels that the picture of a set-up is wide at least, and how high for its width; a matter of taste."""


def pdf(result: Result, pictures: Mapping[str, str]) -> bytes:
    """Return the report in the language that is spoken, as PDF/A-2b where letters hold all of its signs.

    pictures : the text of SVG files, by name
    """
    return printed(resaid(result).model_dump(mode="json", by_alias=True), pictures)


def drawn_pictures(campaign: Campaign, known: Estimation, best: Export | None) -> dict[str, str]:
    """Return the pictures of each set-up that was read, and of the volume.  best : the tables, None without them"""
    readings = campaign.state.readings
    if not readings:
        return {}
    shown = read_schematics(campaign.description, [reading.place for reading in readings])
    wide = max(_LEAST, _PAPER / max(2, len(shown)))
    drawings = (Drawing(wide, _FLAT * wide, each.svg(wide, _FLAT * wide)) for each in shown)
    volume = bent_volume(known) if best is None else bent_volume(known, best.controller, best.control)
    pictures = {f"setup-{n}.svg": each.on_paper() for n, each in enumerate(drawings)}
    return pictures | {"volume.svg": found_and_left_drawing(volume, _PAPER).on_paper()}


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
