"""`axiscal step run` and `demo`: the whole loop without a person."""

from __future__ import annotations

from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ending import CONTRADICT, OUT_OF_REACH, because_text
from axiscal.campaign.sources import open_source
from axiscal.cli.arguments import CampaignFile, Details, Json, Out
from axiscal.cli.outputs import tell_details, write_outputs, written_screen
from axiscal.cli.printing import say
from axiscal.cli.progress import shown_progress, tell_out_of_reach
from axiscal.cli.texts import saying_what_is_kept
from axiscal.description.campaign import CampaignDescription, read_campaign
from axiscal.estimation.case import Case
from axiscal.exceptions import RecordError, TargetError
from axiscal.language.spoken import capital, counted, said
from axiscal.measurement.simulation import Simulator
from axiscal.present.demo import description, run_demo
from axiscal.present.result_set import RECORD
from axiscal.record.events import Asked, Created, Planned
from axiscal.record.store import Record
from axiscal.units import parse_quantity


def run_loop(
    campaign: CampaignFile,
    out: Out,
    source: Annotated[
        str,
        typer.Option(
            metavar="SOURCE",
            help="sim, sim:SEED, truth:FILE.csv, csv:FILE, exec:COMMAND or linuxcnc-live:HOST.",
        ),
    ],
    resume: Annotated[bool, typer.Option("--resume", help="Go on with the record that DIR holds.")] = False,
    timeout: Annotated[
        str, typer.Option(metavar="TIME", help="How long an exec: command may take over one reading.")
    ] = "10 min",
    details: Details = False,
    json: Json = False,
) -> None:
    """Run the whole loop without a person.

    It asks and reads from SOURCE until a target is reached. After Ctrl-C or a source that dies, --resume goes on.

    \b
    Examples:
      axiscal step run campaign.toml --source sim:7 --out results
      axiscal step run campaign.toml --source "exec:./laser.py --port 3" --out results
    """

    description, seconds = read_campaign(campaign), parse_quantity(timeout, "time")
    again = f'axiscal step run {campaign} --source "{source}" --out {out} --resume'
    with ExitStack() as stack:
        opened = _kept_campaign(out / RECORD, description, resume)
        active = bool(description.compensation_active)
        taken = 0 if opened is None else len(stack.enter_context(opened).state.readings)
        if opened is None or opened.state.finished is None:
            readings = open_source(source, Simulator(description.machine, description.setups), seconds, taken, active)
            stack.callback(readings.close)
            if opened is None:  # a source that cannot be opened has left nothing behind
                out.mkdir(parents=True, exist_ok=True)
                opened = stack.enter_context(Campaign.create(out / RECORD, description))
            tell_out_of_reach(opened)
            kept = partial(_kept, opened, again)
            with saying_what_is_kept(kept), shown_progress(description.target) as watch:
                opened.run(readings, watch)
        write_outputs(opened, out, as_json=json, details=details)
        because, file = opened.state.finished or "", opened.description.source
    why, written = because_text(because), said("the results so far are written")
    if because == OUT_OF_REACH:
        remedy = "Add set-ups that see what these cannot, give less noise or a wider target; {written}"
        raise TargetError("{why}", remedy, file, why=capital(why), written=written)
    if because == CONTRADICT:
        remedy = "See the warnings, review instruments, set-ups and what is stated, and take readings again; {written}"
        raise TargetError("The target cannot be said to be reached: {why}", remedy, file, why=why, written=written)


def _kept_campaign(path: Path, description: CampaignDescription, resume: bool) -> Campaign | None:
    """Return the campaign that the folder holds, None if there is none, or none that was begun with a reading."""

    if not path.exists():
        return None
    opened = Campaign.open(path)
    kept = opened.description
    same = (kept.text, kept.machine.text) == (description.text, description.machine.text)
    if same and resume:
        return opened
    opened.close()
    events = Record.open(path, write=False).events()
    if all(isinstance(stored.event, Created | Planned | Asked) for stored in events):
        path.unlink()
        return None
    if not resume:
        remedy = "Go on with it by --resume, or name another --out"
        raise RecordError("This folder holds a campaign already", remedy, path)
    remedy = "Name another --out for the changed description, or take the changes back"
    raise RecordError("The campaign or its machine has been changed since this record was begun", remedy, path)


def _kept(campaign: Campaign, again: str) -> str:
    count = len(campaign.state.readings)
    one, many = "{count} reading is kept in {record}", "{count} readings are kept in {record}"
    return said("{kept}; go on with: {again}", kept=counted(one, many, count, record=campaign.path), again=again)


def demo(
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder for the results.")] = Path("axiscal-demo"),
    details: Details = False,
) -> None:
    """Calibrate a built-in five-axis machine, from plan to report.

    Its hidden errors come from measured curves. It says what was promised and what was reached.

    \b
    Example:
      axiscal demo --out demo-out
    """

    case, folder, number = Case(description()), out, 1
    while (folder / RECORD).exists():  # the first of out, out-2, out-3, ... that holds no campaign yet
        number += 1
        folder = out.with_name(f"{out.name}-{number}")
    folder.mkdir(parents=True, exist_ok=True)
    with shown_progress(case.description.target) as watch:
        result = run_demo(case, folder, watch)
    if details:
        tell_details(result)
    say(written_screen(result, folder / RECORD, folder))
