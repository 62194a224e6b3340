"""The report as a PDF that carries everything it needs: `paper/report.typ` lays out the result document."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from datetime import UTC, datetime
from importlib import resources
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from axiscal.campaign.campaign import Campaign
from axiscal.exceptions import InputError
from axiscal.language.spoken import resaid, spoken_now
from axiscal.present.drawing.scene import Drawing
from axiscal.present.found_and_left import found_and_left_drawing
from axiscal.present.result import Result
from axiscal.present.schematic import read_schematics

_PAPER = 840
"""Pixels that the picture of the volume is drawn in: its words are then as large as the notes of the report."""
_LEAST, _FLAT = 300, 0.72
"""Pixels that the picture of a set-up is wide at least, and how high for its width; a matter of taste."""


def pdf(result: Result, pictures: Mapping[str, str]) -> bytes:
    """Return the report in the language that is spoken, as PDF/A-2b where letters hold all of its signs.

    The same result has the same bytes.  pictures : the text of SVG files, by name
    Where a sign is in no font a box stands for it, which archives forbid.
    """
    import typst

    day = datetime.fromisoformat(str(result.identity["begun"])).replace(tzinfo=UTC)
    with _laid_out("report.typ", result, pictures) as (plain, whole):
        reason = ""
        for compiler, standard in ((plain, "a-2b"), (whole, "a-2b"), (whole, None)):
            try:
                made = compiler.compile(pdf_standards=standard, timestamp=int(day.timestamp()))
                assert isinstance(made, bytes)  # one document, in one file
                return made
            except typst.TypstError as failure:
                reason = str(failure).splitlines()[0][:200]
    what = "report.pdf could not be set: {reason}"
    remedy = "result.json beside it says the same; please report this defect of axiscal"
    raise InputError(what, remedy, reason=reason)


def drawn_pictures(campaign: Campaign, result: Result) -> dict[str, str]:
    """Return the pictures of each set-up that was read, and of the volume."""
    readings = campaign.state.readings
    if result.volume is None:
        return {}
    shown = read_schematics(campaign.description, [reading.place for reading in readings])
    wide = max(_LEAST, _PAPER / max(2, len(shown)))
    drawings = (Drawing(wide, _FLAT * wide, each.svg(wide, _FLAT * wide)) for each in shown)
    pictures = {f"setup-{n}.svg": each.on_paper() for n, each in enumerate(drawings)}
    volume = found_and_left_drawing(result.volume, campaign.description.machine, _PAPER)
    return pictures | {"volume.svg": volume.on_paper()}


def curve_pictures(result: Result) -> list[str]:
    """Return each curve of a result as the report draws it: the text of an SVG file."""
    if not result.errors:
        return []
    with _laid_out("curves.typ", result, {}) as compilers:
        made = compilers[-1].compile(format="svg")
    return [each.decode() for each in (made if isinstance(made, list) else [made]) if each is not None]


@contextmanager
def _laid_out(layout: str, result: Result, pictures: Mapping[str, str]) -> Iterator[list[Any]]:
    """Give typst with a result before it: without the fonts of the system, and with them for what its own lack."""
    import typst

    document = resaid(result).model_dump(mode="json", by_alias=True, include=result.model_fields_set)

    own = resources.files("axiscal.present").joinpath("paper")
    texts = {file.name: file.read_text(encoding="utf-8") for file in own.iterdir()}
    texts |= {"result.json": json.dumps(document), **pictures}
    inputs = {"language": spoken_now(), "pictures": " ".join(pictures)}
    with TemporaryDirectory(prefix="axiscal-", ignore_cleanup_errors=True) as name:
        for file, text in texts.items():
            (Path(name) / file).write_bytes(text.encode("utf-8", "replace"))
        yield [
            typst.Compiler(
                str(Path(name) / layout),
                root=name,
                font_paths=typst.Fonts(include_system_fonts=system),
                sys_inputs=inputs,
            )
            for system in (False, True)
        ]
