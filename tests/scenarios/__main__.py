"""`python -m tests.scenarios`: play the campaigns, or compare what they gave; see `tests.scenarios`."""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from collections import Counter
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage

from tests.scenarios.comparing import differences
from tests.scenarios.playing import Outcome, environment, played
from tests.scenarios.scenario import names, scenario
from tests.scenarios.writing import MASKED, write

SHOWN = 5
"""Differences shown of one file."""


def main() -> int:
    """Return the exit status: 0 done or equal, 1 refused or different."""
    parser = argparse.ArgumentParser(prog="python -m tests.scenarios", description=__doc__)
    todo = parser.add_mutually_exclusive_group(required=True)
    todo.add_argument("--out", type=Path, metavar="DIR", help="play the campaigns and write what they give")
    todo.add_argument("--compare", type=Path, nargs=2, metavar="DIR", help="say what differs between two such folders")
    parser.add_argument("--only", action="append", choices=names(), help="this campaign; repeatable")
    parser.add_argument("--tolerance", type=float, default=0.0, help="relative; 0 (the default): to the last digit")
    given = parser.parse_args()
    chosen = given.only or names()
    if given.compare is None:
        return _play(given.out, chosen)
    first, second = given.compare
    return _compare(first, second, chosen, given.tolerance)


def _play(out: Path, chosen: list[str]) -> int:
    taken = [name for name in chosen if (out / name).exists()]
    if taken:
        _print(f"{out} holds {', '.join(taken)} already: name another folder")
        return 1
    sources = os.environ.get("PYTHONPATH", "")
    _print(f"sources: {_package(sources)}")
    bad = sum(_played(name, out / name, sources) for name in chosen)
    (out / "MASKED.txt").write_text(MASKED, encoding="utf-8")
    return min(bad, 1)


def _played(name: str, folder: Path, sources: str) -> int:
    """Play one campaign and return how many of its commands ended otherwise than its page says."""
    begin = getrusage(RUSAGE_CHILDREN).ru_utime
    outcome = played(scenario(name), sources)
    write(outcome, folder)
    _print(f"{name:12} {len(outcome.said):3} commands {getrusage(RUSAGE_CHILDREN).ru_utime - begin:6.1f} s")
    return _astonishing(outcome)


def _astonishing(outcome: Outcome) -> int:
    bad = [said for said in outcome.said if not said.as_expected]
    for said in bad:
        _print(f"  {' '.join(said.command.words)}: status {said.status}: {said.err.strip()[-300:]}")
    return len(bad)


def _package(sources: str) -> str:
    """Return where the package that is run lies."""
    command = [sys.executable, "-P", "-c", "import axiscal; print(axiscal.__file__)"]
    return subprocess.run(command, env=environment(sources), capture_output=True, text=True, check=True).stdout.strip()


def _compare(first: Path, second: Path, chosen: list[str], tolerance: float) -> int:
    there = [name for name in chosen if (first / name).is_dir() or (second / name).is_dir()]
    found = [(name, each) for name in there for each in differences(first / name, second / name, tolerance)]
    files = Counter((name, difference.file) for name, difference in found)
    _print(MASKED.strip())
    for (name, file), count in files.items():
        shown = [str(each) for campaign, each in found if (campaign, each.file) == (name, file)][:SHOWN]
        _print("\n".join(f"{name}/{line}" for line in shown))
        if count > SHOWN:
            _print(f"{name}/{file}: and {count - SHOWN} more")
    _print(f"{len(there)} campaigns compared, {len(found) or 'no'} differences in {len(files)} files")
    return 0 if there and not found else 1


def _print(text: str) -> None:
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main())
