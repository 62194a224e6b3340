"""A folder of records teaches the same in any order; what cannot teach is named, and stops nothing."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from axiscal.campaign.agreement_words import farthest, membership_words
from axiscal.description.campaign import campaign_from_texts
from axiscal.description.type_text import type_prior
from axiscal.errors.model import ErrorModel
from axiscal.estimation.estimate import concluded
from axiscal.estimation.inheritance import case_of
from axiscal.estimation.type_prior import over
from axiscal.exceptions import DescriptionError, RecordError
from axiscal.machine import machine_from_text
from axiscal.ports.fleet.type_learning import learnt_type
from axiscal.ports.fleet.type_words import summary_sentences
from examples.virtual_sisters import Imagined
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


def test_sisters_that_nobody_has_learnt_from_are_no_silent_stated_prior() -> None:
    with pytest.raises(DescriptionError, match=r"\[sisters\]"):
        case_of(slide(first='sisters = { records = "*.axiscal" }\n'))


def test_a_record_that_is_called_as_all_are_is_named_with_its_folder(records: list[Path], tmp_path: Path) -> None:
    for folder in ("first", "copy"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "campaign.axiscal").write_bytes(records[0].read_bytes())
    prior = learnt_type([*records[1:], *tmp_path.glob("*/campaign.axiscal")])
    assert [(each.file, each.left_out) for each in prior.records if each.left_out] == [
        ("first/campaign.axiscal", "it is the same as copy/campaign.axiscal")
    ]
