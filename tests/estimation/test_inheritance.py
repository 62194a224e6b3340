"""Last year's campaign as this year's prior: beliefs carried over, curves that have changed, words on sisters."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from axiscal.answers.changes import changes
from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import read_campaign
from axiscal.errors.model import ErrorModel
from axiscal.estimation.type_prior import carried_over
from axiscal.machine import machine_from_text
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.present.findings import findings

SETUP = '[[setups]]\nname = "laser"\ninstrument = "interferometer"\ndirection = "x"\n'
POSITIONS = np.linspace(0.02, 0.98, 15)


def _campaign(folder: Path, head: str = "") -> Path:
    path = folder / f"campaign{len(list(folder.iterdir()))}.toml"
    path.write_text(f'machine = "one-axis"\n{head}\n{SETUP}')
    return path


def _record(folder: Path, values: np.ndarray[tuple[int], np.dtype[np.float64]], head: str, name: str) -> Path:
    readings = [Reading("laser", (float(x),), (1,), float(v)) for x, v in zip(POSITIONS, values, strict=True)]
    path = folder / name
    with Campaign.create(path, read_campaign(_campaign(folder, head), target_needed=False)) as campaign:
        campaign.adopt(tuple(readings))
    return path


def _curve(size: float) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    noise = 0.3e-6 * np.random.default_rng(0).standard_normal(len(POSITIONS))
    return size * np.sin(5 * POSITIONS) + noise


def test_the_result_of_one_campaign_is_the_prior_of_the_next(tmp_path: Path) -> None:
    last = _record(tmp_path, _curve(8e-6), "", "last.axiscal")
    with Campaign.open(last) as campaign:
        old = campaign.estimate(ended=True)
    for kept in (1.0, 0.8):
        description = read_campaign(_campaign(tmp_path, f'prior = "last.axiscal"\nkept = {kept}'), target_needed=False)
        with Campaign.create(tmp_path / f"new{kept}.axiscal", description) as campaign:
            new, size, before = campaign.estimate(ended=True), old.case.errors.size, old.printed.belief
            rest = old.case.errors.functions[0].rest ** 2 * np.eye(size)
            rest[old.case.errors.names["EXX_reversal"].columns] = 0.0
            expected = kept**2 * (before.covariance[:size, :size] + rest)
            expected += (1 - kept**2) * old.stated.errors.prior_covariance()
            assert new.knowledge.belief.mean[:size] == pytest.approx(kept * before.mean[:size], abs=1e-12)
            assert np.abs(new.knowledge.belief.covariance[:size, :size] - expected).max() < 1e-17


def test_the_record_needs_no_other_file(tmp_path: Path) -> None:
    last = _record(tmp_path, _curve(8e-6), "", "last.axiscal")
    new = _record(tmp_path, _curve(8e-6), 'prior = "last.axiscal"', "new.axiscal")
    with Campaign.open(new) as campaign:
        before = campaign.estimate(ended=True).knowledge.belief.mean
    last.unlink()
    with Campaign.open(new) as campaign:
        assert campaign.estimate(ended=True).knowledge.belief.mean == pytest.approx(before)


def test_a_curve_that_has_changed_is_named_and_one_that_has_not_is_not(tmp_path: Path) -> None:
    _record(tmp_path, _curve(8e-6), "", "last.axiscal")
    for size, expected in ((8e-6, []), (-8e-6, ["EXX"])):
        path = _record(tmp_path, _curve(size), 'prior = "last.axiscal"', f"new{expected}.axiscal")
        with Campaign.open(path) as campaign:
            estimation = campaign.estimate(ended=True)
            assert [change.name for change in changes(estimation)] == expected
            said = [finding for finding in findings(estimation) if finding.code == "drift"]
            assert [finding.error for finding in said] == expected


TEXT = """
chain = "w-b-X-t"
[axes.X]
travel = ["0 mm", "400 mm"]
[errors]
EXX = {{ std = "10 um", length = "150 mm", knots = {knots}, rest = "{rest}" }}
"""
PITCH = 'EBX = {{ std = "{std}", length = "150 mm", knots = 4 }}\n'


def model(knots: int, more: str = "", rest: str = "0.5 um") -> ErrorModel:
    """Return the errors of one axis."""
    return ErrorModel(machine_from_text(TEXT.format(knots=knots, rest=rest) + more))


def curve(errors: ErrorModel, name: str, unknowns: Array, at: Array) -> Array:
    """Return a curve at positions."""
    function = errors.names[name]
    return np.asarray(function.basis.rows(at) @ unknowns[function.columns], dtype=float)


@pytest.mark.parametrize(("before", "today"), [(9, 5), (5, 9)])
def test_at_the_knots_of_today_the_curve_is_the_one_of_before(before: int, today: int) -> None:
    """Its rest is that of before; an error that is new is as stated and of nothing else."""
    old, new = model(before, rest="2 um"), model(today, PITCH.format(std="3 urad"))
    across, unknowns = carried_over(old, new), np.random.default_rng(2).standard_normal(old.size)
    knots, columns = new.names["EXX"].basis.control_positions, new.names["EXX"].columns
    taken = across.matrix @ unknowns
    assert taken[columns] == pytest.approx(curve(old, "EXX", unknowns, knots))
    assert not taken[new.names["EBX"].columns].any()
    assert across.rests[columns] == pytest.approx((2e-6) ** 2, abs=0)
    assert not across.rests[new.names["EBX"].columns].any()
    assert across.known == {"EXX"}
    found = across.prior(unknowns, np.eye(old.size), np.zeros((new.size, new.size)))
    own = new.names["EBX"].columns
    assert found.covariance[own, own] == pytest.approx(new.prior_covariance()[own, own], abs=1e-20)
    assert not found.covariance[own, columns].any()


def test_what_finer_knots_hold_beyond_those_of_before_is_the_part_that_they_cannot_reach() -> None:
    old, new = model(4), model(9, PITCH.format(std="3 urad"))
    across = carried_over(old, new)
    columns, beyond = new.names["EXX"].columns, across.beyond()
    held = across.matrix[columns]
    left = np.eye(9) - held @ np.linalg.inv(held.T @ held) @ held.T
    prior = new.prior_covariance()[columns, columns]
    expected = np.zeros((new.size, new.size))
    expected[columns, columns] = left @ prior @ left.T
    assert np.abs(beyond @ beyond.T - expected).max() < 1e-10 * prior.max()
    assert np.abs(held.T @ beyond[columns]).max() < 1e-9 * np.sqrt(prior.max())
    assert np.trace(expected) > 1e-3 * np.trace(prior)
    assert carried_over(new, old).beyond().shape[1] == 0
