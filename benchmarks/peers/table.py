"""The page: a table for each criterion, the sentences, the versions, the computer."""

from __future__ import annotations

import os
import platform
from collections.abc import Iterator
from pathlib import Path

from benchmarks.peers import evaluator
from benchmarks.peers.field import FIELD, Rival
from benchmarks.peers.judge import Judge, Outcomes, Picker, Verdict, call_seconds
from benchmarks.peers.problems import CASES, CRITERIA, CriterionName, Posed
from benchmarks.peers.runner import Bounds, Outcome

_LARGE = 2e9

_HEAD = """# Side by side with other libraries

`make bench-peers` measures this page, in {run}. Natural splines on [0, 10] add up, C₀ = I, one number per reading:

{cases}

Criterion `joint` integrates the variances of all splines, `volume` is the mean variance of their sum. A cell is the
processor time on one thread (a median pick, or the whole plan), J after the last reading, and memory above
{large:.0f} GB. One evaluator, which shares nothing with axiscal, computes J. Runs end after {seconds:.0f} s or beyond
{memory:.3g} GB.

Libraries of Gaussian processes get the exact kernel and quadrature nodes. "Over fewest places" gives Trieste as few
linear forms as J has. FIGAROH takes its own criterion, the determinant; pyoptex has 101 levels on each axis.
"""


def page(outcomes: Outcomes, ours: Picker, bounds: Bounds, resumed: bool = False) -> Iterator[str]:
    """Yield the lines of the page.  resumed : whether some outcomes come from an earlier part of the run"""
    cases = "\n".join(f"- {case.name}, σ² = {case.noise**2:g}, {case.readings} readings" for case in CASES)
    run = "a run that was resumed" if resumed else "one run"
    head = _HEAD.format(run=run, seconds=bounds.seconds, memory=bounds.memory / 1e9, cases=cases, large=_LARGE / 1e9)
    yield head.rstrip("\n")
    for criterion in CRITERIA:
        yield f"\n## Criterion `{criterion}`\n"
        yield from table(outcomes, criterion)
        yield from _missed(list(Judge(outcomes, criterion, ours).verdicts()))
    yield "\n## Measured with\n"
    yield f"{computer()}; {', '.join(versions(outcomes))}."


def _missed(verdicts: list[Verdict]) -> Iterator[str]:
    """Yield how many goals are reached, and each that is not."""
    missed = [verdict for verdict in verdicts if not verdict.reached]
    yield f"\nGoals: {len(verdicts) - len(missed)} of {len(verdicts)} reached." + (" The others:\n" if missed else "")
    yield from (str(verdict) for verdict in missed)


def table(outcomes: Outcomes, criterion: CriterionName) -> Iterator[str]:
    """Yield the table of one criterion."""
    yield "| | | " + " | ".join(f"({case.letter})" for case in CASES) + " |"
    yield "|---|---|" + "---|" * len(CASES)
    for rival in FIELD:
        found = [outcomes.get((rival.key, case.letter, criterion)) for case in CASES]
        cells = [_cell(Posed(case, criterion), outcome) for case, outcome in zip(CASES, found, strict=True)]
        yield f"| {rival.manner} | {rival.label} | " + " | ".join(cells) + " |"


def _cell(posed: Posed, outcome: Outcome | None) -> str:
    if outcome is None:
        return "not asked"
    if outcome.sorry:
        return outcome.sorry.replace("|", "/")
    seconds = call_seconds(outcome)
    large = f", {outcome.memory / 1e9:.1f} GB" if outcome.memory > _LARGE else ""
    return f"{_spoken(seconds)}, {evaluator.value(posed, outcome.places):.5g}{large}"


def _spoken(seconds: float) -> str:
    return f"{1e3 * seconds:.3g} ms" if seconds < 1.0 else f"{seconds:.3g} s"


def computer() -> str:
    """Return what the computer is, in a few words."""
    cpu, memory = platform.machine(), ""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        cpu = next((line.split(": ", 1)[1] for line in lines if line.startswith("model name")), cpu)
        total = Path("/proc/meminfo").read_text(encoding="utf-8").split()[1]
        memory = f", {float(total) / 1e6:.0f} GB"
    except OSError:
        pass
    return f"{cpu}, {os.cpu_count()} cores{memory}, {platform.system()}, Python {platform.python_version()}"


def versions(outcomes: Outcomes) -> list[str]:
    """Return the packages and versions that took part."""
    found = {name: number for outcome in outcomes.values() for name, number in outcome.versions.items()}
    return [f"{name} {number}" for name, number in sorted(found.items(), key=lambda pair: pair[0].lower())]


def line(rival: Rival, posed: Posed, outcome: Outcome) -> str:
    """Return one line about one outcome."""
    return f"{rival.manner:14} {rival.label:34} {_cell(posed, outcome)}"
