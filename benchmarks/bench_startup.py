"""How long a person waits for the program: its start, and the next question on the five-axis machine.

    python benchmarks/bench_startup.py

Prints the fastest of ten runs of whole processes, as a shell would see them.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from pathlib import Path

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


def seconds(*arguments: str) -> float:
    """Return the wall time of one run of the program."""
    start = time.perf_counter()
    subprocess.run([str(PROGRAM), *arguments], check=True, capture_output=True)
    return time.perf_counter() - start


def next_seconds(folder: Path, readings: int) -> list[float]:
    """Return the time of `axiscal next` before each of some readings of a campaign with a person."""
    campaign, record = folder / "campaign.toml", str(folder / "five.axiscal")
    campaign.write_text(CAMPAIGN)
    seconds("start", str(campaign), record)
    times = []
    for _ in range(readings):
        times.append(seconds("next", record))
        seconds("record", record, "1 um")
    return times


if __name__ == "__main__":
    for arguments in (["--version"], ["--help"]):
        print(f"axiscal {' '.join(arguments)}: {min(seconds(*arguments) for _ in range(10)):.3f} s")
    with tempfile.TemporaryDirectory() as folder:
        print(f"axiscal next, five-axis machine: {min(next_seconds(Path(folder), 10)):.3f} s")
