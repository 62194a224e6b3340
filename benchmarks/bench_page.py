"""From Enter on the operator's page to the next point, on the five-axis machine of the demo, up to 60 readings.

    python benchmarks/bench_page.py

Prints median and longest, of wall and of processor time: the second holds on a busy computer. The page and its network
take milliseconds more (one request on the same computer).
"""

from __future__ import annotations

import re
import statistics
import tempfile
import time
from importlib import resources
from pathlib import Path

from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import campaign_from_texts
from axiscal.machine import load_machine
from axiscal.web.desk import Desk
from axiscal_core.threads import one_thread

READINGS = 62


def opened(folder: Path) -> Campaign:
    """Return the demo's campaign with so many readings as its only target, begun in a folder."""
    text = resources.files("axiscal.present.demo").joinpath("campaign.toml").read_text(encoding="utf-8")
    counted = re.sub(r"(?m)^readings = .*$", f"readings = {READINGS}", re.sub(r"(?m)^rms = .*$", "", text))
    described = campaign_from_texts(counted, "demo", load_machine("dmu60").text, "dmu60")
    return Campaign.create(folder / "page.axiscal", described)


@one_thread()
def times() -> list[tuple[float, float]]:
    """Return wall and processor seconds from each Enter to the next question."""
    found = []
    with tempfile.TemporaryDirectory() as folder, opened(Path(folder)) as campaign:
        desk = Desk(campaign, lambda: None)
        while (question := desk.state.question) is not None:
            typed = " ".join(f"{expected.mean + 0.2 * expected.half:.2f}" for expected in question.expected)
            wall, processor = time.perf_counter(), time.process_time()
            desk.keep(typed, cause="keep")
            found.append((time.perf_counter() - wall, time.process_time() - processor))
            desk.think()
    return found


def main() -> None:
    """Print the table."""
    found = times()
    for name, part in (("readings 1 to 30", found[:30]), ("readings 31 to 60", found[30:60])):
        wall, processor = zip(*part, strict=True)
        print(f"{name}: wall {statistics.median(wall):.2f} s, at most {max(wall):.2f} s; ", end="")
        print(f"processor {statistics.median(processor):.2f} s, at most {max(processor):.2f} s   (asked: 1 s)")


if __name__ == "__main__":
    main()
