"""`axiscal study`."""

from __future__ import annotations

import math
import time
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Annotated

import typer

from axiscal.campaign.possible import versions
from axiscal.cli.arguments import Json
from axiscal.cli.printing import say_either
from axiscal.cli.texts import saying_what_is_kept
from axiscal.document.durable import write_whole
from axiscal.exceptions import StudyError
from axiscal.language.spoken import counted, said
from axiscal.ports.study.comparing import verdicts, ways_of
from axiscal.ports.study.results import Processes, Ran, Results, rows_of, run_missing, write_table
from axiscal.ports.study.study_case import FIGURES, Done, WorkItem, answered, here, outcome, processors_here
from axiscal.ports.study.study_file import Study, read_study
from axiscal.ports.study.study_page import render

_TRIED = 2
"""Cases that --dry-run computes."""


def study(
    file: Annotated[Path, typer.Argument(metavar="STUDY", help="The description of the study, a TOML file.")],
    out: Annotated[
        Path | None, typer.Option("--out", "-o", metavar="DIR", help="Folder for the results; default: STUDY-results.")
    ] = None,
    workers: Annotated[
        int | None, typer.Option(metavar="N", help="Processes on this computer; default: its processors.", min=1)
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Compute only the cases that DIR lacks.")] = False,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Say how many cases there are and how long they take, from the first two.")
    ] = False,
    json: Json = False,
) -> None:
    """Find by virtual machines which set-up pays.

    It measures many virtual machines in many ways. STUDY names a campaign, which of its keys vary, and how many virtual
    machines each way is tried on. Every result is on the disk at once: after Ctrl-C, or anything worse, --resume goes
    on. DIR gets cases.jsonl while it runs, then study.html and cases.csv.

    \b
    Examples:
      axiscal study study.toml --dry-run
      axiscal study study.toml --out results
      axiscal study study.toml --out results --resume
    """
    described = read_study(file)
    if dry_run:
        _foretell(described, workers or processors_here(), json)
        return
    folder = out or file.with_name(f"{file.stem}-results")
    count = min(workers or processors_here(), described.count)
    engine = here if count == 1 else Processes(count)
    again = f"axiscal study {file} --out {folder} --resume"
    with Results(folder, described.text, described.digest, versions(), resume) as results:
        questions = (WorkItem(case.key, case) for case in described.cases())
        with saying_what_is_kept(partial(_kept, results, described, again)):
            ran = run_missing(results, questions, described.count, outcome, engine)
        _write(described, results, folder, ran, json)
    if ran.failed:
        one = "{count} case of {cases} could not be computed: the last column of the table says why"
        many = "{count} cases of {cases} could not be computed: the last column of the table says why"
        what = counted(one, many, ran.failed, cases=described.count)
        raise StudyError(what, "Mend the study, and begin another --out")


def _kept(results: Results, described: Study, again: str) -> str:
    one, many = (
        "{kept} of {count} case are kept; go on with: {again}",
        "{kept} of {count} cases are kept; go on with: {again}",
    )
    return counted(one, many, described.count, kept=len(results.found), again=again)


def _write(described: Study, results: Results, folder: Path, ran: Ran, json: bool) -> None:
    found = results.found
    table = write_table(folder, rows_of(described, found))
    page = folder / "study.html"
    write_whole(page, render(described, found).encode())
    ways = ways_of(described, found)
    spoken = verdicts(described, ways)
    document = {
        "cases": described.count,
        "computed": ran.computed,
        "there_before": ran.there,
        "failed": ran.failed,
        "said": spoken,
        "ways": [
            {
                "choices": dict(way.choices),
                "failed": way.failed,
                "figures": {
                    FIGURES[name].column: {
                        "mean": mean.value,
                        "two_standard_errors": mean.error if math.isfinite(mean.error) else None,
                        "machines": mean.machines,
                        "median": spread.middle,
                        "quartiles": [spread.low, spread.high],
                    }
                    for name in way.figures
                    if (mean := way.mean(name)) is not None and (spread := way.spread(name)) is not None
                },
            }
            for way in ways
        ],
        "written": [str(page), str(table), str(results.path)],
    }
    computed = counted("{count} case", "{count} cases", ran.computed)
    words = "{cases} computed, {there} were there. Written: {page}, {table}"
    words = words if ran.there else "{cases} computed. Written: {page}, {table}"
    done = said(words, cases=computed, there=ran.there, page=page, table=table)
    lines = [*(sentence.replace("µ", "u") for sentence in spoken), done]  # as terminals have it; the page keeps µ
    say_either(json, "axiscal-study/1", document, lines)


def _foretell(described: Study, workers: int, json: bool) -> None:
    """Say how many cases there are, and how long they take by the first two; the first of a way chooses its places."""
    seconds, found = list[float](), list[Done]()
    for case in islice(described.cases(), _TRIED):
        begun = time.process_time()
        found.append(answered(outcome, WorkItem(case.key, case)))
        seconds.append(time.process_time() - begun)
    ways = described.count // described.machines
    hours = (ways * seconds[0] + (described.count - ways) * seconds[-1]) / 3600
    wrong = next((done.error for done in found if done.result is None), None)
    long, short = "{hours:.2g} processor hours", "{minutes:.2g} processor minutes"
    taking = said(long, hours=hours) if hours >= 1 else said(short, minutes=60 * hours)
    words = said(
        "{cases}: {ways} on {machines}. By the first two: about {taking}, on {workers} at a time.",
        cases=counted("{count} case", "{count} cases", described.count),
        ways=counted("{count} way", "{count} ways", ways),
        machines=counted("{count} machine", "{count} machines", described.machines),
        taking=taking,
        workers=workers,
    )
    document = {"cases": described.count, "ways": ways, "processor_hours": hours, "workers": workers, "failed": wrong}
    say_either(json, "axiscal-study-dry-run/1", document, [words])
    if wrong is not None:
        raise StudyError("One of the first two cases cannot be computed: {reason}", "Mend the study", reason=wrong)
