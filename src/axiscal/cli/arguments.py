"""Arguments and options that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

RecordFile = Annotated[Path, typer.Argument(metavar="RECORD", help="The campaign record, a file *.axiscal.")]
CampaignFile = Annotated[Path, typer.Argument(metavar="CAMPAIGN", help="The description of the campaign, a TOML file.")]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON document and nothing else.")]
Out = Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder for record, result.json, report and tables.")]
