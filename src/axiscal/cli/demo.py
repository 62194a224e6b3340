"""`axiscal demo`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from axiscal.cli.arguments import Details
from axiscal.cli.outputs import tell_details, written_screen
from axiscal.cli.printing import say
from axiscal.cli.progress import shown_progress
from axiscal.cli.texts import micrometres
from axiscal.estimation.case import Case
from axiscal.measurement.place import Place
from axiscal.present.demo.five_axis import description, run_demo
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

    case = Case(description())
    folder = _fresh(out)
    say(_beginning(case))
    with shown_progress(case.description.target) as watch:
        summary = run_demo(case, folder, lambda places: say(_planned(case, places)), watch)
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


def _beginning(case: Case) -> str:
    machine = case.description.machine
    setups = "\n".join(f"  {setup.name}: {setup.instrument}" for setup in case.description.setups)
    target = case.description.target
    return (
        f"{machine.name}, {machine.chain}: {len(machine.error_names)} errors with {case.errors.size} unknowns.\n"
        f"Its hidden truth is made of measured curves (axiscal/present/demo/SOURCES.md). Set-ups:\n{setups}\n"
        f"Target: {micrometres(target.rms or 0.0)} RMS at the tool over the volume."
    )


def _planned(case: Case, places: Sequence[Place]) -> str:
    counts = Counter(place.setup for place in places)
    used = ", ".join(f'{count} in "{setup}"' for setup, count in counts.items())
    idle = [f'"{setup.name}"' for setup in case.description.setups if setup.name not in counts]
    left = f" Not worth their mounting: {', '.join(idle)}." if idle else ""
    return f"Planned together: {len(places)} readings, {used}.{left}"
