"""How campaigns end on random machines whose target can be reached."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.sources.source import SimulatedSource
from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.estimation.accuracy.expanded import expanded
from axiscal.estimation.case import Case
from axiscal.exceptions import SourceError
from axiscal.measurement.simulation import Simulator
from axiscal.planning.next_readings import placed
from axiscal.planning.plan.task import Limits
from axiscal.planning.promise import asked, foreseen
from axiscal.planning.proposal import proposed
from tests.generators.texts import setup_text

LEAST = 0.99
"""Share of the campaigns with a target that can be reached which end with it."""
_AXES = "XYZ"
_EASIER = 1.25
"""Times what a plan of half as many readings leaves is asked for: sizes are learnt, and need not be as stated."""
_LESS = 0.8
"""Of what is known before the first reading: a target has to ask for less."""
_BELOW = 0.75
"""Of the target: a floor that lies well below it."""


@dataclass(frozen=True, slots=True)
class Ending:
    """How a campaign ended.  reached : its target"""

    because: str
    readings: int
    reached: bool


def feasible(seed: int) -> Ending | None:
    """Return how a campaign ended of which a plan of a third as many readings as it may take reaches the target.

    None where the target is met before the first reading, or its floor is near it: sizes that are learnt raise both.
    """
    rng = np.random.default_rng(seed)
    described = _random(rng)
    case, count = Case(described), int(rng.integers(6, 31))
    made = proposed(case, Limits(count), 300).plan
    belief, before = foreseen(case, (), placed(case, made)).belief, case.yardstick.measure(case.prior)
    known, target = case.yardstick.measure(belief), replace(described.target, readings=3 * count + 10)
    match rng.choice(["rms", "rms", "worst", "U"]):
        case "rms":
            target, least = replace(target, rms=_EASIER * known.rms), before.rms
        case "worst":
            target, least = replace(target, worst=_EASIER * known.worst), before.worst
        case _:
            target = replace(target, expanded=_EASIER * expanded(case.yardstick, belief).space)
            least = expanded(case.yardstick, case.prior).space
    (only,) = asked(target, case.yardstick)
    if only.limit > _LESS * least or only.floor > _BELOW * only.limit:
        return None
    return _run(replace(described, target=target), seed)


def _run(described: CampaignDescription, seed: int) -> Ending:
    """Return how a simulated campaign ended."""
    truth = Simulator(described.machine, described.setups).drawn(seed)
    with TemporaryDirectory() as folder, Campaign.create(Path(folder) / "c.axiscal", described) as campaign:
        try:
            because = campaign.run(SimulatedSource(truth, seed), lambda _: None)
        except SourceError as failure:
            return Ending(failure.what, len(campaign.state.readings), reached=False)
        return Ending(because, len(campaign.state.readings), because.endswith("target reached"))


def _random(rng: np.random.Generator) -> CampaignDescription:
    """Return a machine of one to three linear axes with some of its errors, and a campaign with some set-ups."""
    axes = _AXES[: int(rng.integers(1, 4))]
    chain = "-".join(["w", "b", *axes, "t"])
    travels = "".join(f'[axes.{a}]\ntravel = ["0 mm", "{rng.integers(200, 1200)} mm"]\n' for a in axes)
    errors = [f"E{way}{axis}" for axis in axes for way in axes if way == axis or rng.random() < 0.5]
    rows = "".join(
        f'{name} = {{ std = "{rng.uniform(2, 20):.1f} um", knots = {rng.integers(4, 9)} }}\n' for name in errors
    )
    rows += "".join(
        f'E{a}{a}_reversal = {{ std = "{rng.uniform(1, 6):.1f} um" }}\n' for a in axes if rng.random() < 0.5
    )
    setups = [_laser(axis, rng) for axis in axes if axis == axes[0] or rng.random() < 0.8]
    if len(axes) > 1 and rng.random() < 0.5:
        setups.append(_BALL_BAR)
    text = 'machine = "m.toml"\n[target]\nreadings = 20\n' + "".join(setups)
    return campaign_from_texts(text, "c.toml", f'chain = "{chain}"\n{travels}[errors]\n{rows}', "m.toml")


def _laser(axis: str, rng: np.random.Generator) -> str:
    approach = "both" if rng.random() < 0.8 else "+"
    return (
        f'[[setups]]\nname = "laser {axis}"\ninstrument = "interferometer"\ndirection = "{axis.lower()}"\n'
        f'moves = ["{axis}"]\napproach = "{approach}"\nnoise = "{rng.uniform(0.2, 2.0):.2f} um"\n'
    )


_BALL_BAR = setup_text(
    "bar", "ballbar", length="80 mm", station=["100 mm", "100 mm", "0 mm"], plane="xy", approach="both"
)
