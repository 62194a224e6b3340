"""Directions that count: of a printer's bed the height alone, in RMS and U, in a plan, in files, in words."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.description.first_campaign import Purpose
from axiscal.description.first_files import first_files, of_builtin
from axiscal.estimation.accuracy.alignment import Alignment, sampled_moments
from axiscal.estimation.accuracy.expanded import expanded
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import estimated
from axiscal.estimation.estimation import Estimation
from axiscal.measurement.reading import Reading
from axiscal_core.points import even_points

_EVERY_LINE = 'directions = ["z"]'
_EVERY = "aligned = false"


def texts() -> tuple[str, str]:
    """Return campaign.toml and machine.toml as `init` writes them for the probe of a printer."""
    found = first_files(of_builtin("printer-gantry"), ["probe"], Purpose("30 um")).texts
    return found["campaign.toml"], found["machine.toml"]


def described(directions: str = _EVERY_LINE) -> CampaignDescription:
    campaign, machine = texts()
    assert _EVERY_LINE in campaign
    return campaign_from_texts(campaign.replace(_EVERY_LINE, directions), "campaign.toml", machine, "machine.toml")


@cache
def known(directions: str = _EVERY_LINE) -> Estimation:
    """Return what a grid of made-up heights makes known."""
    grid = [(x, y) for x in np.linspace(0.02, 0.28, 5) for y in np.linspace(0.02, 0.28, 5)]
    rng = np.random.default_rng(2)
    case = Case(described(directions))
    names = [axis.name for axis in case.description.machine.axes]
    poses = [tuple({"X": x, "Y": y}.get(name, 0.0) for name in names) for x, y in grid]
    return estimated(case, [Reading("probe", pose, (1, 1, 1), 60e-6 * rng.standard_normal()) for pose in poses])


def test_u_is_that_of_the_height_and_every_direction_keeps_its_own() -> None:
    """A distance along one direction is a ±: U in space is then U along z; what does not count is not called known."""
    found, whole = known(), known(_EVERY)
    alone = expanded(found.case.yardstick, found.knowledge.belief)
    every = expanded(whole.case.yardstick, found.knowledge.belief)
    assert alone.space == pytest.approx(alone.axes[2], rel=1e-6)
    assert alone.axes == pytest.approx(every.axes, rel=1e-12)
    assert alone.axes[0] > 3 * alone.axes[2]
    assert every.space > 3 * alone.space


def test_a_part_is_levelled_by_heights_alone() -> None:
    """Against a plane fitted to the heights of drawn machines by least squares."""
    errors, rng = known().case.errors, np.random.default_rng(4)
    low, high = np.array(known().case.yardstick.box).T
    poses = low + (high - low) * even_points(200, len(low))
    alignment = Alignment(errors, poses, (False, False, True))
    gram = sampled_moments(errors, poses, alignment, alignment.counted).gram
    drawn = errors.prior_root() @ rng.standard_normal(errors.size)
    for function in errors.functions:
        if function.kind == "reversal":
            drawn[function.columns] = 0.0
    deviations = errors.rows(poses, np.zeros_like(poses)) @ drawn
    names = [axis.name for axis in errors.machine.axes]
    plane = np.column_stack([np.ones(200), poses[:, names.index("X")], poses[:, names.index("Y")]])
    fitted = np.linalg.lstsq(plane, deviations[:, 2], rcond=None)[0]
    left = deviations[:, 2] - plane @ fitted
    assert drawn @ gram @ drawn == pytest.approx(float(np.mean(left**2)), rel=1e-6)
    np.testing.assert_allclose(alignment.left(poses, deviations)[:, 2], left, atol=1e-9)
