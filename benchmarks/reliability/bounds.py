"""What a command refuses, keeps for itself, or has room for: the page's token, readings none of which counts, sizes."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import read_campaign
from axiscal.measurement.reading import Reading
from benchmarks.reliability.trial import Trial, scratch
from benchmarks.zoo.running import given, rows_of
from tests.generators.texts import campaign_text, setup_text
from tests.web.served import served, started

GIGABYTES, SECONDS = 2.0, 5
_OPEN, _GUARDED = ("/", "/elements.js", "/api/1/openapi.json"), ("/api/1/state", "/machine.svg", "/report.pdf")


def token() -> Trial:
    """Ask a page with its token in the head, when no answer may hold it or set a cookie, and with it in a cookie."""
    with scratch() as top, served(started(top)) as page:
        told = [page.ask("GET", path, Authorization=f"Bearer {page.token}") for path in (*_OPEN, *_GUARDED)]
        taken = [page.ask("GET", path, Cookie=f"axiscal-{page.port}={page.token}").status != 403 for path in _GUARDED]
    given_away = [page.token in f"{each.headers} {each.body!r}" or "set-cookie" in each.headers for each in told]
    what = "answers that hold the page's token, set a cookie, or take it from one"
    return Trial(what, len(told) + len(taken), sum([*given_away, *taken]))


def campaign_of(folder: Path, setups: int) -> Path:
    """Write the campaign of one axis under so many lasers."""
    named = (f"x{number}" for number in range(setups))
    lasers = (setup_text(name, "interferometer", direction="x", moves=["X"], approach="both") for name in named)
    path = folder / "campaign.toml"
    path.write_text(campaign_text("one-axis", *lasers, target={"U": "5 um"}, compensation_active=False))
    return path


def unused(count: int) -> Trial:
    """End a campaign each reading of which is a thousand times too large: no figure, status 1, and it says why."""
    with scratch() as top:
        described, record = read_campaign(campaign_of(top, 1)), top / "mill.axiscal"
        with Campaign.create(record, described) as campaign:
            campaign.adopt(tuple(Reading("x0", (0.04 * n,), (1,), 0.9 + 0.1 * n) for n in range(count)))
        ended = given("finish", record, "--out", top / "out")
    said = " ".join(ended.out.split())
    right = ended.status == 1 and f"NOT MEASURED {count} readings" in said and f"0 of {count} readings are used" in said
    return Trial("readings none of which is used, and a figure stands", count, count * (not right))


def sizes() -> Trial:
    """Estimate from files of many readings, and of many set-ups, each in a process of its own."""
    used = [_gigabytes(20_000, 1), _gigabytes(1000, 200)]
    detail = f"20,000 of one set-up {used[0]:.2f} GB, 1,000 of 200 {used[1]:.2f} GB; at most {GIGABYTES:.0f}"
    return Trial("readings by file", 21_000, sum(each > GIGABYTES for each in used), detail)


def seconds(setups: int) -> Trial:
    """Give each command a campaign of so many set-ups: processor time of a process of its own."""
    with scratch() as top:
        path, record, far = campaign_of(top, setups), top / "mill.axiscal", top / "far.toml"
        far.write_text(path.read_text().replace('"5 um"', '"0.01 um"'))
        plans = ("--readings", 40), ("--budget", "60 min"), ("--target", "4 um"), ()
        words = [*(("plan", path, *each) for each in plans), ("plan", far), ("step", "start", path, record)]
        words += [("step", "next", record), ("step", "record", record, "1 um")] * 2
        words += [("step", "status", record), ("step", "next", record), ("finish", record, "--out", top / "out")]
        spent = [_spent(each).ru_utime for each in words]
    what = f"commands under {setups} set-ups"
    slow = [f"{' '.join(map(str, each[:1] + each[2:]))} {time:.1f} s" for each, time in zip(words, spent, strict=True)]
    late = [said for said, time in zip(slow, spent, strict=True) if time > SECONDS]
    return Trial(what, len(spent), len(late), ", ".join([f"longest {max(spent):.1f} s, at most {SECONDS}", *late]))


def _spent(words: Sequence[object]) -> resource.struct_rusage:
    """Return what a command took."""
    command = [sys.executable, "-m", "axiscal", *map(str, words)]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        _, status, spent = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    assert process.returncode == 0, words
    return spent


def _gigabytes(readings: int, setups: int) -> float:
    """Return the memory that an estimate took."""
    chance = np.random.default_rng(1)
    x = np.round(np.sort(chance.uniform(0, 500, readings)), 3)
    shown = np.round(5 * np.sin(x / 80) + chance.normal(0, 0.3, readings), 2)
    rows = ((f"x{n % setups}", at, "X+", value) for n, (at, value) in enumerate(zip(x, shown, strict=True)))
    with scratch() as top:
        (top / "readings.csv").write_text(rows_of("setup,X_mm,approach,value_um", rows))
        words = ("data", "estimate", campaign_of(top, setups), top / "readings.csv", "--out", top / "out")
        return _spent(words).ru_maxrss / 1e6
