"""Arguments and options that several commands share."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from axiscal.exceptions import RecordError, TargetError
from axiscal.units import Dimension, parse_quantity

_COMPLETING = "_AXISCAL_COMPLETE"
"""Set by a shell that asks for completions."""


def only_record() -> Path | None:
    """Return the record of AXISCAL_RECORD, or the only one here; None where there is none, or several."""
    if named := os.environ.get("AXISCAL_RECORD"):
        return Path(named)
    here = list(Path.cwd().glob("*.axiscal"))
    return here[0].relative_to(Path.cwd()) if len(here) == 1 else None


def own_record() -> Path:
    """Return the record that is meant where none is named; raises RecordError where that is not clear."""
    if (only := only_record()) is not None:
        return only
    if _COMPLETING in os.environ:  # a shell asks what could be typed: there is nothing to refuse
        return Path()
    here = sorted(Path.cwd().glob("*.axiscal"))
    names = ", ".join(path.name for path in here)
    what = "There are {count} records here: {names}" if here else "There is no campaign record here"
    remedy = "Name the one that is meant, or put its path into AXISCAL_RECORD"
    raise RecordError(what, remedy, Path.cwd(), count=len(here), names=names)


def records_here(incomplete: str) -> list[str]:
    """Return the records in this folder whose names begin so, for a shell that completes what is typed."""
    return sorted(path.name for path in Path.cwd().glob("*.axiscal") if path.name.startswith(incomplete))


def above_zero(text: str, dimension: Dimension) -> float:
    """Return an accuracy, m, or a time, s, that is to be kept; raises UnitError, TargetError."""
    wanted = parse_quantity(text, dimension)
    if wanted <= 0:
        raise TargetError('"{text}" is not above zero', "Give an accuracy or a time above zero", text=text)
    return wanted


def length_unit(text: str | None) -> str:
    """Return the unit of lengths that a person named, "" for none; raises UnitError for another."""
    if text is not None:
        parse_quantity(f"1 {text}", "length")
    return text or ""


RecordFile = Annotated[
    Path, typer.Argument(metavar="RECORD", help="The campaign record, a file *.axiscal.", autocompletion=records_here)
]
OwnRecord = Annotated[
    Path,
    typer.Argument(
        metavar="RECORD",
        default_factory=own_record,
        show_default=False,
        autocompletion=records_here,
        help="The campaign record; default: AXISCAL_RECORD, or the only one here.",
    ),
]
Language = Annotated[
    str | None,
    typer.Option(metavar="NAME", help="en or de; default: AXISCAL_LANGUAGE, or that of the computer."),
]
ReportLanguage = Annotated[
    str | None,
    typer.Option("--language", metavar="NAME", help="en or de; default: that of campaign.toml."),
]
CampaignFile = Annotated[Path, typer.Argument(metavar="CAMPAIGN", help="The description of the campaign, a TOML file.")]
Log = Annotated[Path | None, typer.Option("--log", metavar="FILE", help="The log of programs of plan --gcode --log.")]
Programs = Annotated[Path, typer.Option("--programs", metavar="DIR", help="With --log: the folder of these programs.")]
Template = Annotated[
    Path | None, typer.Option("--template", metavar="FILE", help="A file saved by your control (heidenhain, fanuc).")
]
PlacesFile = Annotated[
    Path | None, typer.Option("--plan", metavar="FILE.csv", help="Write the places as a file to fill in.")
]
Anyway = Annotated[
    bool, typer.Option("--anyway", help="Write U and tables although the readings contradict each other.")
]
Details = Annotated[
    bool, typer.Option("--details", help="Say before the last screen what U holds for, and all warnings.")
]
Unit = Annotated[
    str | None, typer.Option("--unit", metavar="UNIT", help="Of lengths without one, such as inch; default: mm.")
]
Zero = Annotated[str | None, typer.Option(metavar="PLACE", help='Where the printer homes Z, such as "150 mm, 150 mm".')]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON document and nothing else.")]
ResultsFolder = Annotated[
    Path | None, typer.Option("--out", "-o", metavar="DIR", help="Folder for the results; default: beside the record.")
]
Out = Annotated[
    Path, typer.Option("--out", "-o", metavar="DIR", help="Folder for record, result.json, report and tables.")
]
