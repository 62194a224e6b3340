"""Last year's campaign as this year's prior: beliefs carried over, curves that have changed."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import CampaignDescription, read_campaign
from axiscal.estimation.inheritance import carried_over
from axiscal.machine import machine_from_text
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal_core.machine import Machine
from axiscal_core.normal import Normal
from tests.generators.recorded import write_record
from tests.generators.texts import Said, Std, campaign_text, machine_text, setup_text

POSITIONS = np.linspace(0.02, 0.98, 15)


def _described(folder: Path, **first: Said) -> CampaignDescription:
    """Return a campaign of a laser in a folder.  first : keys at its top"""
    laser = setup_text("laser", "interferometer", direction="x")
    (folder / "campaign.toml").write_text(campaign_text("one-axis", laser, target=None, **first))
    return read_campaign(folder / "campaign.toml", target_needed=False)


def _record(folder: Path, name: str, size: float, **first: Said) -> Path:
    """Return the record of a sine of a size, m."""
    values = size * np.sin(5 * POSITIONS) + 0.3e-6 * np.random.default_rng(0).standard_normal(len(POSITIONS))
    readings = [Reading("laser", (float(x),), (1,), float(v)) for x, v in zip(POSITIONS, values, strict=True)]
    return write_record(folder / name, _described(folder, **first), readings)


def test_the_result_of_one_campaign_is_the_prior_of_the_next_which_needs_no_other_file(tmp_path: Path) -> None:
    last, news = _record(tmp_path, "last.axiscal", 8e-6), dict[float, Path]()
    for kept in (1.0, 0.8):
        described = _described(tmp_path, prior="last.axiscal", kept=kept)
        news[kept] = write_record(tmp_path / f"new{kept}.axiscal", described, [])
    with Campaign.open(last) as campaign:
        old = campaign.estimate(ended=True)
    last.unlink()
    for kept, file in news.items():
        with Campaign.open(file) as campaign:
            new, size, before = campaign.estimate(ended=True), old.case.errors.size, old.printed.belief
        rest = old.case.errors.curves[0].rest ** 2 * np.eye(size)
        rest[old.case.errors.by_name["EXX_reversal"].columns] = 0.0
        expected = kept**2 * (before.covariance[:size, :size] + rest)
        expected += (1 - kept**2) * old.stated.errors.covariance()
        assert new.knowledge.belief.mean[:size] == pytest.approx(kept * before.mean[:size], abs=1e-12)
        assert np.abs(new.knowledge.belief.covariance[:size, :size] - expected).max() < 1e-17


NOTHING: Mapping[str, Std] = {}
PITCH: Mapping[str, Std] = {"EBX": ("3 urad", 4, 150)}


def model(knots: int, more: Mapping[str, Std] = NOTHING, rest: str = "0.5 um") -> Machine:
    """Return the errors of one axis."""
    own = f'std = "10 um", length = "150 mm", knots = {knots}, rest = "{rest}"'
    return machine_from_text(machine_text("w-b-X-t", {"X": (0, 400)}, {"EXX": own, **more}))


def curve(errors: Machine, name: str, unknowns: Array, at: Array) -> Array:
    """Return a curve at positions."""
    function = errors.by_name[name]
    return np.asarray(function.spline.rows(at) @ unknowns[function.columns], dtype=float)


@pytest.mark.parametrize(("before", "today"), [(9, 5), (5, 9)])
def test_at_the_knots_of_today_the_curve_is_the_one_of_before(before: int, today: int) -> None:
    """Its rest is that of before; an error that is new is as stated and of nothing else."""
    old, new = model(before, rest="2 um"), model(today, PITCH)
    unknowns, own = np.random.default_rng(2).standard_normal(old.size), new.by_name["EBX"].columns
    knots, columns = new.by_name["EXX"].spline.control_positions, new.by_name["EXX"].columns
    found = carried_over(Normal.of_factor(unknowns, np.zeros((old.size, 1))), old, new)
    assert found.mean[columns] == pytest.approx(curve(old, "EXX", unknowns, knots))
    assert not found.mean[own].any()
    assert found.covariance[own, own] == pytest.approx(new.covariance()[own, own], abs=1e-20)
    assert not found.covariance[own, columns].any()
    if today < before:
        assert found.covariance[columns, columns] == pytest.approx((2e-6) ** 2 * np.eye(today), abs=1e-20)


def test_what_finer_knots_hold_beyond_those_of_before_is_the_part_that_they_cannot_reach() -> None:
    old, new = model(4, rest="1e-06 um"), model(9, PITCH)
    columns, held = new.by_name["EXX"].columns, new.by_name["EXX"].taken_from(old.by_name["EXX"])
    left = np.eye(9) - held @ np.linalg.inv(held.T @ held) @ held.T
    prior = new.covariance()[columns, columns]
    found = carried_over(Normal.of_factor(np.zeros(old.size), np.zeros((old.size, 1))), old, new)
    assert np.abs(found.covariance[columns, columns] - left @ prior @ left.T).max() < 1e-10 * prior.max()
    assert np.abs(held.T @ found.covariance[columns, columns] @ held).max() < 1e-9 * prior.max()
    assert np.trace(found.covariance[columns, columns]) > 1e-3 * np.trace(prior)
