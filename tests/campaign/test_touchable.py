"""What is planned can be touched: on random machines, near the ends of their travels, by a control that goes there."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from axiscal.campaign.sources.source import Answer, Request, Skip
from axiscal.description.campaign import CampaignDescription
from axiscal.exceptions import DescriptionError, SourceError
from axiscal.measurement.candidates import chart_candidates
from axiscal.measurement.touched import cycle_of, met_from
from axiscal.ports.linuxcnc.live import InForce, LiveSource
from tests.generators.touching_machines import CHAINS, Control, described

FEW = 10
"""Seeds tried: on two machines of three both balls can be touched."""
MOVED = np.array([0.4e-3, -0.3e-3, 0.2e-3])
"""m: by how much a ball stands beside where it is stated."""


def known(seed: int) -> CampaignDescription | None:
    """Return a random campaign, None where one of its balls cannot be touched."""
    try:
        return described(seed)
    except DescriptionError:
        return None


def attached(campaign: CampaignDescription, control: Control) -> LiveSource:
    line: Any = control
    source = LiveSource(line, campaign.machine, InForce(), asked=lambda _: "go")
    if (artefact := campaign.setups[0].artefact) is not None:
        source._placed = artefact.standing
    return source


def made(campaign: CampaignDescription) -> Control:
    (setup,) = campaign.setups
    assert setup.artefact is not None
    return Control(campaign.machine, setup.artefact.points + MOVED, cycle_of(campaign.machine, setup).radius)


def wanted(campaign: CampaignDescription, count: int) -> list[Request]:
    (setup,) = campaign.setups
    assert setup.chart is not None
    poses, approaches = chart_candidates(campaign.machine, setup, setup.chart, count)
    rows = zip(poses.tolist(), approaches.astype(int).tolist(), strict=True)
    return [Request(n, setup, campaign.machine.axes, tuple(p), tuple(a)) for n, (p, a) in enumerate(rows, 1)]


def touched(seeds: range) -> int:
    """Read candidates of machines that can be touched; returns how many a straight way led to."""
    count = 0
    for campaign in filter(None, map(known, seeds)):
        source = attached(campaign, made(campaign))
        for request in wanted(campaign, 6):
            answer = source.read(request)
            if isinstance(answer, Skip) and "leads into" in answer.reason:  # straight from the place before
                continue
            assert isinstance(answer, Answer), (campaign.machine.chain, answer)
            np.testing.assert_allclose((answer.value, *answer.others), -MOVED, atol=2e-8)
            count += 1
    return count


@pytest.mark.parametrize("chain", range(0, len(CHAINS), 2), ids=CHAINS[::2])
def test_every_candidate_is_touched(chain: int) -> None:
    assert touched(range(chain, FEW, len(CHAINS))) >= 4


def narrowed(campaign: CampaignDescription) -> CampaignDescription:
    """Return the campaign on a machine whose X ends before some of the candidates; no plan of before knows it."""
    at = campaign.machine.index("X")
    end = float(np.quantile([request.pose[at] for request in wanted(campaign, 60)], 0.1))
    axes = (replace(a, travel=(end, a.travel[1])) if k == at else a for k, a in enumerate(campaign.machine.axes))
    return replace(campaign, machine=replace(campaign.machine, axes=tuple(axes)))


def test_what_cannot_be_touched_is_skipped_before_anything_moves() -> None:
    campaign = narrowed(described(1))
    control = made(campaign)
    source = attached(campaign, control)
    skipped = list[bool]()
    for request in wanted(described(1), 12):
        before = len(control.lines)
        answer = source.read(request)
        skipped.append(isinstance(answer, Skip))
        if isinstance(answer, Skip):
            assert "X" in answer.reason or "leads into" in answer.reason
            assert len(control.lines) == before
    assert not control.stopped
    assert any(skipped)
    assert not all(skipped)


AMISS = {
    "the probe met nothing": ("deaf", 0.0, 0.0),
    "the probe is closed": ("stuck", 0.0, 0.0),
    "from where the ball is stated": ("sound", 0.0, 3.5e-3),
    "beside the ball of reading 2 the probe met something": ("sound", 5e-3, 0.0),
}
"""How the probe is, and m by which the plate was moved between two placements: to the first side, and up."""


@pytest.mark.parametrize("why", AMISS)
def test_what_a_person_has_to_look_at_ends_the_run_with_a_sentence(why: str) -> None:
    campaign, (probe, aside, up) = described(15), AMISS[why]
    control = made(campaign)
    source, (first, second) = attached(campaign, control), wanted(campaign, 2)
    assert isinstance(source.read(first), Answer)
    pole, side, *_ = met_from(campaign.machine, np.array(second.pose))
    control.probe, control.balls = probe, control.balls + aside * side + up * pole
    with pytest.raises(SourceError, match=why):
        source.read(second)
    assert control.stopped
