"""What is known is kept beside the record: the same answers with it, without it, and with any damage to it."""

from __future__ import annotations

import copy
import io
import pickle
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

import numpy as np
import pytest

from axiscal.campaign import kept, knowing
from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ending import standing
from axiscal.campaign.sources.exec import ExecSource
from axiscal.description.campaign import CampaignDescription, read_campaign
from axiscal.estimation import estimate
from axiscal.estimation.case import Case
from axiscal.estimation.deciding import FEWEST, contest
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.reviewed import reviewed
from axiscal.estimation.ruled import ruled
from axiscal.estimation.soundness import is_sound
from axiscal.estimation.watching import watched_so_far
from axiscal.exceptions import AmbiguityError
from axiscal.inference.contradiction import Explanation, Watched
from axiscal.inference.outliers import Doubt
from axiscal.measurement.reading import Reading
from axiscal.record import durable
from axiscal.simulation import Simulator

TEXT = """
{scales}
machine = "one-axis"
[target]
rms = "0.01 um"
[[setups]]
name = "laser"
instrument = "interferometer"
direction = "x"
noise = "0.3 um"
approach = "both"
"""
COUNT = kept.FEWEST + 40
Part = TypeVar("Part")


def _described(folder: Path, scales: str = "") -> CampaignDescription:
    path = folder / "campaign.toml"
    path.write_text(TEXT.format(scales=scales), encoding="utf-8")
    return read_campaign(path)


def _readings(description: CampaignDescription, count: int) -> tuple[Reading, ...]:
    """Return readings of a virtual machine, of which one is bad."""
    rng = np.random.default_rng(3)
    machine, setup = Simulator(description.machine, description.setups).drawn(3), description.setups[0]
    low, high = description.machine.axes[0].travel
    found = []
    for number in range(count):
        pose, side = (float(rng.uniform(low, high)),), (int(rng.choice([-1, 1])),)
        value = machine.read(setup, pose, side, rng) + (2e-5 if number == 20 else 0.0)
        found.append(Reading("laser", pose, side, value))
    return tuple(found)


@pytest.fixture(params=["", 'scales = "estimate"'])
def record(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """A record of many readings, and what is known of the first of them beside it."""
    description, path = _described(tmp_path, request.param), tmp_path / "c.axiscal"
    readings = _readings(description, COUNT)
    with Campaign.create(path, description) as campaign:
        campaign.adopt(readings[: kept.FEWEST])
        campaign.known()
        campaign.adopt(readings[kept.FEWEST :])
    assert kept.kept_beside(path).exists()
    return path


def _known(path: Path) -> Estimation:
    with Campaign.open(path, write=False) as campaign:
        return campaign.known()


def _same(one: Estimation, other: Estimation) -> None:
    assert one.readings == other.readings
    assert [doubt.reading for doubt in one.outliers] == [doubt.reading for doubt in other.outliers]
    np.testing.assert_allclose(one.accuracy, other.accuracy, rtol=1e-9)
    mean, std = one.knowledge.belief.mean, np.sqrt(np.diagonal(other.knowledge.belief.covariance))
    np.testing.assert_allclose(mean / std, other.knowledge.belief.mean / std, rtol=0, atol=1e-7)


def test_only_the_new_readings_are_looked_at(record: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    taken = list[int]()

    def counted(before: object, readings: tuple[Reading, ...], implausible: object) -> object:
        taken.append(len(before.innovations))  # type: ignore[attr-defined]
        return reviewed(before, readings, implausible)  # type: ignore[arg-type]

    monkeypatch.setattr(estimate, "reviewed", counted)
    with_it = _known(record)
    assert taken[0] >= kept.FEWEST
    kept.kept_beside(record).unlink()
    _same(with_it, _known(record))
    learnt = _known(record).learnt_from  # what is learnt anew is found from all
    assert taken[-1] < kept.FEWEST or learnt >= kept.FEWEST


def test_a_reading_that_has_all_weighed_again_is_looked_at_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of more than 200; one that fits waits until there are enough new ones."""
    description, path = _described(tmp_path), tmp_path / "c.axiscal"
    *readings, last = _readings(description, 242)
    with Campaign.create(path, description) as campaign:
        campaign.adopt(tuple(readings[:240]))
        campaign.known()
    begun = list[int]()

    def counted(before: object, readings: tuple[Reading, ...], implausible: object) -> object:
        begun.append(len(before.innovations))  # type: ignore[attr-defined]
        return reviewed(before, readings, implausible)  # type: ignore[arg-type]

    monkeypatch.setattr(estimate, "reviewed", counted)
    for reading in (readings[240], replace(last, value=last.value + 2e-6)):
        with Campaign.open(path) as campaign:
            campaign.adopt((reading,))
            campaign.known()
    found = _known(path)
    assert begun == [240, 240]
    kept.kept_beside(path).unlink()
    again = _known(path)
    assert [doubt.reading for doubt in found.outliers] == [doubt.reading for doubt in again.outliers]


@pytest.mark.parametrize("damage", ["cut", "flipped", "emptied", "other title", "a folder", "of another campaign"])
def test_damage_is_not_trusted(record: Path, damage: str) -> None:
    beside = kept.kept_beside(record)
    expected, content = _known(record), beside.read_bytes()
    flipped = bytearray(content)
    flipped[len(content) // 2] ^= 4
    if damage == "a folder":
        beside.unlink()
        beside.mkdir()
    else:
        title, said, rest = content.split(b"\n", 2)
        other = b"\n".join([title, said.replace(said[:8], b"01234567"), rest])
        instead = {"cut": content[:-100], "flipped": bytes(flipped), "emptied": b"", "other title": content[1:]}
        beside.write_bytes(instead.get(damage, other))
    _same(_known(record), expected)


def test_what_was_taken_back_does_not_count(record: Path) -> None:
    _known(record)
    with Campaign.open(record) as campaign:
        for _ in range(50):
            campaign.undo()
        count = len(campaign.state.readings)
        with_it = campaign.known()
    assert count == COUNT - 50 == len(with_it.readings)
    kept.kept_beside(record).unlink()
    _same(with_it, _known(record))


def test_other_readings_are_not_taken_for_these(record: Path, tmp_path: Path) -> None:
    with Campaign.open(record, write=False) as campaign:
        description, readings = campaign.description, campaign.state.readings
    path = tmp_path / "other.axiscal"
    with Campaign.create(path, description) as campaign:
        campaign.adopt(tuple(replace(reading, value=reading.value + 1e-6) for reading in readings))
    kept.kept_beside(record).rename(kept.kept_beside(path))
    with_it = _known(path)
    kept.kept_beside(path).unlink()
    _same(with_it, _known(path))


def test_nothing_can_be_called_from_it(record: Path) -> None:
    key = kept.kept_beside(record).read_bytes().split(b"\n")[1][:64].decode()

    class Harm:
        def __reduce__(self) -> tuple[object, tuple[str]]:
            return ExecSource, ("touch harm",)

    kept._write(kept.kept_beside(record), key, Harm())  # type: ignore[arg-type]
    assert kept._read(kept.kept_beside(record), key) is None
    for call in (print, eval, pickle.loads, kept.kept_beside, estimate.estimated):
        with pytest.raises(pickle.UnpicklingError):
            kept._KnownReader(io.BytesIO(pickle.dumps(call))).load()


def test_a_folder_that_takes_no_file_keeps_nothing(record: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    expected = _known(record)
    kept.kept_beside(record).unlink()

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(durable, "written", full)
    _same(_known(record), expected)
    assert not kept.kept_beside(record).exists()


def test_what_is_signed_is_found_from_the_record_alone(record: Path, tmp_path: Path) -> None:
    """Somebody who may write into the folder keeps what another description made of the same readings."""
    (tmp_path / "other").mkdir()
    other = _described(tmp_path / "other", 'scales = "estimate"\n')
    with Campaign.open(record, write=False) as campaign:
        readings, expected = campaign.state.readings, campaign.concluded()
        key = kept._key(campaign._record.events()[0].event)
    louder = replace(other, setups=tuple(replace(setup, noise=1e-3) for setup in other.setups))
    kept._write(kept.kept_beside(record), key, estimate.estimated(Case(louder), readings))
    with Campaign.open(record, write=False) as campaign:
        assert campaign.known().stated.description.setups[0].noise == 1e-3  # only while others are to follow
        _same(campaign.concluded(), expected)


def test_a_station_in_two_places_does_not_refuse_the_reading_that_decides(
    record: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def ambiguous(_case: object, _readings: Sequence[Reading]) -> Estimation:
        raise AmbiguityError("the station fits in two places", "read where they differ")

    monkeypatch.setattr("axiscal.campaign.knowing.concluded", ambiguous)
    with Campaign.open(record, write=False) as campaign:
        assert campaign.believed() is campaign.known() or campaign.believed().readings == campaign.state.readings
        with pytest.raises(AmbiguityError):
            campaign.concluded()


def test_few_readings_leave_no_file(tmp_path: Path) -> None:
    description, path = _described(tmp_path), tmp_path / "c.axiscal"
    with Campaign.create(path, description) as campaign:
        campaign.adopt(_readings(description, kept.FEWEST - 1))
        campaign.known()
    assert not kept.kept_beside(path).exists()


def test_whether_causes_compete_is_not_asked_of_the_first_readings(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    description, path = _described(tmp_path), tmp_path / "c.axiscal"
    with Campaign.create(path, description) as campaign:
        campaign.adopt(_readings(description, FEWEST - 1))
        assert contest(campaign.known()) is None
        monkeypatch.setattr(knowing, "estimated", None)
        assert campaign.contest() is None


def test_the_verdict_is_kept_and_is_the_one_that_is_found(record: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with Campaign.open(record, write=False) as campaign:
        first = campaign.reached(), campaign.watched()
        assert first == (standing(campaign.description.target, campaign.known()), watched_so_far(campaign.known()))
    for room, name in ((knowing, "standing"), (kept, "watched_so_far")):
        monkeypatch.setattr(room, name, None)  # nothing is found anew
    with Campaign.open(record) as campaign:
        assert (campaign.reached(), campaign.watched()) == first
        campaign.undo()
        with pytest.raises(TypeError):  # of other readings it says nothing
            campaign.reached()


@pytest.mark.parametrize("damage", ["cut", "emptied", "an estimation"])
def test_a_damaged_verdict_is_found_again(record: Path, damage: str) -> None:
    with Campaign.open(record, write=False) as campaign:
        expected = campaign.reached(), campaign.watched()
    beside = kept.answers_beside(record)
    content = {"cut": beside.read_bytes()[:-9], "emptied": b"", "an estimation": kept.kept_beside(record).read_bytes()}
    beside.write_bytes(content[damage])
    with Campaign.open(record, write=False) as campaign:
        assert (campaign.reached(), campaign.watched()) == expected


def test_where_few_have_been_read_the_answers_are_kept_as_well(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    description, path = _described(tmp_path), tmp_path / "c.axiscal"
    with Campaign.create(path, description) as campaign:
        campaign.adopt(_readings(description, kept.FEWEST_ANSWERED))
        first = campaign.status(), campaign.watched()
        known = campaign.known()
        assert first[0].accuracy == known.accuracy
        assert first[0].seconds == known.seconds
    assert not kept.kept_beside(path).exists()
    monkeypatch.setattr(knowing, "estimated", None)  # nothing is found anew
    with Campaign.open(path, write=False) as campaign:
        assert (campaign.status(), campaign.watched()) == first


@pytest.mark.parametrize("scales", ["", 'scales = "estimate"'])
def test_of_one_that_has_ended_it_says_what_its_results_say(
    scales: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    description, path = _described(tmp_path, scales), tmp_path / "c.axiscal"
    with Campaign.create(path, description) as campaign:
        campaign.adopt(_readings(description, COUNT))
        campaign.finish("all were read")
        expected = ruled(estimate.concluded(Case(description), campaign.state.readings))
        assert campaign.ruled().accuracy == expected.accuracy
        campaign.copy(tmp_path / "copy.axiscal")
        campaign.leave_answers(tmp_path / "copy.axiscal")
    for name in ("estimated", "concluded", "ruled", "timed"):
        monkeypatch.setattr(knowing, name, None)  # nothing is found anew
    for each in (path, tmp_path / "copy.axiscal"):
        with Campaign.open(each, write=False) as campaign:
            status = campaign.status()
            assert (status.accuracy, status.seconds) == (expected.accuracy, expected.seconds)
            assert campaign.watched() == watched_so_far(expected)


def test_one_that_goes_on_is_not_told_what_its_end_said(tmp_path: Path) -> None:
    description, path = _described(tmp_path, 'scales = "estimate"'), tmp_path / "c.axiscal"
    with Campaign.create(path, description) as campaign:
        campaign.adopt(_readings(description, 20))
        campaign.finish("all were read")
        ended = campaign.status().accuracy
        campaign.undo()
        assert campaign.status().accuracy == campaign.known().accuracy != ended


@pytest.mark.parametrize("scales", ["", 'scales = "estimate"'])
def test_a_copy_whose_end_is_taken_back_is_told_by_its_readings(
    scales: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    description, path, left = _described(tmp_path, scales), tmp_path / "c.axiscal", tmp_path / "left.axiscal"
    readings = _readings(description, 21)
    with Campaign.create(path, description) as campaign:
        campaign.adopt(readings[:20])
        campaign.finish("all were read")
        campaign.copy(left)
        campaign.leave_answers(left)
    with Campaign.open(left, write=False) as campaign:
        ended = campaign.status().accuracy
    with Campaign.open(left) as campaign:
        campaign.undo()
    known = estimate.estimated(Case(description), readings[:20])
    for count in (20, 21, 20):  # taken back, one more, and that one taken back, too
        with Campaign.open(left) as campaign:
            if count == 21:
                campaign.adopt(readings[20:])
            elif len(campaign.state.readings) == 21:
                campaign.undo()
            expected = known if count == 20 else estimate.estimated(Case(description), readings)
            status = campaign.status()
            assert (status.accuracy, status.seconds) == (expected.accuracy, expected.seconds)
            assert campaign.watched() == watched_so_far(expected)
            assert status.accuracy != ended
    with Campaign.open(left) as campaign:
        campaign.finish("once more")
        assert campaign.status().accuracy == ended
    for name in ("estimated", "concluded", "ruled", "timed"):
        monkeypatch.setattr(knowing, name, None)  # nothing is found anew
    with Campaign.open(left, write=False) as campaign:
        assert campaign.status().accuracy == ended


def test_a_station_in_two_places_has_a_status_after_its_end(record: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def ambiguous(_case: object, _readings: Sequence[Reading]) -> Estimation:
        raise AmbiguityError("the station fits in two places", "read where they differ")

    monkeypatch.setattr("axiscal.campaign.knowing.concluded", ambiguous)
    with Campaign.open(record) as campaign:
        campaign.finish("no more time")
        assert campaign.status().accuracy == campaign.known().accuracy


EXPLAINED = Explanation("no family", "laser", 0.0, 1.0, 1.0, 1.0)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "forged", ["a word", ("A", "B", "C"), (None, None, float("nan")), ("reached",), Watched((EXPLAINED,)), None]
)
def test_a_verdict_that_somebody_made_up_is_found_again(record: Path, forged: object) -> None:
    with Campaign.open(record, write=False) as campaign:
        expected = campaign.reached(), campaign.watched()
    beside = kept.answers_beside(record)
    key = beside.read_bytes().split(b"\n")[1][:64].decode()
    kept._write(beside, key, dict.fromkeys(("standing", "watched", "accuracy", "seconds"), forged))
    with Campaign.open(record, write=False) as campaign:
        assert (campaign.reached(), campaign.watched()) == expected
        status, known = campaign.status(), campaign.known()
        assert (status.accuracy, status.seconds) == (known.accuracy, known.seconds)


def test_what_is_known_is_found_again_where_somebody_made_up_a_part(record: Path) -> None:
    expected = _known(record)
    beside = kept.kept_beside(record)
    key = beside.read_bytes().split(b"\n")[1][:64].decode()
    kept._write(beside, key, object.__new__(Estimation))
    _same(_known(record), expected)


def _made_up(whole: Part, parts: Mapping[str, object]) -> Part:
    """Return a copy with parts in the place of what they were, which nobody looks at as it is made."""
    made = copy.copy(whole)
    for name, part in parts.items():
        object.__setattr__(made, name, part)
    return made


def _with_belief(known: Estimation, **parts: object) -> Estimation:
    """Return an estimation with parts of its belief put in the place of what they were."""
    belief = _made_up(known.stages.absorbed.knowledge.belief, parts)
    knowledge = replace(known.stages.absorbed.knowledge, belief=belief)
    stages = known.stages._replace(absorbed=replace(known.stages.absorbed, knowledge=knowledge))
    return replace(known, stages=stages)


def _with_plausibility(known: Estimation, **parts: object) -> Estimation:
    plausibility = _made_up(known.stages.judged.plausibility, parts)
    return replace(known, stages=known.stages._replace(judged=replace(known.stages.judged, plausibility=plausibility)))


FORGED: dict[str, Callable[[Estimation], Estimation]] = {
    "a short mean": lambda known: _with_belief(known, mean=np.zeros(2)),
    "a mean of words": lambda known: _with_belief(known, mean=np.array(["a"] * known.knowledge.belief.size)),
    "factors of nan": lambda known: _with_belief(
        known, factors=known.knowledge.belief.factors._replace(diagonal=np.full(known.knowledge.belief.size, np.nan))
    ),
    "negative variances": lambda known: _with_belief(
        known, factors=known.knowledge.belief.factors._replace(diagonal=-known.knowledge.belief.factors.diagonal)
    ),
    "no factors": lambda known: _with_belief(known, factors=None),
    "a wide covariance": lambda known: _with_plausibility(known, covariance=np.eye(3)),
    "a lost size": lambda known: _with_plausibility(known, sizes=known.stages.judged.plausibility.sizes[1:]),
    "a lost surprise": lambda known: replace(known, innovations=known.innovations[1:]),
    "a doubt of no reading": lambda known: replace(known, outliers=(Doubt(10_000, 5.0, 0.0),)),
    "a time that is none": lambda known: replace(
        known,
        stages=known.stages._replace(
            timed=replace(known.stages.timed, ends=(float("nan"),) * len(known.stages.timed.ends))
        ),
    ),
    "no case": lambda known: replace(known, stated=None),  # type: ignore[arg-type]
    "no stages": lambda known: replace(known, stages=None),  # type: ignore[arg-type]
}


@pytest.mark.parametrize("forged", FORGED)
def test_what_is_known_is_found_again_where_its_arrays_do_not_fit(record: Path, forged: str) -> None:
    beside = kept.kept_beside(record)
    made_up = FORGED[forged](_of_the_first(record))
    key = _key_beside(record)
    kept._write(beside, key, made_up)
    with Campaign.open(record, write=False) as campaign:
        assert campaign._knowing._kept.recalled(campaign.state.readings) is None
        assert len(campaign.known().readings) == COUNT
    written = kept._read(beside, key)
    assert isinstance(written, Estimation)
    assert is_sound(written)


def test_what_cannot_be_gone_on_from_is_found_again(record: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It fits together, and the first product of matrices is a defect: another file is behind it than was thought."""
    expected, gone_on_from = _known(record), list[bool]()
    beside, key = kept.kept_beside(record), _key_beside(record)

    def failing(case: Case, readings: Sequence[Reading], before: Estimation | None = None) -> Estimation:
        gone_on_from.append(before is not None)
        if before is not None:
            raise ValueError("operands could not be broadcast together")
        return estimate.estimated(case, readings)

    monkeypatch.setattr(knowing, "estimated", failing)
    kept._write(beside, key, replace(_of_the_first(record), accuracy=expected.accuracy._replace(rms=1.0)))
    with Campaign.open(record) as campaign:
        assert campaign.known().accuracy == pytest.approx(expected.accuracy)
    assert gone_on_from == [True, False]
    written = kept._read(beside, key)
    assert isinstance(written, Estimation)
    assert written.accuracy.rms < 1.0


def _key_beside(record: Path) -> str:
    return kept.kept_beside(record).read_bytes().split(b"\n")[1][:64].decode()


def _of_the_first(record: Path) -> Estimation:
    """Return what is kept of the first readings."""
    found = kept._read(kept.kept_beside(record), _key_beside(record))
    assert isinstance(found, Estimation)
    return found
