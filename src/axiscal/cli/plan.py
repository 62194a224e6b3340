"""`axiscal plan` and `axiscal step start`."""

from __future__ import annotations

import shlex
from dataclasses import replace
from pathlib import Path

from axiscal.campaign.campaign import Campaign
from axiscal.cli.arguments import above_zero
from axiscal.cli.printing import DOCUMENTS, say, say_document, say_either, tell_minds
from axiscal.cli.texts import tell_out_of_reach
from axiscal.description.artefacts import unused_artefacts
from axiscal.description.campaign import CampaignDescription, read_campaign
from axiscal.document.durable import write_whole
from axiscal.estimation.case import Case
from axiscal.estimation.inheritance import case_of
from axiscal.exceptions import PlanError, TargetError
from axiscal.language.spoken import counted, ending, said
from axiscal.planning.enough import few_more
from axiscal.planning.next_readings import CANDIDATES, placed
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import (
    beyond_budget,
    bought,
    proposed,
    reached_unread,
    refuse_endless,
    refuse_out_of_reach,
)
from axiscal.planning.unseen import seen_as_one
from axiscal.present.plan_answer import plan_answer
from axiscal.present.plan_words import open_questions, plan_list, plan_screen
from axiscal.present.schematic import plan_picture
from axiscal.programs import write_programs
from axiscal.programs.dialects import dialect
from axiscal.tables.exporter import unasked


def plan(
    campaign: Path,
    readings: int | None = None,
    target: str | None = None,
    budget: str | None = None,
    candidates: int | None = None,
    gcode: str | None = None,
    out: Path = Path("programs"),
    log: bool = False,
    picture: Path | None = None,
    details: bool = False,
) -> None:
    """Plan which readings to take, and say how good they make it."""
    if log and gcode is None:
        raise PlanError("--log is of programs, and none are asked for", "Add --gcode CONTROLLER, or leave --log out")
    if picture is not None and picture.suffix.lower() != ".svg":
        remedy = "Give it a name that ends in .svg"
        raise PlanError("--picture draws an SVG file, and {name} is none", remedy, name=picture.name)
    if gcode is not None:
        dialect(gcode)
    described = read_campaign(campaign, target_needed=False)
    tell_minds(unused_artefacts(described.text))
    ends, case = not described.target.empty, case_of(_aimed(described, readings, target, budget))
    limits = _limits(case, readings, target, budget)
    refuse_endless(case, limits, tried := candidates or CANDIDATES)
    if target is not None:
        refuse_out_of_reach(case, limits)
    if (unread := reached_unread(case, limits)) is not None:
        limits = few_more(limits)
    tell_minds(unread, beyond_budget(case, limits))
    plan = proposed(case, limits, tried)
    if picture is not None:
        title = said("Where {machine} is read", machine=case.description.machine.name)
        write_whole(picture, plan_picture(title, case.description, placed(case, plan)).encode())
    written = [] if picture is None else [str(picture)]
    if gcode is not None:
        out.mkdir(parents=True, exist_ok=True)
        machine, setups = case.description.machine, case.description.setups
        count = len(write_programs(machine, setups, placed(case, plan), gcode, out, log))
        written.append(f"{out} ({count} files, README.txt there)")
    buys = bought(case, plan.places, plan.seconds, tried) if DOCUMENTS.get() else ()
    answer = plan_answer(case, plan, limits, buys, ends=ends)
    if DOCUMENTS.get():
        say_document(answer.model_dump(mode="json", by_alias=True))
        return
    if details:
        minded = [said("Mind: {sentence}", sentence=part.text) for part in seen_as_one(case.yardstick)]
        say("\n".join([*plan_list(answer), *minded]))
    say(plan_screen(answer, str(campaign), written))


def _aimed(
    description: CampaignDescription, readings: int | None, target: str | None, budget: str | None
) -> CampaignDescription:
    """Return the campaign with the target of these options; raises TargetError, UnitError."""
    own = description.target
    if own.empty and readings is None and target is None and budget is None:
        remedy = 'Say --readings 40, --target "2 um" or --budget "2 h", or give the campaign a target'
        raise TargetError("nothing would ever end this plan", remedy)
    if target is None:
        return description
    return replace(description, target=replace(own, rms=above_zero(target, "length"), worst=None, expanded=None))


def _limits(case: Case, readings: int | None, target: str | None, budget: str | None) -> Limits:
    own = case.description.target
    if readings is not None or budget is not None:  # so many readings, or so much time: as good as they can be
        seconds = None if budget is None else above_zero(budget, "time")
        return Limits(readings, None if target is None else own.rms, None, seconds)
    if target is not None:  # an accuracy, within what the campaign allows
        return Limits(own.readings, own.rms, None, own.budget)
    return Limits.of(own)


def start(campaign: Path, record: Path | None = None) -> None:
    """Begin a campaign: make its record."""
    description = read_campaign(campaign)
    path = record or Path(f"{campaign.stem}.axiscal")

    with Campaign.create(path, description) as begun:
        try:
            tell_out_of_reach(begun)
            tell_minds(unasked(description), *open_questions(description))
            planned = begun.prepared()
        except BaseException:  # nothing stays of one that cannot be planned
            begun.close()
            path.unlink(missing_ok=True)
            raise
    setups = counted("{count} set-up", "{count} set-ups", len(description.setups))
    readings = counted("{count} reading", "{count} readings", len(planned))
    ready = "{record} is ready: {machine}, {setups}, {readings} planned."
    words = said(ready, record=path, machine=description.machine.name, setups=setups, readings=readings)
    coming = ending({said("Next"): [f"axiscal measure {shlex.quote(str(path))}"]})
    say_either("axiscal-start/1", {"record": str(path)}, [words, *coming])
