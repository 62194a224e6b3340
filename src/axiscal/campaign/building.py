"""The engine that a campaign has unless it is given another."""

from __future__ import annotations

from typing import TYPE_CHECKING

from axiscal.campaign.engine import Engine
from axiscal.description.campaign import CampaignDescription

if TYPE_CHECKING:
    from axiscal.estimate.calibration import Calibration


def build(description: CampaignDescription) -> Engine:
    """Return the engine of a campaign; what it needs is loaded when it is first asked."""
    from axiscal.estimate.inheritance import problem_of
    from axiscal.planning.planner import Planner

    return Planner(problem_of(description))


def calibration_of(engine: Engine) -> Calibration:
    """Return the calibration behind a campaign, concluded from all its readings; raises TypeError for a foreign one."""
    from axiscal.estimate.calibration import Calibration

    if not isinstance(engine, Calibration):
        raise TypeError(f"{type(engine).__name__} is not a Calibration")
    return engine.concluded()
