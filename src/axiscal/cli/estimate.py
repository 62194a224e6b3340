"""`axiscal estimate`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from axiscal.cli.options import CampaignFile, Json, Out


def estimate(
    campaign: CampaignFile,
    readings: Annotated[
        Path, typer.Argument(metavar="READINGS.csv", help="Readings that exist, or an ISO 230-2 test.")
    ],
    out: Out,
    json: Json = False,
) -> None:
    """Evaluate readings that exist already; nothing is planned.

    Columns: setup, X_mm, Y_mm, ... B_deg, approach, value_um (value_urad for angles); parked axes may be left out.
    The columns of an ISO 230-2 test (target_mm, direction, run, deviation_um) do for a campaign with one set-up and one
    moving axis.

    \b
    Example:
      axiscal estimate campaign.toml readings.csv --out results
    """
    from axiscal.campaign.description import read_campaign
    from axiscal.campaign.placing import placed_readings
    from axiscal.cli.opening import create_campaign
    from axiscal.cli.outputs import RECORD, write_outputs
    from axiscal.measurement.readers.csv_readings import read_readings

    description = read_campaign(campaign, target_needed=False)
    placed = placed_readings(read_readings(readings), description, readings)
    out.mkdir(parents=True, exist_ok=True)
    with create_campaign(out / RECORD, description) as opened:
        opened.adopt(placed)
        opened.finish("all readings evaluated")
        write_outputs(opened, out, as_json=json)
