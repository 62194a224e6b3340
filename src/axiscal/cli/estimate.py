"""`axiscal data estimate`, `predict` and `iso230`."""

from __future__ import annotations

from pathlib import Path

import typer

from axiscal.campaign.campaign import Campaign
from axiscal.cli.arguments import length_unit
from axiscal.cli.outputs import write_outputs
from axiscal.cli.printing import DOCUMENTS, say, say_document, say_either, tell, tell_minds
from axiscal.cli.record import placed_log
from axiscal.description.campaign import read_campaign
from axiscal.estimation.prediction import predict_poses
from axiscal.evaluation.standards import Positioning, figures_of
from axiscal.exceptions import RecordError
from axiscal.language.spoken import WORDS, decimals, said
from axiscal.measurement.readers.csv_readings import read_poses
from axiscal.measurement.readers.files import recognised
from axiscal.measurement.reading import Reading
from axiscal.present.delivery import evaluated, read_in
from axiscal.present.findings import OF_THE_READING, of_readings
from axiscal.present.plan_words import open_questions
from axiscal.present.result_set import RECORD
from axiscal.tables.exporter import unasked
from axiscal.units import to_unit


def predict(record: Path, poses: Path) -> None:
    """Say how far off the tool is at poses."""
    wanted = read_poses(poses)
    with Campaign.open(record, write=False) as campaign:
        found = predict_poses(campaign.estimate(ended=True), wanted, poses)
    means, stds = (to_unit(each, "um").tolist() for each in found)
    rows = [{"mean_um": mean, "std_um": std} for mean, std in zip(means, stds, strict=True)]
    heads = f"{'pose':>5} {'x':>18} {'y':>18} {'z':>18}   um, mean and standard deviation"
    pairs = (zip(row["mean_um"], row["std_um"], strict=True) for row in rows)
    cells = (" ".join(f"{mean:9.3f} ± {std:6.3f}" for mean, std in each) for each in pairs)
    lines = [heads, *(f"{number:5} {each}" for number, each in enumerate(cells, start=1))]
    say_either("axiscal-predict/1", {"poses": rows}, lines)


def estimate(
    campaign: Path,
    out: Path,
    readings: Path | None = None,
    unit: str | None = None,
    axis: str = "",
    zero: str | None = None,
    log: Path | None = None,
    programs: Path = Path("programs"),
    details: bool = False,
) -> None:
    """Evaluate readings that exist already; nothing is planned."""
    description = read_campaign(campaign, target_needed=False, asking=False)
    if readings is None and log is None:
        raise typer.BadParameter(said("give READINGS.csv or --log FILE"))
    placed, told = tuple[Reading, ...](), ""
    if readings is not None:
        description, placed, told = read_in(description, readings, length_unit(unit), axis, zero)
    if log is not None:
        placed = (*placed, *placed_log(log, programs, description))
    if (out / RECORD).exists():
        raise RecordError("This folder holds a campaign already", "Name another --out, or remove it", out / RECORD)
    if told:
        tell(told)
    warnings = of_readings(placed, description.setups, description.machine.axes)
    with evaluated(description, placed) as opened:
        kept, again = out / RECORD, "give the command again"
        result = write_outputs(opened, out, details=details, record=kept, warnings=warnings, again=again)
    seen = [each.text for code in OF_THE_READING if not details for each in result.warnings if each.code == code]
    tell_minds(unasked(description), *seen, *open_questions(description))


def iso230(readings: Path, unit: str | None = None) -> None:
    """Print the figures of ISO 230-2 or ISO 230-4."""
    read = recognised(readings, unit=length_unit(unit))
    found = figures_of(read)
    tell(read.sentence())
    document = found.as_json()
    if DOCUMENTS.get():
        say_document(document)
        return
    if isinstance(found, Positioning):
        for name, words in WORDS["positioning"].items():
            value, figure = document[name], f"{said('not measured'):>12}"
            if value is not None:
                around = f" ± {to_unit(found.uncertainty[name], found.unit):.3f}" if name in found.uncertainty else ""
                figure = decimals(f"{value:12.3f} {found.unit}{around}")
            say(f"{name:7}{figure}   {said(words)}")
    else:
        circle = WORDS["circle"]
        for name, value in found.figures.items():
            figure = decimals(f"{to_unit(value, 'um'):10.3f}")
            say(f"{name:20}{figure} um   {said(circle[name])}")
    for warning in found.warnings:
        say(warning)
