"""`axiscal verify`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from axiscal.cli.options import Json, RecordFile

if TYPE_CHECKING:
    from axiscal.campaign.calibration import Calibration
    from axiscal.campaign.campaign import Campaign
    from axiscal.compensation.effect import Control
    from axiscal.compensation.estimate import Estimate
    from axiscal.compensation.offer import Export
    from axiscal.compensation.verification import Judgement, Places
    from axiscal.measurement.reading import Reading
    from axiscal.numerics import Array

    Pair = tuple[tuple[Reading, ...], tuple[Reading, ...]]


_ROUNDING = 1e-6
"""A figure below a picometre, in um."""
_NEAR = 0.3


def verify(
    record: RecordFile,
    found: Annotated[
        Path | None, typer.Option(metavar="FOUND.csv", help="Readings without the tables (as found).")
    ] = None,
    left: Annotated[
        Path | None, typer.Option(metavar="LEFT.csv", help="The same readings with the tables (as left).")
    ] = None,
    tolerance: Annotated[
        str | None, typer.Option(metavar="LENGTH", help="Largest deviation allowed; default: from the target.")
    ] = None,
    to: Annotated[
        str, typer.Option(metavar="CONTROLLER", help="The control whose tables are loaded, as in `axiscal export`.")
    ] = "csv",
    points: Annotated[int, typer.Option(min=2, max=200, help="How many places to check.")] = 12,
    plan: Annotated[Path | None, typer.Option(metavar="FILE.csv", help="Where to write the list of places.")] = None,
    source: Annotated[
        str | None, typer.Option(metavar="SOURCE", help="Read without a person: sim:SEED, truth:FILE, linuxcnc:SEED.")
    ] = None,
    json: Json = False,
) -> None:
    """Check a compensated machine at places that were not read before, and say pass, fail or undecided.

    First it plans: places where the machine should be worst, and best. Read them without the tables and with them; then
    give both files. A reading decides only with its uncertainty (ISO 14253-1).

    \b
    Examples:
      axiscal verify mill.axiscal --points 12 --plan check.csv
      axiscal verify mill.axiscal --found found.csv --left left.csv --tolerance "5 um"
      axiscal verify mill.axiscal --source linuxcnc:7 --to linuxcnc
    """
    from axiscal.campaign.calibration import calibration_of
    from axiscal.campaign.campaign import Campaign

    if (found is None) != (left is None):
        raise typer.BadParameter("give --found and --left together, or neither to get a plan")
    if found is not None and (plan is not None or source is not None):
        raise typer.BadParameter("--plan and --source are for new readings, --found and --left for readings taken")
    with Campaign.open(record, write=False) as campaign:
        calibration = calibration_of(campaign.engine)
        estimate, tables = _tables(calibration, to)
        if found is not None and left is not None:
            _judge(campaign, estimate, tables.control, _read(campaign, found, left), tolerance, json)
            return
        chosen = _chosen(campaign, calibration, estimate, tables.control, points)
        if source is None:
            _plan(campaign, estimate, tables.control, chosen, plan, json)
        else:
            _judge(campaign, estimate, tables.control, _asked(campaign, source, tables, chosen), tolerance, json)


def _tables(calibration: Calibration, controller: str) -> tuple[Estimate, Export]:
    from axiscal.compensation import registry
    from axiscal.compensation.options import Options

    estimate = calibration.estimate()
    return estimate, registry.export(estimate, controller, Options())


def _chosen(campaign: Campaign, calibration: Calibration, estimate: Estimate, control: Control, count: int) -> Places:
    from axiscal.compensation.verification import Places, plan_check, with_displacements

    setups, lattice = campaign.description.setups, calibration.problem.lattice
    candidates = with_displacements(setups, Places(lattice.setups, lattice.poses, lattice.approaches))
    return plan_check(estimate, setups, candidates, campaign.state.readings, control, count)


def _plan(
    campaign: Campaign, estimate: Estimate, control: Control, chosen: Places, plan: Path | None, json: bool
) -> None:
    from axiscal.cli.printing import say, say_document
    from axiscal.report.delivery import write_whole

    rows = _rows(campaign, estimate, chosen, control)
    if plan is not None:
        write_whole(plan, _csv(campaign, chosen))
    if json:
        say_document({"schema": "axiscal-verify/1", "plan": rows})
        return
    for row in rows:
        predicted = f"predicted: as found {row['found_um']:z.1f} um, as left {row['left_um']:z.1f} um"
        say(f"{row['setup']}: {row['place']}  from {row['approach'] or 'any side'}  {predicted}")
    if plan is not None:
        say(f"\nCopy {plan} to found.csv and left.csv, and fill in value_um without the tables and with them.")


def _asked(campaign: Campaign, source: str, tables: Export, chosen: Places) -> Pair:
    from axiscal.campaign.checking import as_found_and_left
    from axiscal.campaign.sources import Request
    from axiscal.simulation import Simulator

    description = campaign.description
    places = zip(chosen.setups.tolist(), chosen.poses.tolist(), chosen.approaches.astype(int).tolist(), strict=True)
    wanted = [
        Request(n, description.setups[s], description.machine.axes, tuple(pose), tuple(approach))
        for n, (s, pose, approach) in enumerate(places)
    ]
    return as_found_and_left(source, Simulator(description.machine, description.setups), tables, wanted)


def _read(campaign: Campaign, found: Path, left: Path) -> Pair:
    from axiscal.campaign.placing import placed_readings
    from axiscal.measurement.readers.csv_readings import read_readings

    description = campaign.description
    before, after = (placed_readings(read_readings(file), description, file) for file in (found, left))
    return before, after


def _rows(campaign: Campaign, estimate: Estimate, chosen: Places, control: Control) -> list[dict[str, object]]:
    from axiscal.cli.wording import place_text
    from axiscal.compensation.verification import expected, without_zeros
    from axiscal.measurement.wording import approach_text, shown_pose
    from axiscal.units import to_unit

    setups, axes = campaign.description.setups, estimate.machine.axes
    both = (without_zeros(setups, chosen, *expected(estimate, setups, chosen, c))[0] for c in (None, control))
    before, after = (_plain(to_unit(mean, "um")) for mean in both)
    return [
        {
            "setup": setups[s].name,
            "place": place_text(axes, tuple(pose), setups[s].moves),
            "position": shown_pose(axes, pose),
            "approach": approach_text(axes, approach),
            "found_um": float(before[i]),
            "left_um": float(after[i]),
        }
        for i, (s, pose, approach) in enumerate(
            zip(chosen.setups.tolist(), chosen.poses.tolist(), chosen.approaches.tolist(), strict=True)
        )
    ]


def _csv(campaign: Campaign, chosen: Places) -> str:
    """Return the places as a file to fill in."""
    from axiscal.measurement.wording import approach_text
    from axiscal.units import to_unit

    setups, axes = campaign.description.setups, campaign.description.machine.axes
    lines = [",".join(["setup", *(f"{a.name}_{a.unit}" for a in axes), "approach", "value_um"])]
    for s, pose, approach in zip(
        chosen.setups.tolist(), chosen.poses.tolist(), chosen.approaches.tolist(), strict=True
    ):
        at = (f"{to_unit(value, axis.unit):.6f}" for value, axis in zip(pose, axes, strict=True))
        lines.append(",".join([_quoted(setups[s].name), *at, approach_text(axes, approach), ""]))
    return "\n".join(lines) + "\n"


def _quoted(name: str) -> str:
    guarded = f"'{name}" if name[:1] in "=+-@" else name
    return '"' + guarded.replace('"', '""') + '"'


def _judge(
    campaign: Campaign, estimate: Estimate, control: Control, readings: Pair, tolerance: str | None, json: bool
) -> None:
    from axiscal.cli.printing import say, say_document
    from axiscal.compensation.verification import judge

    judgement = judge(estimate, campaign.description.setups, *readings, control, _tolerance(campaign, tolerance))
    if json:
        say_document(_document(judgement))
    else:
        say(_told(judgement))


def _tolerance(campaign: Campaign, text: str | None) -> float:
    from axiscal.exceptions import TargetError
    from axiscal.units import parse_quantity

    target = campaign.description.target
    if text is not None:
        value = parse_quantity(text, "length")
        if value <= 0:
            raise TargetError(f'a tolerance of "{text}"', "Give a length above zero")
        return value
    if target.worst is not None:
        return target.worst
    if target.rms is not None:
        return 2 * target.rms
    raise TargetError("the campaign has no accuracy target to judge by", 'Give one: --tolerance "5 um"')


def _document(judgement: Judgement) -> dict[str, object]:
    from axiscal.compensation.datums import GUARD
    from axiscal.units import to_unit

    figures = (judgement.found, judgement.left, judgement.std)
    found, left, std = (_plain(to_unit(values, "um")).tolist() for values in figures)
    return {
        "schema": "axiscal-verify/1",
        "verdict": judgement.verdict,
        "tolerance_um": to_unit(judgement.tolerance, "um"),
        "guard_band_um": GUARD * max(std),
        "readings": [
            {"found_um": f, "left_um": after, "std_um": s} for f, after, s in zip(found, left, std, strict=True)
        ],
        "agreement_p": judgement.agrees,
        "estimate_believed": judgement.believed,
        "change_p": judgement.changed,
        "change_share": judgement.share,
        "tables_loaded": judgement.loaded,
        "against_own_line": list(judgement.lines),
        "set_up_off": [{"setup": datum.setup, "unknown": datum.unknown} for datum in judgement.strained],
    }


def _plain(micrometres: Array) -> Array:
    """Return figures with what is only rounding as 0 (not −0 either)."""
    import numpy as np

    return np.where(np.abs(micrometres) < _ROUNDING, 0.0, micrometres)


def _told(judgement: Judgement) -> str:
    from axiscal.compensation.datums import GUARD
    from axiscal.units import format_quantity, to_unit

    def figures(values: Array) -> str:
        import numpy as np

        sizes = np.abs(_plain(to_unit(values, "um")))
        return f"largest {float(sizes.max()):.3g} um, RMS {float(np.sqrt(np.mean(sizes**2))):.3g} um"

    tolerance = format_quantity(judgement.tolerance, "um", 3)
    guard = format_quantity(GUARD * float(judgement.std.max()), "um", 3)
    notes = "\n".join([_agreement(judgement), *_warnings(judgement)])
    return (
        f"As found: {figures(judgement.found)}\nAs left:  {figures(judgement.left)}\n{notes}\n"
        f"{judgement.verdict.upper()} at {tolerance}, guard band {guard}: {_why(judgement)}."
    )


def _why(judgement: Judgement) -> str:
    if judgement.verdict == "undecided" and (judgement.strained or not judgement.loaded):
        return "the readings contradict what is said of the tables or the set-ups: see the warning, and read again"
    return {
        "pass": "every deviation lies inside, with its uncertainty",
        "fail": "a deviation lies outside, with all of its uncertainty",
        "undecided": "a deviation lies so near to the tolerance that the readings cannot decide: read again, or better",
    }[judgement.verdict]


def _agreement(judgement: Judgement) -> str:
    if judgement.believed:
        return "The as-left readings agree with the estimate."
    return (
        "WARNING: the readings do not agree with the estimate and its uncertainty "
        f"(p = {judgement.agrees:.2g}): the machine has changed, or the tables are not what was loaded."
    )


def _warnings(judgement: Judgement) -> list[str]:
    lines = [
        f'"{name}" is judged against its own line: its slope is not known to the tolerance.' for name in judgement.lines
    ]
    if not judgement.loaded:
        share = "" if judgement.share is None else f", they changed by {judgement.share:.2f} times that"
        lines.append(
            "WARNING: as found minus as left is not what the tables take away "
            f"(p = {judgement.changed:.2g}{share}): {_cause(judgement.share)}."
        )
    lines += [
        f'WARNING: the {datum.unknown} of "{datum.setup}" would have to be far larger than its std says: '
        "the set-up moved, or the machine has an error that looks like it."
        for datum in judgement.strained
    ]
    return lines


def _cause(share: float | None) -> str:
    """Return what most probably happened when readings changed by so many times what the tables take away."""
    if share is None:
        return "the tables hold nothing here, and yet the readings changed"
    if abs(share + 1) < _NEAR:
        return "the tables were loaded with the wrong sign"
    if abs(share) < _NEAR:
        return "the tables were not loaded, or it is another machine"
    if abs(share - 1) < _NEAR:
        return "the machine or a set-up moved between the two, or single values are wrong"
    return "the tables were not loaded, loaded with the wrong sign or unit, or it is another machine"
