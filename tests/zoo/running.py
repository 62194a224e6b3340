"""The one way through the program: init, what a stranger changes, READINGS.csv, estimate, tables, judge."""

from __future__ import annotations

import io
import os
from collections.abc import Iterable
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from axiscal.cli.app import run
from tests.commands import Outcome
from tests.zoo.animals import Animal, Job, Judged
from tests.zoo.answers import Answer


def given(*words: object) -> Outcome:
    """Return what a command answers that is given in this process."""
    os.environ["AXISCAL_PROGRESS"] = "off"
    with redirect_stdout(io.StringIO()) as out, redirect_stderr(io.StringIO()) as err:
        status = run([str(word) for word in words])
    return Outcome(status, out.getvalue(), err.getvalue())


def described(job: Job, folder: Path) -> Path:
    """Return the campaign that `init` writes into a folder, with the lines that a stranger changes."""
    wanted = [word for name in job.instruments for word in ("--instrument", name)]
    _ = given("init", folder, "--machine", job.machine, *wanted, "--target", job.target).printed
    path = folder / "campaign.toml"
    text = path.read_text(encoding="utf-8")
    for old, new in (("", "compensation_active = false\n"), *job.stated):
        assert old in text, f"init does not write {old!r}"
        text = text.replace(old, new, 1)
    path.write_text(text, encoding="utf-8")
    return path


def answered(job: Job, readings: str, folder: Path) -> Answer:
    """Return what the program makes of readings in a folder of their own."""
    campaign = described(job, folder)
    path = folder / "readings.csv"
    path.write_text(readings, encoding="utf-8")
    return Answer(folder / "results", given("data", "estimate", campaign, path, "--out", folder / "results"))


def judged(animal: Animal, seed: int = 0) -> Judged:
    """Return what becomes of an animal."""
    met = animal.meet(seed)
    with TemporaryDirectory() as folder:
        answer = answered(animal.job, met.readings, Path(folder, "job"))
        assert answer.outcome.status in (0, 1), answer.outcome
        named = animal.named_in(answer.text)
        said = answer.text.strip()
        if answer.withheld:
            return Judged(animal, seed, None, None, None, None, named, True, said)
        left, U = np.abs(met.truth.left(answer)), met.truth.promised(answer)
        inside, far = float(np.mean(left <= U)), float(np.quantile(left, 0.95))
        return Judged(animal, seed, met.truth.kept(answer), inside, U, far, named, False, said)


def rows_of(header: str, rows: Iterable[Iterable[object]]) -> str:
    """Return the text of a CSV file."""
    return "\n".join([header, *(",".join(str(cell) for cell in row) for row in rows)]) + "\n"
