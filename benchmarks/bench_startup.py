"""How long a person waits for the program: its start, and the next question on the five-axis machine.

    python benchmarks/bench_startup.py

Prints the fastest of ten runs of whole processes, as a shell would see them, and the least processor time.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage

PROGRAM = Path(sys.executable).parent / "axiscal"
CAMPAIGN = """
machine = "dmu60"
[target]
readings = 30
[[setups]]
name = "probe"
instrument = "probe"
direction = "y"
moves = ["X", "Y", "Z"]
reach = { X = ["-300 mm", "300 mm"], Y = ["-250 mm", "250 mm"], Z = ["0 mm", "500 mm"] }
approach = "both"
"""


def seconds(*arguments: str) -> tuple[float, float]:
    """Return wall and processor time of one run of the program, compiled once as wherever it is installed."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    start, before = time.perf_counter(), _processor()
    subprocess.run([str(PROGRAM), *arguments], check=True, capture_output=True, env=environment)
    return time.perf_counter() - start, _processor() - before


def _processor() -> float:
    used = getrusage(RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def next_seconds(folder: Path, readings: int) -> list[tuple[float, float]]:
    """Return the times of `axiscal next` before each of some readings of a campaign with a person."""
    campaign, record = folder / "campaign.toml", str(folder / "five.axiscal")
    campaign.write_text(CAMPAIGN)
    seconds("start", str(campaign), record)
    times = []
    for _ in range(readings):
        times.append(seconds("next", record))
        seconds("record", record, "1 um")
    return times


def _shown(name: str, times: list[tuple[float, float]]) -> str:
    wall, processor = map(min, zip(*times, strict=True))
    return f"{name}: {wall:.3f} s, {processor:.3f} s of processor time"


if __name__ == "__main__":
    for arguments in (["--version"], ["--help"]):
        print(_shown(f"axiscal {' '.join(arguments)}", [seconds(*arguments) for _ in range(10)]))
    with tempfile.TemporaryDirectory() as folder:
        print(_shown("axiscal next, five-axis machine", next_seconds(Path(folder), 10)))
