"""`axiscal plan`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from axiscal.cli.options import CampaignFile, Json

if TYPE_CHECKING:
    from axiscal.campaign.problem import Problem
    from axiscal.design.plan import Plan
    from axiscal.design.problem import Limits


def plan(
    campaign: CampaignFile,
    readings: Annotated[int | None, typer.Option(metavar="M", help="So many readings.", min=1)] = None,
    target: Annotated[str | None, typer.Option(metavar="RMS", help='An accuracy to reach, such as "2 um".')] = None,
    budget: Annotated[str | None, typer.Option(metavar="TIME", help='Machine time, such as "2 h".')] = None,
    candidates: Annotated[int, typer.Option(metavar="N", help="Places to choose from.", min=10)] = 4000,
    gcode: Annotated[
        str | None, typer.Option(metavar="CONTROLLER", help="Write the plan as programs for this control, into --out.")
    ] = None,
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder for the programs.")] = Path("programs"),
    compare: Annotated[
        Path | None, typer.Option(metavar="FILE.html", help="Compare the set-ups and the traditional way, as a page.")
    ] = None,
    json: Json = False,
) -> None:
    """Plan a calibration: which readings, in which order, how long, how good, and how far from the best possible.

    Without options the campaign's own target holds. --readings and --budget plan for the best that so many readings, or
    so much time, can bring; --target alone plans within the campaign's own readings and budget. Nothing is recorded.

    \b
    Examples:
      axiscal plan campaign.toml --readings 40
      axiscal plan campaign.toml --target "2 um" --json
      axiscal plan campaign.toml --budget "2 h" --gcode linuxcnc --out programs
      axiscal plan campaign.toml --readings 40 --compare what-if.html
    """
    from axiscal.campaign.description import read_campaign
    from axiscal.campaign.inheritance import problem_of
    from axiscal.campaign.plan_document import plan_document
    from axiscal.campaign.planning import whole_plan
    from axiscal.cli.printing import say, say_document, tell
    from axiscal.gcode.registry import dialect

    if gcode is not None:
        dialect(gcode)
    case = problem_of(read_campaign(campaign, target_needed=False))
    limits = _limits(case, readings, target, budget)
    if compare is not None:
        _compared(case, limits, candidates, compare, json)
        return
    made = whole_plan(case, limits, candidates, lambda step: tell(f"{step} ..."))
    files = [] if gcode is None else _programs(case, made, gcode, out)
    if json:
        say_document(plan_document(case, made))
        return
    say(_table(case, made))
    for file in files:
        say(f"Written: {file}")


def _limits(case: Problem, readings: int | None, target: str | None, budget: str | None) -> Limits:
    from axiscal.design.problem import Limits
    from axiscal.exceptions import TargetError
    from axiscal.units import parse_quantity

    own = case.description.target
    if own.empty and readings is None and target is None and budget is None:
        remedy = 'Say --readings 40, --target "2 um" or --budget "2 h", or give the campaign a target'
        raise TargetError("nothing would ever end this plan", remedy)
    rms = None if target is None else parse_quantity(target, "length")
    seconds = None if budget is None else parse_quantity(budget, "time")
    for value, text in ((rms, target), (seconds, budget)):
        if value is not None and value <= 0:
            raise TargetError(f'"{text}" is not above zero', "Give an accuracy or a time above zero")
    if readings is not None or seconds is not None:  # so many readings, or so much time: as good as they can be
        return Limits(readings, rms, None, seconds)
    if rms is not None:  # an accuracy, within what the campaign allows
        return Limits(own.readings, rms, None, own.budget)
    return Limits(own.readings, own.rms, own.worst, own.budget)


def _compared(case: Problem, limits: Limits, candidates: int, page: Path, as_json: bool) -> None:
    from axiscal.campaign.what_if import alternatives
    from axiscal.cli.printing import say, say_document, tell
    from axiscal.report.delivery import write_whole
    from axiscal.report.what_if import render, table_row

    found = alternatives(case, limits, candidates, lambda name: tell(f"{name} ..."))
    write_whole(page, render(f"Ways to measure: {case.description.machine.name}", found))
    rows = [table_row(each) for each in found]
    if as_json:
        say_document({"schema": "axiscal-what-if/1", "ways": rows, "page": str(page)})
        return
    say(f"{'readings':>8} {'minutes':>8} {'RMS um':>8} {'worst um':>9}  way")
    for row in rows:
        say(f"{row['readings']:8} {row['minutes']:>8} {row['rms']:>8} {row['worst']:>9}  {row['name']}")
    say(f"The picture is in {page}.")


def _programs(case: Problem, made: Plan, controller: str, out: Path) -> list[Path]:
    from axiscal.campaign.planning import placed
    from axiscal.gcode import write_programs

    out.mkdir(parents=True, exist_ok=True)
    return write_programs(case.description.machine, case.description.setups, placed(case, made), controller, out)


def _table(case: Problem, made: Plan) -> str:
    from axiscal.campaign.feasibility import out_of_reach
    from axiscal.campaign.plan_document import bound_sentence
    from axiscal.campaign.planning import placed
    from axiscal.cli.wording import micrometres
    from axiscal.measurement.wording import approach_text, place_text
    from axiscal.units import to_unit

    axes = case.description.machine.axes
    lines, mounted = [], ""
    for number, (place, reading) in enumerate(zip(placed(case, made), made.readings, strict=True), start=1):
        if place.setup != mounted:
            lines.append(f'Set-up "{place.setup}"')
            mounted = place.setup
        where = place_text(axes, place.position, case.description.setup(place.setup).moves)
        come = approach_text(axes, place.approach)
        after = f"RMS {micrometres(reading.accuracy.rms)}, {to_unit(reading.seconds, 'min'):.1f} min"
        lines.append(f"{number:4}  {where}  {come:8}  {after}")
    accuracy, minutes = made.accuracy, to_unit(made.seconds, "min")
    lines.append(
        f"{len(made.readings)} readings in {minutes:.1f} min: RMS {micrometres(accuracy.rms)}, "
        f"worst {micrometres(accuracy.worst)} (before: RMS {micrometres(made.before.rms)})."
    )
    lines.append(bound_sentence(case, made))
    reach = out_of_reach(case)
    return "\n".join(lines if reach is None else [*lines, f"Mind: {reach}"])
