"""`axiscal data predict`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from axiscal.campaign.campaign import Campaign
from axiscal.cli.arguments import Json, RecordFile
from axiscal.cli.printing import say_either
from axiscal.estimation.prediction import PosePrediction, predict_poses
from axiscal.measurement.readers.csv_table import read_poses


def predict(
    record: RecordFile,
    poses: Annotated[Path, typer.Argument(metavar="POSES.csv", help="Columns X_mm, ... C_deg, and optional approach.")],
    json: Json = False,
) -> None:
    """Say how far off the tool is at poses.

    Mean and standard deviation of the tool point along x, y, z of the workpiece frame. Axes that are left out stand at
    the middle of their travel.

    \b
    Example:
      axiscal data predict mill.axiscal poses.csv --json
    """

    wanted = read_poses(poses)
    with Campaign.open(record, write=False) as campaign:
        found = predict_poses(campaign.estimate(ended=True), wanted, poses)
    rows = [{"mean_um": each.mean_um, "std_um": each.std_um} for each in found]
    heads = f"{'pose':>5} {'x':>18} {'y':>18} {'z':>18}   um, mean and standard deviation"
    cells = (" ".join(_cell(each, axis) for axis in range(3)) for each in found)
    lines = [heads, *(f"{number:5} {each}" for number, each in enumerate(cells, start=1))]
    say_either(json, "axiscal-predict/1", {"poses": rows}, lines)


def _cell(found: PosePrediction, axis: int) -> str:
    return f"{found.mean_um[axis]:9.3f} ± {found.std_um[axis]:6.3f}"
