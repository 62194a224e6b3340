"""What a finished campaign leaves in a folder: tables, `result.json`, `report.html`."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from axiscal.campaign.calibration import Calibration
from axiscal.campaign.campaign import Campaign
from axiscal.compensation.controllers import linuxcnc, plain_csv
from axiscal.compensation.effect import Deviation, Effect, effect
from axiscal.compensation.sampling import axis_tables
from axiscal.compensation.table import CompensationTable, TableFile
from axiscal.design.lattice import even_points
from axiscal.exceptions import TableError
from axiscal.numerics import Array
from axiscal.report.assembly import Extras, summarise
from axiscal.report.summary import Summary, TableOffer, result_json
from axiscal.units import to_unit

CONTROLLERS = {"linuxcnc": linuxcnc.offer, "csv": plain_csv.offer}
"""Makers of table files by the name that `export --to` takes."""
_POSES = 2000


def deliver(campaign: Campaign, calibration: Calibration, out: Path, extras: Extras) -> Summary:
    """Write tables, result and report of a campaign, and return what they say.  Raises OSError, TableError."""
    tables = axis_tables(calibration.problem.errors, calibration.belief, _box(calibration))
    offers = [offer for name in CONTROLLERS for offer in write_tables(calibration, tables, name, out / "tables")]
    summary = summarise(campaign, calibration, replace(extras, tables=offers))
    document = json.dumps(result_json(summary), indent=2, ensure_ascii=False, allow_nan=False)
    write_whole(out / "result.json", document + "\n")
    write_report(summary, out / "report.html")
    return summary


def write_report(summary: Summary, path: Path) -> None:
    """Write the report page; raises OSError."""
    from axiscal.report.page import render

    write_whole(path, render(summary))


def write_tables(
    calibration: Calibration, tables: Sequence[CompensationTable], controller: str, folder: Path
) -> list[TableOffer]:
    """Write the tables for one controller with a note on how to load them, and return what they hold and leave.

    Raises TableError where a controller cannot hold a table, OSError.
    """
    if controller not in CONTROLLERS:
        known = ", ".join(CONTROLLERS)
        raise TableError(f'"{controller[:40]}" is not a controller that tables can be made for', f"Known are {known}")
    target = folder / controller
    target.mkdir(parents=True, exist_ok=True)
    files = [CONTROLLERS[controller](table) for table in tables]
    left = left_out(effect_of(calibration, tables))
    for file in files:
        write_whole(target / file.name, file.text)
    if files:
        write_whole(target / "README.txt", _notes(files, left))
    return [
        TableOffer(f"tables/{controller}/{file.name}", controller, table.axis, left)
        for file, table in zip(files, tables, strict=True)
    ]


def _notes(files: Sequence[TableFile], left: str) -> str:
    parts = ("\n".join([file.name, *(f"  {note}" for note in file.notes)]) for file in files)
    return "\n\n".join([left, *parts]) + "\n"


def effect_of(calibration: Calibration, tables: Sequence[CompensationTable]) -> Effect:
    """Return what the tables leave of the deviation as it is estimated."""
    errors = calibration.problem.errors
    mean = calibration.belief.mean[: errors.size]

    def estimated(poses: Array, approaches: Array) -> Array:
        deviation: Array = errors.rows(poses, approaches) @ mean
        return deviation

    return effect(errors.machine, estimated, tables, volume_poses(calibration), _box(calibration))


def reached(calibration: Calibration, truth: Deviation) -> float:
    """Return the RMS over the volume of the true deviation less the estimated one, its constant part taken off, m."""
    errors = calibration.problem.errors
    mean = calibration.belief.mean[: errors.size]

    def left(poses: Array, approaches: Array) -> Array:
        missed: Array = truth(poses, approaches) - errors.rows(poses, approaches) @ mean
        return missed

    return effect(errors.machine, left, (), volume_poses(calibration), _box(calibration)).before


def left_out(found: Effect) -> str:
    """Say what tables of single axes leave of the estimated deviation."""
    before, after = (f"{to_unit(value, 'um'):.3g} um" for value in found)
    return (
        f"Tables of single axes take the estimated TCP deviation over the volume from {before} RMS to {after}; "
        "what is left are straightness, squareness and angular errors that one axis cannot correct."
    )


def volume_poses(calibration: Calibration) -> Array:
    """Return poses spread evenly over the target's volume, (m, q)."""
    low, high = np.array(_box(calibration)).T
    poses: Array = low + (high - low) * even_points(_POSES, len(low))
    return poses


def _box(calibration: Calibration) -> tuple[tuple[float, float], ...]:
    return calibration.problem.description.target.volume


def write_whole(path: Path, text: str) -> None:
    """Write a file so that it is there whole or not at all; raises OSError."""
    draft = path.with_name(f".{path.name}.part")
    draft.write_text(text, encoding="utf-8", newline="\n")
    os.replace(draft, path)
