"""`axiscal data schema`."""

from __future__ import annotations

from typing import Annotated

import typer

from axiscal.cli.printing import say_document
from axiscal.description.campaign_schema import SCHEMAS
from axiscal.language.spoken import joined, said


def schema(
    file: Annotated[str, typer.Argument(metavar="FILE", help=f"Which file: {' or '.join(SCHEMAS)}.")],
) -> None:
    """Print the JSON schema of machine.toml or campaign.toml.

    Editors complete and check both files by it.

    \b
    Example:
      axiscal data schema campaign > campaign.schema.json
    """
    if file not in SCHEMAS:
        raise typer.BadParameter(said("there are schemas of {names}", names=joined(list(SCHEMAS))))
    say_document(SCHEMAS[file]())
