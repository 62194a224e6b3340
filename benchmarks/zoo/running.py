"""The one way through the program: init, what a stranger changes, READINGS.csv, estimate, tables, judge."""

from __future__ import annotations

import io
import os
import re
from collections.abc import Iterable
from contextlib import redirect_stderr, redirect_stdout
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from axiscal.cli.app import run
from axiscal.numerics import Array
from benchmarks.zoo.animals import Animal, Interval, Job, Judged, Met
from benchmarks.zoo.answers import Answer
from tests.commands import Outcome

_ERROR = re.compile(r"[A-Z0-9]{3}(_reversal)? = \{")


def given(*words: object) -> Outcome:
    """Return what a command answers that is given in this process."""
    os.environ["AXISCAL_PROGRESS"] = "off"
    with redirect_stdout(io.StringIO()) as out, redirect_stderr(io.StringIO()) as err:
        status = run([str(word) for word in words])
    return Outcome(status, out.getvalue(), err.getvalue())


def described(job: Job, folder: Path) -> Path:
    """Return the campaign that `init` writes into a folder, with the lines that a stranger changes."""
    wanted = [word for name in job.instruments for word in ("--instrument", name)]
    _ = given("init", folder, *_machine(job, folder), *wanted, "--target", job.target).printed
    machine, path = folder / "machine.toml", folder / "campaign.toml"
    text = path.read_text(encoding="utf-8")
    active = () if "\ncompensation_active" in text else (("", "compensation_active = false\n"),)
    for old, new in (*active, *job.stated):
        assert old in text, f"init does not write {old!r}"
        text = text.replace(old, new, 1)
    path.write_text(text, encoding="utf-8")
    lines = machine.read_text(encoding="utf-8").splitlines(keepends=True)
    kept = [line for line in lines if not job.errors or not _ERROR.match(line) or line.startswith(job.errors)]
    machine.write_text("".join(kept), encoding="utf-8")
    return path


def _machine(job: Job, folder: Path) -> tuple[object, ...]:
    """Return the words that say which machine, its INI file written beside the folder."""
    if "\n" not in job.machine:
        return "--machine", job.machine
    ini = folder.with_name("machine.ini")
    ini.write_text(job.machine, encoding="utf-8")
    return "--from", ini


@cache
def planned(job: Job, readings: int) -> tuple[dict[str, Any], ...]:
    """Return the points that a plan of so many readings asks for, as `plan --json` says them."""
    with TemporaryDirectory() as folder:
        plan = given("plan", described(job, Path(folder, "job")), "--readings", readings, "--json")
    return tuple(plan.document["points"])


def answered(job: Job, met: Met, folder: Path) -> Answer:
    """Return what the program makes of readings in a folder of their own."""
    campaign = described(job, folder)
    path = folder / met.file
    path.write_text(met.readings, encoding="utf-8")
    out = folder / "results"
    return Answer(out, given("data", "estimate", campaign, path, "--out", out))


def judged(animal: Animal, seed: int = 0) -> Judged:
    """Return what becomes of an animal."""
    met = animal.meet(seed)
    with TemporaryDirectory() as folder:
        answer = answered(animal.job, met, Path(folder, "job"))
        assert answer.outcome.status in (0, 1), answer.outcome
        named = animal.named_in(answer.text)
        said = answer.text.strip()
        if answer.withheld:
            return Judged(animal, seed, None, None, named, said)
        interval = Interval.about(met.truth.left(answer), met.truth.promised(answer))
        return Judged(animal, seed, interval, met.truth.kept(answer), named, said)


def predicted(answer: Answer, header: str, rows: Iterable[Iterable[object]]) -> Array:
    """Return what the record says of poses, the mean along x, y, z, (p, 3) um."""
    path = answer.folder / "poses.csv"
    path.write_text(rows_of(header, rows), encoding="utf-8")
    poses = given("data", "predict", answer.folder / "campaign.axiscal", path, "--json").document["poses"]
    return np.array([pose["mean_um"] for pose in poses])


def rows_of(header: str, rows: Iterable[Iterable[object]]) -> str:
    """Return the text of a CSV file."""
    return "\n".join([header, *(",".join(str(cell) for cell in row) for row in rows)]) + "\n"
