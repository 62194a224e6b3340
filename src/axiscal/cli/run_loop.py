"""`axiscal step run` and `demo`: the whole loop without a person."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ending import CONTRADICT, OUT_OF_REACH, Milestone, because_text
from axiscal.campaign.sources import open_source
from axiscal.cli.outputs import tell_details, write_outputs, written_screen
from axiscal.cli.printing import rewrite, say, tell
from axiscal.cli.texts import kept_words, stoppable, tell_out_of_reach
from axiscal.description.campaign import CampaignDescription, read_campaign
from axiscal.estimation.case import Case
from axiscal.exceptions import InputError, RecordError, TargetError
from axiscal.language.spoken import capital, put, said
from axiscal.language.stages import listening
from axiscal.measurement.simulation import Simulator
from axiscal.present.demo import description, run_demo
from axiscal.present.result_set import RECORD
from axiscal.units import parse_quantity, said_quantity, to_unit


def run_loop(
    campaign: Path,
    out: Path,
    source: str,
    resume: bool = False,
    timeout: str = "10 min",
    details: bool = False,
) -> None:
    """Run the whole loop without a person."""
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
            with stoppable(opened, again), shown_progress() as watch:
                try:
                    opened.run(readings, watch)
                except InputError as failure:
                    remedy = put("{remedy}. {kept}", remedy=failure.remedy, kept=kept_words(opened, again))
                    raise type(failure)(failure.what, remedy, failure.file, failure.line) from failure
        write_outputs(opened, out, details=details)
        because, file = opened.state.finished or "", opened.description.source
    why, written = because_text(because), said("the results so far are written")
    if because == OUT_OF_REACH:
        remedy = "Add set-ups that see what these cannot, give less noise or a wider target; {written}"
        raise TargetError("{why}", remedy, file, why=capital(why), written=written)
    if because == CONTRADICT:
        remedy = "See the warnings, review instruments, set-ups and what is stated, and take readings again; {written}"
        raise TargetError("The target cannot be said to be reached: {why}", remedy, file, why=why, written=written)


def _kept_campaign(path: Path, description: CampaignDescription, resume: bool) -> Campaign | None:
    """Return the campaign that the folder holds, None if there is none."""
    if not path.exists():
        return None
    opened = Campaign.open(path)
    kept = opened.description
    same = (kept.text, kept.machine.text) == (description.text, description.machine.text)
    if same and resume:
        return opened
    opened.close()
    if not resume:
        remedy = "Go on with it by --resume, or name another --out"
        raise RecordError("This folder holds a campaign already", remedy, path)
    remedy = "Name another --out for the changed description, or take the changes back"
    raise RecordError("The campaign or its machine has been changed since this record was begun", remedy, path)


@contextmanager
def shown_progress() -> Iterator[Callable[[Milestone], None]]:
    """Yield what is to be told of every reading: a line that changes on a terminal, elsewhere nothing.

    Nothing is written between two readings: what a source asks whoever stands at the machine stands alone.
    """
    with listening(None):
        if not sys.stderr.isatty():
            yield lambda milestone: None
            return
        try:
            yield lambda milestone: rewrite(progress_line(milestone))
        finally:
            tell("")


def progress_line(milestone: Milestone) -> str:
    """Return one line: reading, accuracy, minutes."""
    rms, passed = said_quantity(milestone.accuracy.rms, "um"), to_unit(milestone.seconds, "min")
    return said("reading {number}: RMS {rms}, {minutes:.1f} min", number=milestone.number, rms=rms, minutes=passed)


def demo(out: Path = Path("axiscal-demo"), details: bool = False) -> None:
    """Calibrate a built-in five-axis machine, from plan to report."""
    case, folder, number = Case(description()), out, 1
    while (folder / RECORD).exists():  # the first of out, out-2, out-3, ... that holds no campaign yet
        number += 1
        folder = out.with_name(f"{out.name}-{number}")
    folder.mkdir(parents=True, exist_ok=True)
    with shown_progress() as watch:
        result = run_demo(case, folder, watch)
    if details:
        tell_details(result)
    say(written_screen(result, folder / RECORD, folder))
