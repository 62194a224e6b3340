"""`axiscal plan`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from axiscal.accuracy.as_one import seen_as_one
from axiscal.accuracy.other_tool import other_tool
from axiscal.cli.arguments import CampaignFile, Json
from axiscal.cli.printing import say, say_document, tell
from axiscal.cli.texts import count_text, micrometres
from axiscal.description.campaign import CampaignDescription
from axiscal.description.hardly_reached import hardly_reached
from axiscal.description.programs import stated
from axiscal.description.unused import unused_artefacts
from axiscal.design.plan.plan import Plan
from axiscal.design.plan.task import Limits
from axiscal.estimation.case import Case
from axiscal.estimation.inheritance import case_of
from axiscal.estimation.uncertain import as_standard
from axiscal.exceptions import PlanError, TargetError
from axiscal.fleet.with_sisters import campaign_with_sisters
from axiscal.gcode import write_programs
from axiscal.gcode.controls import dialect
from axiscal.machine.questions import which_way
from axiscal.measurement.place_texts import approach_text, place_text
from axiscal.measurement.reading_rows import blank_readings
from axiscal.planning.feasibility import (
    fewer_than_asked,
    not_to_the_letter,
    out_of_reach,
    reached_unread,
    refuse_endless,
    refuse_out_of_reach,
)
from axiscal.planning.next_readings import enough_for_rows, few_more, placed, posed
from axiscal.planning.plan_document import bound_sentence, plan_document
from axiscal.planning.proposal import Proposal, Thoroughness, proposed, proven, refuse_unless_provable
from axiscal.planning.what_if import alternatives
from axiscal.record.durable import write_whole
from axiscal.report import room_page
from axiscal.report.what_if_page import render, table_row
from axiscal.units import parse_quantity, to_unit

_GAP = 0.5
"""Percent; a proof that is tighter takes longer, and the bound that is printed holds at any."""


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
    log: Annotated[
        bool, typer.Option("--log", help="Programs touch spheres by themselves and log it for estimate and record.")
    ] = False,
    dwell: Annotated[
        bool | None,
        typer.Option("--dwell/--stop", help="Programs wait the reading time at a reading, or stop (unless said)."),
    ] = None,
    feed: Annotated[
        str | None, typer.Option(metavar="FEED", help='Feed of the last millimetres to a reading: "500 mm/min".')
    ] = None,
    order: Annotated[
        str | None, typer.Option(metavar="GROUPS", help='Axes that move together, one group after another: "Z,X Y".')
    ] = None,
    clearance: Annotated[
        str | None,
        typer.Option(metavar="AXIS=PLACE", help='What goes clear before other axes move, and at the end: "Z=-5 mm".'),
    ] = None,
    no_tcp: Annotated[
        bool,
        typer.Option(
            "--no-tcp", help="Programs in touch for a control that cannot hold the tool point: short pieces, all axes."
        ),
    ] = False,
    compare: Annotated[
        Path | None, typer.Option(metavar="FILE.html", help="Compare the set-ups and the traditional way, as a page.")
    ] = None,
    picture: Annotated[
        Path | None, typer.Option(metavar="FILE.html", help="Draw part, balls, travels and the way, as a page.")
    ] = None,
    prove: Annotated[
        bool,
        typer.Option(
            "--prove",
            help="Prove the bound for readings anywhere in the travel, not only for the candidates. For machines whose "
            "errors add up axis by axis, for set-ups that move two linear axes, and on charts of one or two "
            "coordinates; takes seconds with one axis, minutes with three.",
        ),
    ] = False,
    gap: Annotated[
        float | None,
        typer.Option(
            metavar="PERCENT", help="End --prove when the bound is known this well; 0.5 unless said.", min=0.01
        ),
    ] = None,
    memory: Annotated[
        int,
        typer.Option(
            metavar="MB", help="Memory for the candidates' rows; beyond it they are made anew, slower.", min=1
        ),
    ] = 1000,
    json: Json = False,
) -> None:
    """Plan which readings to take, and say how good they make it.

    It gives their order, the minutes, and the distance from the best possible plan. Nothing is recorded. Without
    options the campaign's own target counts. --readings and --budget ask for the best plan of so many readings, or of
    so much time. --target alone plans within the campaign's own readings and budget. --clearance, --order, --feed and
    --dwell replace what [programs] of the campaign says.

    \b
    Examples:
      axiscal plan campaign.toml --readings 40
      axiscal plan campaign.toml --target "2 um" --json
      axiscal plan campaign.toml --budget "2 h" --gcode linuxcnc --out programs
      axiscal plan campaign.toml --readings 40 --gcode fanuc --clearance "Z=0 mm" --feed "500 mm/min" --dwell
      axiscal plan campaign.toml --readings 40 --gcode linuxcnc --log
      axiscal plan campaign.toml --readings 40 --compare what-if.html
      axiscal plan campaign.toml --readings 40 --picture where.html
      axiscal plan campaign.toml --readings 12 --prove
    """

    if log and gcode is None:
        raise PlanError("--log is of programs, and none are asked for", "Add --gcode CONTROLLER, or leave --log out")
    if gap is not None and not prove:
        raise PlanError("--gap says when a proof ends, and none was asked for", "Add --prove, or leave --gap out")
    if gcode is not None:
        dialect(gcode)
    driven = _driven(campaign_with_sisters(campaign, target_needed=False, told=tell), clearance, order, feed, dwell)
    for said in (unused_artefacts(driven), hardly_reached(driven)):
        if said is not None:
            tell(f"Mind: {said}")
    case = case_of(_without_tcp(driven) if no_tcp else driven)
    limits, how = _limits(case, readings, target, budget), Thoroughness(candidates, memory * 1e6)
    refuse_endless(case, limits, candidates)
    if prove:
        refuse_unless_provable(case)
    if target is not None:
        refuse_out_of_reach(case, limits)
    elif readings is None and budget is None and (said := out_of_reach(case)) is not None:
        tell(f"Mind: {said}")
    if (unread := reached_unread(case, limits)) is not None:
        tell(f"Mind: {unread}")
        limits = few_more(limits)
    if compare is not None:
        _compared(case, limits, how, compare, json)
        return
    proposal = proposed(case, limits, how, lambda step: tell(f"{step} ..."))
    if prove:
        proposal = proven(case, proposal, how, _share(case, gap), lambda step: tell(f"{step} ..."))
    if picture is not None:
        title = f"Where {case.description.machine.name} is read"
        write_whole(picture, room_page.render(title, case.description, placed(case, proposal.plan)).encode())
    files = [] if gcode is None else _programs(case, proposal.plan, gcode, out, log)
    if json:
        say_document(plan_document(case, proposal))
        return
    say(_table(case, limits, proposal))
    for file in [*([] if picture is None else [picture]), *files]:
        say(f"Written: {file}")


def _share(case: Case, gap: float | None) -> float:
    """Return percents of the figure that is printed as a share of J: the RMS is the root of one."""
    return (_GAP if gap is None else gap) / 100 * (2 if case.description.target.criterion == "volume" else 1)


def _limits(case: Case, readings: int | None, target: str | None, budget: str | None) -> Limits:

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
    own_rms = own.rms if own.expanded is None else max(own.rms or 0.0, as_standard(case, case.knowledge, own.expanded))
    limits = Limits(own.readings, own_rms, own.worst, own.budget)
    return enough_for_rows(case, case.knowledge, posed(case, case.knowledge), limits) if own.lines else limits


def _compared(case: Case, limits: Limits, how: Thoroughness, page: Path, as_json: bool) -> None:

    found = alternatives(case, limits, how, lambda name: tell(f"{name} ..."))
    machine = case.description.machine
    write_whole(page, render(f"Ways to measure: {machine.name}", found, which_way(machine)).encode())
    rows = [table_row(each) for each in found]
    if as_json:
        say_document({"schema": "axiscal-what-if/1", "ways": rows, "page": str(page)})
        return
    say(f"{'readings':>8} {'minutes':>8} {'RMS um':>8} {'worst um':>9}  way")
    for row in rows:
        say(f"{row['readings']:8} {row['minutes']:>8} {row['rms']:>8} {row['worst']:>9}  {row['name']}")
    say(f"The picture is in {page}.")


def _driven(
    description: CampaignDescription, clearance: str | None, order: str | None, feed: str | None, dwell: bool | None
) -> CampaignDescription:
    """Return the campaign with what the command line says of its programs; raises InputError."""
    machine, setups = description.machine, description.setups
    driving = stated(setups[0].driving, machine, clearance, order, feed, dwell)
    return replace(description, setups=tuple(replace(setup, driving=driving) for setup in setups))


def _without_tcp(description: CampaignDescription) -> CampaignDescription:
    """Return the campaign with programs that do not ask the control to hold the tool point."""
    setups = (replace(setup, driving=replace(setup.driving, tcp=False)) for setup in description.setups)
    return replace(description, setups=tuple(setups))


def _programs(case: Case, made: Plan, controller: str, out: Path, log: bool) -> list[Path]:

    out.mkdir(parents=True, exist_ok=True)
    machine, setups = case.description.machine, case.description.setups
    return write_programs(machine, setups, placed(case, made), controller, out, log)


def _table(case: Case, limits: Limits, proposal: Proposal) -> str:

    made = proposal.plan
    accuracy, minutes = made.accuracy, to_unit(made.seconds, "min")
    said = f"{count_text(len(made.readings), 'reading')} in {minutes:.1f} min: RMS {micrometres(accuracy.rms)}, "
    said += f"worst {micrometres(accuracy.worst)} (before: RMS {micrometres(made.before.rms)})."
    lines = [*_lines(case, made), said, bound_sentence(case, proposal)]
    lines += [f"Mind: {part.text}" for part in seen_as_one(case.yardstick)]
    minded = [not_to_the_letter(limits, made), fewer_than_asked(limits, made), _other_tool(case, made)]
    return "\n".join([*lines, *(f"Mind: {sentence}" for sentence in minded if sentence)])


def _other_tool(case: Case, made: Plan) -> str:
    """Return what a plan leaves with a longer tool than the one it is read with, "" where it is as good."""
    known, yardstick = case.knowledge.read(blank_readings(case.description.setups, placed(case, made))), case.yardstick
    return other_tool(case.errors, known.belief, yardstick.box, counted=yardstick.counted).words


def _lines(case: Case, made: Plan) -> list[str]:
    """Return a line for each reading, and one for each mounting, in columns."""

    axes, lines, mounted = case.description.machine.axes, list[str](), ""
    places = placed(case, made)
    moves = {setup.name: setup.moves for setup in case.description.setups}
    where = [place_text(axes, place.pose, moves[place.setup]) for place in places]
    come = [approach_text(axes, place.approach) for place in places]
    wide, side = (max((len(text) for text in texts), default=0) for texts in (where, come))
    for number, (place, reading) in enumerate(zip(places, made.readings, strict=True)):
        if place.setup != mounted:
            lines.append(f'Set-up "{place.setup}"')
            mounted = place.setup
        after = f"RMS {micrometres(reading.accuracy.rms):>8}, {to_unit(reading.seconds, 'min'):6.1f} min"
        lines.append(f"{number + 1:4}  {where[number]:{wide}}  {come[number]:{side}}  {after}")
    return lines
