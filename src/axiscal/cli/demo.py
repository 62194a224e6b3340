"""`axiscal demo`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from axiscal.cli.arguments import Details
from axiscal.cli.outputs import tell_details, written_screen
from axiscal.cli.printing import say
from axiscal.cli.progress import shown_progress
from axiscal.estimation.case import Case
from axiscal.present.demo import description, run_demo
from axiscal.present.result_set import RECORD


def demo(
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder for the results.")] = Path("axiscal-demo"),
    details: Details = False,
) -> None:
    """Calibrate a built-in five-axis machine, from plan to report.

    Its hidden errors come from measured curves. It plans, measures on a virtual machine, estimates, stops, writes
    tables and a report, and says what was promised and what was reached.

    \b
    Example:
      axiscal demo --out demo-out
    """

    case, folder = Case(description()), _fresh(out)
    with shown_progress(case.description.target) as watch:
        summary = run_demo(case, folder, watch)
    if details:
        tell_details(summary, folder)
    say(written_screen(summary, folder / RECORD, folder))


def _fresh(out: Path) -> Path:
    """Return `out`, or the first of out-2, out-3, ... that holds no campaign yet."""
    number, folder = 1, out
    while (folder / RECORD).exists():
        number += 1
        folder = out.with_name(f"{out.name}-{number}")
    folder.mkdir(parents=True, exist_ok=True)
    return folder
