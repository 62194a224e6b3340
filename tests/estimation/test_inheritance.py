"""Last year's campaign as this year's prior, and the curves that have changed since."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import read_campaign
from axiscal.estimation.inheritance import changes
from axiscal.exceptions import DescriptionError, RecordError
from axiscal.measurement.reading import Reading
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
    result: np.ndarray[tuple[int], np.dtype[np.float64]] = size * np.sin(5 * POSITIONS) + noise
    return result


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


def test_a_prior_that_is_no_campaign_is_refused(tmp_path: Path) -> None:
    with pytest.raises(RecordError):
        read_campaign(_campaign(tmp_path, 'prior = "nothing.axiscal"'), target_needed=False)
    _record(tmp_path, _curve(8e-6), "", "last.axiscal")
    with pytest.raises(DescriptionError):
        read_campaign(_campaign(tmp_path, 'prior = "last.axiscal"\nkept = 1.5'), target_needed=False)


@pytest.mark.long
def test_an_inherited_prior_stays_where_noises_and_rests_are_learnt(tmp_path: Path) -> None:
    _record(tmp_path, _curve(8e-6), "", "last.axiscal")
    rng, found = np.random.default_rng(5), {}
    noisy = [_curve(8e-6) + 1.5e-6 * rng.standard_normal(len(POSITIONS)) for _ in range(3)]  # repeats show the noise
    heads = {"stated": '\nusual = "off"\nsure = "exactly"', "learnt": ""}
    for name, head in heads.items():
        path = _record(tmp_path, noisy[0], f'prior = "last.axiscal"{head}', f"{name}.axiscal")
        with Campaign.open(path) as campaign:
            for values in noisy[1:]:
                campaign.adopt(
                    tuple(replace(r, value=v) for r, v in zip(campaign.state.readings, values, strict=False))
                )
            found[name] = campaign.estimate(ended=True)
    stated, learnt = found["stated"], found["learnt"]
    size = stated.case.errors.size
    assert stated.stated.sizes.of == ()
    assert {size.kind for size in learnt.stated.sizes.of} == {"noise", "rest", "drift", "cycle", "growth", "way"}
    assert 1e-6 < learnt.case.description.setups[0].noise < 2.5e-6
    assert np.array_equal(learnt.case.prior.covariance[:size, :size], stated.case.prior.covariance[:size, :size])
    assert np.array_equal(learnt.case.prior.mean, stated.case.prior.mean)
    curve = learnt.case.errors.names["EXX"]
    widths = [np.linalg.norm(each.knowledge.belief.factor[curve.columns]) for each in (stated, learnt)]
    assert widths[1] > widths[0]
    assert any(finding.text.startswith("laser, noise: ") for finding in findings(learnt))
