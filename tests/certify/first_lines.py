"""First lines of last screens: on random one-axis machines, what they say beside the simulated truth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from axiscal.answers.answer import ResultAnswer
from axiscal.answers.answer_of_campaign import standing_answer
from axiscal.answers.answer_words import screen
from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.estimation.accuracy.expanded import expanded
from axiscal.estimation.case import Case
from axiscal.estimation.machine_estimate import Estimate
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator
from axiscal.planning.promise import asked, foreseen
from axiscal.tables.offer import places
from axiscal.tables.surface import Deviation, rms

SHARE = 0.95
"""Of the first lines that the simulated truth has to bear out."""
KINDS = ("reached", "more", "unreachable", "contradict")
VERDICTS = {
    "TARGET REACHED": "reached",
    "CANNOT BE REACHED": "unreachable",
    "READINGS CONTRADICT": "contradict",
    "MORE READING": "more",
}
_MOST, _LATER = 160, 10
"""Readings of a campaign; those after "cannot be reached"."""
_EASIER, _INCH = 1.3, 25.4
"""Times what a plan promises is wanted; what the display shows too much from the middle of readings that contradict."""


@dataclass(frozen=True, slots=True)
class Told:
    """What was played, the first line that came, what it says, and whether that is so."""

    kind: str
    line: str
    verdict: str
    right: bool


def told(seed: int) -> Told:
    """Return the first line of one random campaign beside the truth."""
    rng = np.random.default_rng(seed)
    kind, described, count = KINDS[seed % len(KINDS)], _random(rng), int(rng.integers(8, 25))
    case = Case(described)
    truth = Simulator(described.machine, described.setups).drawn(seed)
    along = (0.5 + 0.618034 * np.arange(_MOST)) % 1.0 * case.yardstick.box[0][1]
    places = [((float(x),), (1 if n % 4 < 2 else -1,)) for n, x in enumerate(along)]
    values = [truth.read_all(described.setups[0], *at, rng)[0] for at in places]
    pairs = enumerate(zip(places, values, strict=True))
    readings = [Reading("laser", *at, value, time=60.0 * n) for n, (at, value) in pairs]
    planned = foreseen(case, (), [each.place for each in readings[:count]])
    limit = _EASIER * expanded(case.yardstick, planned.belief).space
    wanted = replace(described.target, expanded=limit)
    if kind == "unreachable":
        limit = rng.uniform(0.6, 0.9) * asked(wanted, case.yardstick)[0].floor
    if kind == "contradict":
        readings = [
            replace(each, value=each.value * (1 if 2 * n < count else _INCH)) for n, each in enumerate(readings)
        ]
    described = replace(described, target=replace(wanted, expanded=limit))
    taken = count // 2 if kind == "more" else count
    line, answer, left = _played(described, readings[:taken], truth.deviation)
    verdict = next(code for words, code in VERDICTS.items() if words in line)
    if verdict == "reached":
        right = left <= limit
    elif verdict == "more":
        further = _played(described, readings[: taken + 2 * answer.more + 4], truth.deviation)[1]
        right = answer.more > 0 and further.verdict == "reached"
    elif verdict == "unreachable":
        further = _played(described, readings[: taken + _LATER], truth.deviation)[1]
        right = kind != "contradict" and further.verdict != "reached"
    else:
        right = kind == "contradict"
    return Told(kind, line, verdict, right)


def _played(
    described: CampaignDescription, readings: Sequence[Reading], truth: Deviation
) -> tuple[str, ResultAnswer, float]:
    """Return the first line of the last screen, its document, and the true error left by the estimate, RMS, m."""
    with TemporaryDirectory() as folder, Campaign.create(Path(folder) / "c.axiscal", described) as campaign:
        campaign.adopt(tuple(readings))
        campaign.finish()
        answer, known = standing_answer(campaign), campaign.so_far()
        line = screen(answer, "", "c.axiscal", "results").splitlines()[0]
        return line, answer, _missed(known.estimate(), truth)


def _missed(estimate: Estimate, truth: Deviation) -> float:
    """Return the RMS over the volume of the true deviation less the estimated one, m, the motion of the part off."""
    poses, sides = places(estimate)
    missed = truth(poses, sides) - estimate.deviation(poses, sides)
    left = missed if estimate.alignment is None else estimate.alignment.left(poses, missed)
    return rms(left, estimate.counted)


def _random(rng: np.random.Generator) -> CampaignDescription:
    """Return one axis with errors of random sizes, and a laser along it."""
    travel, size, length = rng.uniform(300, 1500), rng.uniform(3, 20), rng.uniform(0.15, 0.5)
    machine = f"""chain = "w-b-X-t"
[axes.X]
travel = ["0 mm", "{travel:.0f} mm"]
[errors]
EXX = {{ std = "{size:.1f} um", length = "{length * travel:.0f} mm", rest = "{size / 30:.2f} um" }}
EXX_reversal = {{ std = "{rng.uniform(1, 6):.1f} um" }}
"""
    campaign = f"""machine = "m.toml"
[target]
U = "1 um"
[[setups]]
name = "laser"
instrument = "interferometer"
direction = "x"
noise = "{rng.uniform(0.2, 1.5):.2f} um"
approach = "both"
drift = "0 um/h"
"""
    return campaign_from_texts(campaign, "c.toml", machine, "m.toml")
