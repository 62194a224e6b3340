"""A folder of records teaches the same in any order; what cannot teach is named, and stops nothing."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from axiscal.campaign.agreement_words import farthest, membership_words
from axiscal.description.campaign import campaign_from_texts
from axiscal.description.type_text import type_prior
from axiscal.errors.model import ErrorModel
from axiscal.estimation.estimate import concluded
from axiscal.estimation.inheritance import case_of
from axiscal.estimation.type_prior import over, rivals
from axiscal.exceptions import DescriptionError, RecordError
from axiscal.machine import machine_from_text
from axiscal.ports.fleet.rehearsal import Imagined, summary_sentences
from axiscal.ports.fleet.type_learning import learnt_type
from tests.generators.sisters import read_on, shop, slide, write_record


@pytest.fixture(scope="module")
def records(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    return shop(tmp_path_factory.mktemp("shop"), 6)


@pytest.fixture(scope="module")
def taught(records: list[Path]) -> str:
    return learnt_type(records).text()


def test_records_in_any_order_teach_the_same_bytes(records: list[Path], taught: str) -> None:
    assert learnt_type(reversed(records)).text() == taught
    assert type_prior(taught).text() == taught


@pytest.mark.long
def test_each_record_that_cannot_teach_is_named_with_its_reason(tmp_path: Path, records: list[Path]) -> None:
    (tmp_path / "torn.axiscal").write_bytes(records[0].read_bytes()[:-200])
    (tmp_path / "text.axiscal").write_text("no record")
    (tmp_path / "twice.axiscal").write_bytes(records[1].read_bytes())
    write_record(tmp_path / "larger.axiscal", slide(travel=800), read_on(8))
    write_record(tmp_path / "empty.axiscal", slide(), [])
    write_record(tmp_path / "active.axiscal", slide(first="compensation_active = true\n"), read_on(9))
    write_record(tmp_path / "verified-1.axiscal", slide(serial="9"), read_on(6))
    tables = slide(first="compensation_active = true\n", serial="9")
    write_record(tmp_path / "verified-2.axiscal", tables, read_on(7))
    write_record(tmp_path / "again-1.axiscal", slide(serial="4711"), read_on(10))
    write_record(tmp_path / "again-2.axiscal", slide(serial="4711"), read_on(11))
    found = learnt_type([*records, *tmp_path.glob("*.axiscal"), tmp_path / "missing.axiscal"])
    why = {record.file: record.left_out for record in found.records}
    assert [why[file.name] for file in records if file.name != "slide-1.axiscal"] == [""] * 5
    assert sorted(why[name][:14] for name in ("slide-1.axiscal", "twice.axiscal")) == ["", "it is the same"]
    assert "X travels 800 mm" in why["larger.axiscal"]
    assert why["empty.axiscal"] == "it has no readings"
    assert "compensation was active" in why["active.axiscal"]
    assert "measured again: again-2.axiscal" in why["again-1.axiscal"]
    assert why["again-2.axiscal"] == why["verified-1.axiscal"] == ""
    assert "compensation was active" in why["verified-2.axiscal"]
    assert all(why[name] for name in ("torn.axiscal", "text.axiscal", "missing.axiscal"))
    said = " ".join(summary_sentences(found))
    assert "larger.axiscal" in said
    assert "Learnt from 8 machines" in said


def test_records_that_teach_nothing_are_refused_with_the_reasons(tmp_path: Path) -> None:
    file = write_record(tmp_path / "empty.axiscal", slide(), [])
    with pytest.raises(RecordError, match="no readings"):
        learnt_type([file])
    with pytest.raises(RecordError, match="no records to learn from"):
        learnt_type([])


def test_a_sister_is_known_with_fewer_readings_and_a_stranger_is_named(taught: str) -> None:
    described = slide(prior=taught)
    sister = read_on(20)[::3]
    known, alone = (concluded(case_of(each), sister) for each in (described, slide()))
    assert known.membership is not None
    assert known.membership.sister > 0.9
    assert known.accuracy.rms < 0.7 * alone.accuracy.rms
    assert membership_words(known).startswith("readings up to 6 fit the sisters")
    strange = concluded(case_of(described), read_on(0, Imagined(2.5, 0.1), seed=77))
    assert strange.membership is not None
    assert strange.membership.sister < 0.01
    most = farthest(strange)
    assert most is not None
    sisters = min((rival.belief for rival in strange.membership.rivals), key=lambda each: np.trace(each.covariance))
    columns = next(term.columns for term in strange.case.errors.terms if term.name == most.name)
    apart = strange.printed.belief.mean[columns] - sisters.mean[columns]
    away = np.abs(apart) / np.sqrt(np.diagonal(sisters.covariance)[columns])
    assert np.min(np.abs(away - most.away)) < 1e-9
    assert "not like its sisters" in membership_words(strange)
    assert f"{most.name} is {most.away:.1f} of their standard deviations away" in membership_words(strange)


def test_what_usually_goes_wrong_besides_is_not_of_the_type(tmp_path: Path) -> None:
    """A stated period brings a wave into the model of a campaign, and not into the machine's description."""
    told = slide(usual="on")
    machine = told.machine.text.replace('length = "150 mm"', 'length = "150 mm", period = "10 mm"')
    described = campaign_from_texts(told.text, "campaign.toml", machine, "machine.toml")
    assert "EXX_pitch" in described.machine.error_names
    found = learnt_type([write_record(tmp_path / f"{n}.axiscal", described, read_on(n)) for n in range(2)])
    again = type_prior(found.text())
    assert "EXX_pitch" not in again.machine.error_names
    assert case_of(campaign_from_texts(told.text, "c", machine, "m", prior_text=found.text())).rivals


def test_noise_and_rests_that_are_learnt_make_no_sister_of_a_stranger(taught: str) -> None:
    described = slide(prior=taught, usual="on")
    known, strange = (
        concluded(case_of(described), readings).membership
        for readings in (read_on(20)[::3], read_on(0, Imagined(2.5, 0.1), seed=77))
    )
    assert known is not None
    assert strange is not None
    assert known.sister > 0.8
    assert strange.sister < 0.05


def test_a_sister_of_which_one_axis_was_hit_is_none_but_for_that_axis(taught: str) -> None:
    """A scale off by 90 um over the travel, read where a sister is read."""
    case, readings = case_of(slide(prior=taught)), read_on(22)[::3]
    hit = [replace(each, value=each.value + 90e-6 * (each.pose[0] - 0.25) / 0.5) for each in readings]
    for read, likeliest in ((readings, "like its sisters"), (hit, "like its sisters but for X")):
        found = concluded(case, read).membership
        assert found is not None
        assert found.rivals[found.likeliest].name == likeliest
    strange = concluded(case, hit)
    assert strange.membership is not None
    assert strange.membership.sister < 0.5


def test_the_beliefs_share_the_doubt(taught: str) -> None:
    found = rivals(type_prior(taught), case_of(slide()).errors, 0.2)
    weights = {rival.name: rival.weight for rival in found}
    assert weights["like its sisters"] == pytest.approx(0.8)
    assert sum(weights.values()) == pytest.approx(1.0)
    sizes = [float(np.trace(rival.belief.covariance)) for rival in found]
    assert max(sizes) == sizes[-1]  # by the last one readings are judged


def test_before_the_first_reading_the_mixture_is_that_of_the_beliefs(taught: str) -> None:
    case = case_of(slide(prior=taught))
    known = concluded(case, [])
    assert known.membership is not None
    shares = np.array([rival.weight for rival in case.rivals])
    np.testing.assert_allclose(shares.sum(), 1.0)
    mean = sum(rival.weight * rival.belief.mean for rival in case.rivals)
    expected = sum(
        rival.weight * (rival.belief.covariance + np.outer(rival.belief.mean - mean, rival.belief.mean - mean))
        for rival in case.rivals
    )
    size = case.errors.size
    np.testing.assert_allclose(known.whole.covariance[:size, :size], expected, rtol=1e-6, atol=1e-18)


def test_a_type_is_read_at_the_knots_of_todays_description(taught: str) -> None:
    described = slide(prior=taught)
    finer = described.machine.text.replace("knots = 7", "knots = 13")
    errors = ErrorModel(machine_from_text(finer))
    found, before = over(type_prior(taught), errors), type_prior(taught)
    own = ErrorModel(described.machine)
    places = np.linspace(0.0, 0.5, 31)
    new, old = errors.names["EXX"], own.names["EXX"]
    fine, coarse = new.rows(places) @ found.mean[new.columns], old.rows(places) @ before.mean[old.columns]
    np.testing.assert_allclose(fine, coarse, atol=0.03 * np.max(np.abs(coarse)))
    block = found.covariance[new.columns, new.columns]
    assert np.linalg.eigvalsh(block).min() > 0  # what lies between the knots of the type is not known exactly
    same = over(type_prior(taught), own)
    np.testing.assert_allclose(same.covariance, before.covariance, rtol=1e-9, atol=1e-20)


@pytest.mark.parametrize(
    "wrong",
    [
        '{"schema": "axiscal-type/1"}',
        '{"schema": "axiscal-type/2"}',
        '{"schema": "axiscal-type/1", "machine": 3}',
        "[]",
        "{",
    ],
)
def test_a_damaged_type_is_one_sentence(wrong: str) -> None:
    with pytest.raises(RecordError, match="cannot be read"):
        type_prior(wrong)


def test_sisters_that_nobody_has_learnt_from_are_no_silent_stated_prior() -> None:
    with pytest.raises(DescriptionError, match=r"\[sisters\]"):
        case_of(slide(first='sisters = { records = "*.axiscal" }\n'))


def _undigested(taught: str) -> dict[str, Any]:
    """Return what was learnt as it was written before it had a digest."""
    document: dict[str, Any] = json.loads(taught)
    del document["digest"]
    return document


def test_what_was_learnt_before_it_had_a_digest_is_read(taught: str) -> None:
    assert type_prior(json.dumps(_undigested(taught))).text() == taught


def test_each_changed_number_of_what_was_learnt_is_noticed(taught: str) -> None:
    at = taught.index('"covariance"') + 60
    dice = np.random.default_rng(5)
    places = [*dice.integers(len(taught), size=200), *range(at, at + 20)]
    for place in places:
        other = "7" if taught[place] != "7" else "5"
        with pytest.raises(RecordError, match="what the type has taught cannot be read"):
            type_prior(f"{taught[:place]}{other}{taught[place + 1 :]}")


@pytest.mark.parametrize(
    ("table", "key", "value"),
    [
        *(("learned", key, "x") for key in ("scale", "scale_std", "share", "share_std")),
        *(("learned", key, math.nan) for key in ("scale", "scale_std", "share", "share_std")),
        *(("learned", "share", value) for value in (-0.1, 1.1)),
        *(("learned", key, -1.0) for key in ("scale", "scale_std", "share_std")),
        *(("learned", key, math.inf) for key in ("scale", "scale_std", "share_std")),
        *(("records", key, None) for key in ("file", "digest", "readings", "left_out")),
        ("records", "readings", True),
        ("records", "readings", 1.5),
        ("", "doubt", 10**400),
        ("", "directions", math.inf),
        ("", "mean", [10**400]),
        ("", "mean", [math.nan] * 8),
        ("", "learned", None),
        ("", "covariance", "AAAAAAAA8D8="),
    ],
)
def test_what_cannot_have_been_learnt_is_refused(taught: str, table: str, key: str, value: object) -> None:
    document = _undigested(taught)
    at = {"learned": document["learned"]["EXX"], "records": document["records"][0], "": document}[table]
    at[key] = value
    with pytest.raises(RecordError, match="what the type has taught cannot be read"):
        type_prior(json.dumps(document))
