"""How long the rest of a plan takes to be renewed while the five-axis machine of the demo is measured.

    python benchmarks/bench_replan.py

Prints medians over the readings of the demo's campaign: processor time from a reading to the next question while the
plan stands, and while it does not because the reading is not believed; and what the machine takes to the next point.
"""

from __future__ import annotations

import statistics
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.sources.source import SimulatedSource
from axiscal.estimation.case import Case
from axiscal.machine.motion import travel_seconds
from axiscal.planning.next_readings import next_places
from axiscal.present.demo import SEED, description, hidden_machine
from axiscal.record.events import Asked
from axiscal_core.threads import one_thread


def steps(campaign: Campaign, source: SimulatedSource) -> Iterator[tuple[float, float, float, float]]:
    """Yield for each reading: processor seconds of the next question, and of renewing its plan; way, whole visit."""
    machine = campaign.description.machine
    asked = campaign.next()
    while isinstance(asked, Asked):
        answer = source.read(campaign.request(asked))
        campaign.record(answer.value, answer.std, others=answer.others)
        before, begun = asked, time.process_time()
        asked, taken = campaign.next(), time.process_time() - begun
        if isinstance(asked, Asked) and asked.place.setup == before.place.setup:
            begun = time.process_time()
            known = campaign.estimate()
            next_places(known.case, known.knowledge, known.readings, known.outliers, (), campaign.state.plan)
            renewed = time.process_time() - begun
            way = float(travel_seconds(machine, np.array(before.place.pose), np.array(asked.place.pose)))
            setup = campaign.description.setup(asked.place.setup)
            yield taken, renewed, way, way + setup.settle + setup.reading_time


def main() -> None:
    """Print the figures."""
    problem = Case(description())
    with (
        tempfile.TemporaryDirectory() as folder,
        Campaign.create(Path(folder) / "demo.axiscal", problem.description) as campaign,
    ):
        found = list(steps(campaign, SimulatedSource(hidden_machine(problem), SEED)))
    names = (
        "next question, the plan stands",
        "next question, the plan is renewed",
        "way to the next point",
        "whole visit",
    )
    print(f"five-axis machine of the demo, median of {len(found)} readings")
    for name, times in zip(names, zip(*found, strict=True), strict=True):
        print(f"{name:36} {statistics.median(times):6.3f} s   at most {max(times):6.3f} s")


if __name__ == "__main__":
    with one_thread():
        main()
