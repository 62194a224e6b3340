"""`axiscal step start`."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated

import typer

from axiscal.answers.answer_words import ending
from axiscal.campaign.campaign import Campaign
from axiscal.cli.arguments import CampaignFile, Json
from axiscal.cli.printing import say_either
from axiscal.cli.progress import tell_out_of_reach, tell_unasked
from axiscal.language.spoken import counted, said
from axiscal.ports.fleet.type_learning import campaign_with_sisters


def start(
    campaign: CampaignFile,
    record: Annotated[
        Path | None,
        typer.Argument(metavar="RECORD", help="The record to make; default: the campaign's name with .axiscal, here."),
    ] = None,
    json: Json = False,
) -> None:
    """Begin a campaign: make its record.

    The record carries both descriptions; later changes of the files do not touch it.

    \b
    Example:
      axiscal step start campaign.toml mill.axiscal
    """

    description = campaign_with_sisters(campaign)
    path = record or Path(f"{campaign.stem}.axiscal")
    with Campaign.create(path, description) as opened:
        try:
            tell_out_of_reach(opened)
            tell_unasked(description)
            planned = opened.prepared()
        except BaseException:  # nothing stays of a campaign that cannot be planned
            path.unlink(missing_ok=True)  # on a server it stays: nothing is deleted there
            raise
    setups = counted("{count} set-up", "{count} set-ups", len(description.setups))
    readings = counted("{count} reading", "{count} readings", len(planned))
    ready = "{record} is ready: {machine}, {setups}, {readings} planned."
    words = said(ready, record=path, machine=description.machine.name, setups=setups, readings=readings)
    coming = ending({said("Next"): [f"axiscal measure {shlex.quote(str(path))}"]})
    say_either(json, "axiscal-start/1", {"record": str(path)}, [words, *coming])
