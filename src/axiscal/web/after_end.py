"""After the end: tables for a control, and whether they work once they are loaded."""

from __future__ import annotations

import io
import zipfile

from axiscal.campaign.agreement_words import agreement_words
from axiscal.evaluation.check import Check
from axiscal.exceptions import TableError
from axiscal.language.spoken import said
from axiscal.present.guide.checking import CheckJudged
from axiscal.tables import registry
from axiscal.web.desk import Desk
from axiscal.web.shapes import CheckedRequest


def tables_packed(desk: Desk, control: str) -> bytes:
    """Return the files for a control as one, as they were written, or made now with its sign.

    Raises InputError, TableError.
    """
    desk.look()
    if control in desk.state.tables and desk.campaign.description.bump_of(control) is None:
        files = {file.name: file.read_text() for file in sorted((desk.results / "tables" / control).iterdir())}
    else:
        known = desk.campaign.estimate(ended=True)
        if known.agreement.withheld:
            raise TableError(agreement_words(known), said("Take readings again"))
        offered = registry.offered(known, control)
        files = {**offered.files, "README.txt": offered.readme}
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in files.items():
            archive.writestr(f"{control}/{name}", text)
    return packed.getvalue()


def volume_picture(desk: Desk, width: float) -> str:
    """Return the text of an SVG file: the error of the volume, found, and left with the tables.  width : pixels"""
    from axiscal.present.found_and_left import found_and_left_drawing  # no question waits for them
    from axiscal.present.volume_error import volume_error

    known, tables = desk.campaign.estimate(ended=True), desk.state.tables
    control = next((each for each in tables if each != "csv"), "csv")
    volume = volume_error(known, control, registry.offered_control(known, control) if tables else None)
    drawing = found_and_left_drawing(volume, desk.campaign.description.machine, width)
    return drawing.on_screen(said("The error of the volume"))


def judge(desk: Desk, asked: CheckedRequest) -> CheckJudged:
    """Return what readings without the tables and with them say, or what is wrong with each by its field."""
    check = Check.from_campaign(desk.campaign, asked.control)
    return CheckJudged.of(check, asked.found, asked.left, asked.tolerance, desk.campaign.path.parent)
