"""The engine of studies: 600 cases here and in two processes of which one is killed; a head that is killed, resumed.

Two readings a case: it takes hundredths of a second, so that the head has most to do.

python -m benchmarks.study          # minutes; --machines 5 a few seconds
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import signal
import subprocess
import sys
import time
from collections.abc import Generator, Iterable
from pathlib import Path
from tempfile import TemporaryDirectory

from axiscal.campaign.possible import versions
from axiscal.ports.study.results import FILE, Processes, Results, run_missing
from axiscal.ports.study.study_case import Done, Engine, Solve, WorkItem, here, outcome
from axiscal.ports.study.study_file import Study, read_study
from tests.ports.texts import CAMPAIGN

_STUDY = """[study]
campaign = "campaign.toml"
machines = {machines}
stop = {{ readings = 2 }}
[grid]
setups = [["dial"], ["laser"], ["dial", "laser"]]
"""


def described(folder: Path, machines: int) -> Study:
    """Return a study of three ways of measuring one axis."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "campaign.toml").write_text(CAMPAIGN)
    (folder / "study.toml").write_text(_STUDY.format(machines=machines))
    return read_study(folder / "study.toml")


def worked(study: Study, folder: Path, engine: Engine, kill: int = 0) -> tuple[dict[str, Done], float, float]:
    """Return all results, and seconds of wall and of this process.  kill : after so many cases, one worker"""

    def killing(solve: Solve, questions: Iterable[WorkItem]) -> Generator[Done]:
        for done, found in enumerate(engine(solve, questions), start=1):
            yield found
            if done == kill:
                os.kill(multiprocessing.active_children()[0].pid or 0, signal.SIGKILL)

    wall, own = time.monotonic(), time.process_time()
    with Results(folder, study.text, study.digest, versions(), resume=False) as results:
        items = (WorkItem(case.key, case) for case in study.cases())
        run_missing(results, items, study.count, outcome, killing)
        return results.found, time.monotonic() - wall, time.process_time() - own


def head_killed(folder: Path, machines: int, alone: dict[str, Done]) -> str:
    """Return what became of a command that is killed after a third of its cases, and resumed."""
    study = described(folder, machines)
    command = [sys.executable, "-m", "axiscal.cli", "study", str(study.source), "--out", str(folder / "out")]
    head = subprocess.Popen([*command, "--workers", "2"], stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    while _kept(folder / "out") < study.count // 3:
        time.sleep(0.1)
    head.send_signal(signal.SIGKILL)
    head.wait()
    with Results(folder / "out", study.text, study.digest, versions(), resume=True) as results:
        items = (WorkItem(case.key, case) for case in study.cases())
        ran = run_missing(results, items, study.count, outcome, Processes(2))
        same = all(alone[key] == done for key, done in results.found.items())
    return f"{ran.there} of {study.count} kept, {ran.computed} computed, {'equal' if same else 'NOT EQUAL'} to serial"


def _kept(folder: Path) -> int:
    file = folder / FILE
    return file.read_bytes().count(b"\n") - 1 if file.exists() else 0


def main() -> None:
    """Print what is measured."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.study", description=__doc__)
    parser.add_argument("--machines", type=int, default=200)
    machines = parser.parse_args().machines
    with TemporaryDirectory() as name:
        folder = Path(name)
        study = described(folder, machines)
        alone, wall, own = worked(study, folder / "one", here)
        print(f"{study.count} cases in this process: {own:.1f} s of processor time, {wall:.0f} s of wall", flush=True)
        killed, wall, own = worked(study, folder / "two", Processes(2), kill=study.count // 2)
        same = "equal to serial" if killed == alone else "NOT EQUAL to serial"
        print(f"two processes, one killed half way: {len(killed)} results, {same}, {wall:.0f} s of wall")
        print(f"head: {1000 * own / study.count:.1f} ms of processor time for each case", flush=True)
        print(f"head killed: {head_killed(folder / 'three', max(2, machines // 10), alone)}")


if __name__ == "__main__":
    main()
