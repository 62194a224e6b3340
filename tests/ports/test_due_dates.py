"""When machines are due: how they change is learnt from pairs of campaigns, and what is left is what drifts leave."""

from __future__ import annotations

from dataclasses import replace
from datetime import date
from pathlib import Path

import numpy as np
import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.cli.app import run
from axiscal.description.campaign import campaign_from_texts
from axiscal.description.type_text import TypePrior
from axiscal.estimation.case import Case
from axiscal.estimation.data_equation import DataEquation
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.promise.problem import Inherited
from axiscal.exceptions import AmbiguityError, RecordError, TableError
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.ports.fleet.due_dates import due_dates, titles
from axiscal.ports.fleet.type_learning import learnt_type
from axiscal.ports.fleet.worn_machine import Aging, Pair, Wearing, aging, worn
from axiscal.web.after_end import measure_again
from tests.commands import Command
from tests.generators.sisters import read_on, shop, slide, write_record
from tests.generators.texts import machine_text, setup_text

DAY = date(2030, 1, 1)
REST = 4e-6
TWO_ERRORS = machine_text(
    "w-b-X-t", {"X": (0, 500)}, {"EXX EYX": 'std = "20 um", knots = 7, length = "150 mm", rest = "4 um"'}, name="Slide"
)
SQUARE_SETUP = setup_text("square", "indicator", direction="y", moves=["X"], approach="both", noise="0.5 um")


def _known(rng: np.random.Generator, truth: Array, stated: Array) -> tuple[Inherited, DataEquation]:
    """Return what one campaign of a made-up machine comes to know, and what its readings say."""
    rows = 3.0 * rng.standard_normal((40, len(truth)))
    read = DataEquation(rows, rows @ truth + rng.standard_normal(40))
    gain = stated @ rows.T @ np.linalg.inv(rows @ stated @ rows.T + np.eye(40))
    return Inherited(gain @ read.values, stated - gain @ rows @ stated), read


@pytest.mark.long
@pytest.mark.parametrize(("once", "yearly"), [(0.9, 1.0), (0.97, 0.95)])
def test_what_is_kept_is_learnt_from_pairs(once: float, yearly: float) -> None:
    rng, stated, pairs = np.random.default_rng(8), np.eye(30), list[Pair]()
    wears = Wearing(np.zeros(30), stated)
    for _ in range(10):
        years = float(rng.uniform(0.5, 2.0))
        kept = once * yearly**years
        before = rng.standard_normal(30)
        after = kept * before + np.sqrt(1 - kept**2) * rng.standard_normal(30)
        pairs.append(Pair(years, _known(rng, before, stated)[0], _known(rng, after, stated)[1], wears))
    found, _ = aging(pairs).kept(1.0)
    assert abs(found - once * yearly) < 0.03


def test_without_pairs_it_is_what_is_believed_beforehand() -> None:
    found = aging([])
    assert found.pairs == 0
    np.testing.assert_allclose(found.at_once[0], 0.9, atol=0.01)  # the mean of a Beta(9, 1), from 0.5 on
    np.testing.assert_allclose(found.kept(0.0)[0], found.at_once[0])


def _certain(share: float) -> Aging:
    weights = np.zeros((50, 50))
    weights[round((share - 0.505) / 0.01), -1] = 1.0
    return Aging(weights, 1)


KEPT = 0.905 * 0.995
"""By a machine that is `_certain`, after a year."""
POSES, SIDES = np.tile(np.linspace(0.0, 0.5, 201)[:, None], (2, 1)), np.repeat([[1.0], [-1.0]], 201, axis=0)


def _later(known: Estimation, kept: float) -> tuple[Array, Array]:
    """Return what was estimated of a machine (n,), and what 4,000 machines that drift are a year later (n, 4000)."""
    rng, size = np.random.default_rng(9), known.case.errors.size
    mean, factor = known.printed.belief.mean[:size], known.printed.belief.factor[:size]
    then = mean[:, None] + factor @ rng.standard_normal((factor.shape[1], 4000))
    fresh = known.case.errors.prior_root() @ rng.standard_normal((size, 4000))
    return mean, kept * then + np.sqrt(1 - kept**2) * fresh


@pytest.mark.parametrize("renewed", [(), ("X",)])
def test_what_is_left_is_what_machines_that_drift_show(renewed: tuple[str, ...]) -> None:
    known = concluded(Case(slide()), read_on(1))
    mean, later = _later(known, 0.0 if renewed else KEPT)
    rows = known.case.errors.rows(POSES, SIDES)[:, 0]
    true = float(np.sqrt(np.mean(((rows - rows.mean(axis=0)) @ (later - mean[:, None])) ** 2)))
    np.testing.assert_allclose(worn(known, _certain(0.905), renewed)(1.0), true, rtol=0.05)


@pytest.fixture(scope="module")
def taught(tmp_path_factory: pytest.TempPathFactory) -> TypePrior:
    return learnt_type(shop(tmp_path_factory.mktemp("sisters"), 4), doubt=1e-9)


def test_a_machine_measured_by_what_its_type_has_taught_is_not_due_before_it_is(
    taught: TypePrior, tmp_path: Path, command: Command
) -> None:
    """Six readings are few without it: by the stated prior such a machine was due on the day of its campaign."""
    few = read_on(7)[::3]
    write_record(tmp_path / "few.axiscal", slide(prior=taught.text()), few)
    with Campaign.open(tmp_path / "few.axiscal", write=False) as campaign:
        began, known = date.fromisoformat(campaign.begun[:10]), campaign.estimate(ended=True)
        there = known.accuracy.rms
    (machine,) = due_dates([tmp_path / "few.axiscal"], began, 8e-6).machines
    assert there < machine.now < 1.3 * 4e-6
    for target, said in ((1.1 * there, "and what is not kept is more"), (0.9 * there, "was not as good")):
        assert said in command("due", tmp_path, "--target", f"{1e6 * target:.9f} um").printed


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_record(tmp_path / "a-1.axiscal", slide(serial="A"), read_on(1))
    write_record(tmp_path / "a-2.axiscal", slide(serial="A"), read_on(1, again=1))
    write_record(tmp_path / "b.axiscal", slide(serial="B"), read_on(2))
    return tmp_path


def test_the_last_campaign_of_each_machine_counts(folder: Path) -> None:
    found = due_dates(folder.glob("*.axiscal"), DAY, 15e-6)
    assert sorted(machine.record.name for machine in found.machines) == ["a-2.axiscal", "b.axiscal"]
    assert found.aging.pairs == 1
    for machine in found.machines:
        later = due_dates(folder.glob("*.axiscal"), machine.due or DAY, 15e-6)
        now = next(each.now for each in later.machines if each.record == machine.record)
        assert (now > 15e-6) == (machine.due is not None)
    with pytest.raises(RecordError, match="No record can be read"):
        due_dates([], DAY)


def test_machines_of_two_builds_may_have_the_same_number_and_one_that_cannot_be_estimated_ends_nothing(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_record(folder / "longer.axiscal", slide(serial="B", travel=800), read_on(4))
    write_record(folder / "mirrored.axiscal", slide(serial="C"), read_on(5))

    def estimated(case: Case, readings: tuple[Reading, ...]) -> Estimation:
        if case.description.particulars.serial == "C":
            raise AmbiguityError("two places fit", "read again")
        return concluded(case, readings)

    monkeypatch.setattr("axiscal.ports.fleet.due_dates.concluded", estimated)
    found = due_dates(folder.glob("*.axiscal"), DAY, 15e-6)
    names = sorted(machine.record.name for machine in found.machines)
    assert names == ["a-2.axiscal", "b.axiscal", "longer.axiscal"]
    assert [(each.file, each.left_out) for each in found.left_out] == [("mirrored.axiscal", "two places fit")]


def test_the_command(folder: Path, command: Command) -> None:
    (folder / "torn.axiscal").write_text("no record")
    words = ["due", str(folder), "--today", "2030-01-01", "--target", "6 um"]
    document = command(*words, "--json").document
    assert [each["file"] for each in document["left_out"]] == ["torn.axiscal"]
    assert "learnt from 1 pair of campaigns" in command(*words).printed
    assert run([*words[:-1], "4 mrad"]) == 1


def test_machines_of_one_name_are_told_apart_by_their_records(folder: Path) -> None:
    shop = due_dates([folder / "b.axiscal"], DAY, 12e-6).machines
    other = replace(shop[0], record=shop[0].record.with_name("c.axiscal"), minutes=75.0)
    assert titles(shop) == [shop[0].name]
    assert titles([*shop, other]) == [f"{shop[0].name} (b.axiscal)", f"{shop[0].name} (c.axiscal)"]


@pytest.mark.long
def test_tables_leave_what_their_control_cannot_hold(folder: Path) -> None:
    """Of a slide with reversal a table of both sides leaves nothing, and a height map is none for it at all."""
    files = [folder / "b.axiscal"]
    whole = due_dates(files, DAY, 15e-6).machines[0].now
    table = due_dates(files, DAY, 15e-6, "linuxcnc").machines[0].now
    np.testing.assert_allclose(table, whole, rtol=0.05)  # over other poses, a table with its own points
    with pytest.raises(TableError):
        due_dates(files, DAY, 15e-6, "klipper")


@pytest.mark.parametrize("asked", ["aligned = false", 'directions = ["x"]', 'directions = ["y"]', ""])
def test_what_is_left_with_tables_is_what_a_machine_that_drifts_shows(asked: str) -> None:
    """A table of one axis holds no straightness; the mean that is left is compared in a sampled machine."""
    text = slide().text.replace("aligned = false\n", "").replace("[[setups]]", f"{asked}\n{SQUARE_SETUP}[[setups]]", 1)
    described = campaign_from_texts(text, "campaign.toml", TWO_ERRORS, "machine.toml")
    known = concluded(Case(described), [*read_on(1), *(replace(r, setup="square") for r in read_on(2))])
    mean, later = _later(known, KEPT)
    straight = [term.columns for term in known.case.errors.terms if term.name == "EYX"]
    held = np.ones(len(mean), dtype=bool)
    for columns in straight:
        held[columns] = False
    rows = known.estimate().model.rows(POSES, SIDES)
    tips = np.einsum("mcn,nk->mck", rows, later - (mean * held)[:, None])
    tips -= tips.mean(axis=0)
    lies = POSES - POSES.mean()  # an axis alone lies askew to nothing
    tips[:, 1] -= lies @ (lies.T @ tips[:, 1]) / np.sum(lies**2)
    counts = ["xyz".index(way) for way in "xyz" if f'"{way}"' in asked or "directions" not in asked]
    rests = REST**2 * sum(way in (0, 1) for way in counts)  # what a curve does not say is left besides
    true = float(np.sqrt(np.mean(np.sum(tips[:, counts] ** 2, axis=1)) + rests))
    np.testing.assert_allclose(worn(known, _certain(0.905), (), "linuxcnc")(1.0), true, rtol=0.05)
    if 1 in counts:
        assert worn(known, _certain(0.905))(1.0) < 0.9 * true


def test_a_target_of_u_is_read_from_the_campaign(folder: Path) -> None:
    text = slide(serial="U").text.replace('rms = "2 um"', 'U = "30 um"')
    described = campaign_from_texts(text, "campaign.toml", slide(serial="U").machine.text, "machine.toml")
    file = write_record(folder / "u.axiscal", described, read_on(3))
    (machine,) = due_dates([file], DAY).machines
    others = [file for file in folder.iterdir() if file.name in ("b.axiscal", "u.axiscal", "torn.axiscal")]
    day = next(each.day_text for each in due_dates(others, DAY).machines if each.record.name == "u.axiscal")
    assert measure_again(file, others) == f"Measure again: {day}."
    assert 30e-6 / 2.2 < (machine.target or 0.0) < 30e-6 / 1.5  # the factor between both, as docs/conventions.md has it
