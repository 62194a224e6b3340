"""Readings of a branch are taken over once, all or none, and never where a set-up's unknowns would be confused."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.cli.app import run
from axiscal.description.campaign import campaign_from_texts, stands_with_others
from axiscal.estimation.inheritance import last_campaign
from axiscal.exceptions import ReadingError
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup, Unknown
from axiscal.record.accepted import Accepted, Bumped
from axiscal.record.copies import carried_text, write_copy
from axiscal.record.store import Record
from tests.commands import Command
from tests.generators.sisters import read_on, slide, write_record
from tests.generators.texts import setup_text

SECOND = setup_text("dial", "indicator", direction="x", moves=["X"], approach="both", noise="1.5 um")


@pytest.fixture
def main(tmp_path: Path) -> Path:
    """Return a record with six readings of the laser."""
    described = campaign_from_texts(slide().text + SECOND, "campaign.toml", slide().machine.text, "machine.toml")
    return write_record(tmp_path / "main.axiscal", described, read_on(1)[:6])


@pytest.fixture
def branch(main: Path) -> Path:
    """Return a copy of it."""
    file = main.with_name("branch.axiscal")
    with Record.open(main, write=False) as record:
        write_copy(record, file)
    return file


def read(file: Path, readings: list[Reading], setup: str = "dial") -> None:
    """Add readings to a record."""
    with Campaign.open(file) as campaign:
        campaign.adopt(tuple(replace(reading, setup=setup) for reading in readings))


def values(file: Path) -> list[tuple[str, float]]:
    """Return what has been read, in the order of the record."""
    with Campaign.open(file, write=False) as campaign:
        assert [reading.number for reading in campaign.state.readings] == [*range(1, len(campaign.state.readings) + 1)]
        return [(reading.setup, reading.value) for reading in campaign.state.readings]


def test_a_branch_is_taken_over_once_and_what_it_has_read_since_later(
    main: Path, branch: Path, command: Command
) -> None:
    read(main, read_on(1)[6:8], "laser")
    read(branch, read_on(1)[8:11])
    before, there = values(main), values(branch)
    assert run(["adopt", str(main), str(branch)]) == 0
    assert values(main) == before + there[6:]
    assert "has no reading that is not here" in command("adopt", main, branch).printed
    read(branch, read_on(1)[11:13])
    assert command("adopt", main, branch, "--json").document["taken"] == 2
    assert values(main) == before + values(branch)[6:]
    assert values(branch)[:9] == there
    with Campaign.open(main, write=False) as campaign:
        assert campaign.estimate().accuracy.rms > 0


def test_what_was_taken_back_here_is_said_and_taken_once_more_where_asked(
    main: Path, branch: Path, command: Command, capsys: pytest.CaptureFixture[str]
) -> None:
    read(branch, read_on(1)[8:11])
    there = values(branch)
    assert run(["adopt", str(main), str(branch)]) == 0
    for _ in range(2):
        assert run(["undo", str(main)]) == 0
    capsys.readouterr()
    said = command("adopt", main, branch).said
    assert "no reading that was not taken over before" in said
    assert "2 readings of it were taken over and taken back here since; --again takes them once more" in said
    assert values(main) == there[:7]
    assert run(["adopt", str(main), str(branch), "--again"]) == 0
    assert values(main) == there
    assert "taken back here" not in capsys.readouterr().out
    document = command("adopt", main, branch, "--again", "--json").document
    assert (document["taken"], document["taken_back_here"]) == (0, 0)


def test_what_two_have_read_with_one_set_up_is_a_question_for_a_person(
    main: Path, branch: Path, command: Command
) -> None:
    read(main, read_on(1)[6:7], "laser")
    read(branch, read_on(1)[7:9], "laser")
    held = main.read_bytes()
    assert "the same set-up, laser" in command("adopt", main, branch).refusal
    assert main.read_bytes() == held
    assert run(["adopt", str(main), str(branch), "--same-mounting"]) == 0
    assert len(values(main)) == 9


@pytest.mark.parametrize("question", [[], ["--same-mounting"]])
def test_readings_that_come_back_are_not_counted_twice(
    main: Path, branch: Path, question: list[str], command: Command
) -> None:
    read(branch, read_on(1)[8:11])
    own = values(branch)
    third = branch.with_name("third.axiscal")
    third.write_bytes(branch.read_bytes())
    read(third, read_on(1)[11:12], "laser")
    assert run(["adopt", str(main), str(branch)]) == 0
    assert "has no reading that is not here" in command("adopt", branch, main, *question).said
    assert values(branch) == own
    assert run(["adopt", str(main), str(third), "--same-mounting"]) == 0  # which began with those of the branch
    assert values(main) == own + values(third)[9:]


def test_another_campaign_a_copy_and_an_ended_one_are_sentences(
    main: Path, branch: Path, tmp_path: Path, command: Command
) -> None:
    other = write_record(tmp_path / "other.axiscal", slide(serial="other"), read_on(2))
    assert "no branch of this campaign" in command("adopt", main, other).refusal
    assert "no reading that is not here" in command("adopt", main, branch).said
    assert run(["undo", str(branch)]) == 0
    read(branch, read_on(1)[8:9])
    with Campaign.open(main) as campaign:
        campaign.finish("done")
    assert "The campaign is finished" in command("adopt", main, branch).refusal
    assert run(["undo", str(main)]) == 0
    said = command("adopt", main, branch).printed
    assert "took back reading 6" in " ".join(said.split())


def dense(campaign: Campaign, known: Sequence[Setup]) -> tuple[np.ndarray, np.ndarray]:
    """Return mean and covariance of errors and zeros by one normal of everything, the prior of errors as inherited.

    Each set-up has a zero of its own, as wide as stated, that is independent of all else.  known : all of them
    """
    case, readings = campaign.case(), campaign.state.readings
    assert case.inherited is not None
    size, names = case.errors.size, [setup.name for setup in known]
    zeros = [next(unknown.std for unknown in setup.unknowns if unknown.name == "zero") for setup in known]
    prior = np.zeros((size + len(known), size + len(known)))
    prior[:size, :size] = case.inherited.covariance
    prior[size:, size:] = np.diag(np.square(zeros))
    before = np.concatenate([case.inherited.mean, np.zeros(len(known))])
    rows, noise = np.zeros((len(readings), len(before))), np.zeros(len(readings))
    for number, reading in enumerate(readings):
        of = names.index(reading.setup)
        seen = Observation(case.errors, (known[of],)).rows(0, np.array([reading.pose]), np.array([reading.approach]))
        rows[number, :size], rows[number, size + of] = seen.rows[0, :size], 1.0
        noise[number] = known[of].noise ** 2
    off = np.array([reading.value for reading in readings]) - rows @ before
    gain = np.linalg.solve(rows @ prior @ rows.T + np.diag(noise), rows @ prior).T
    return before + gain @ off, prior - gain @ rows @ prior


@pytest.fixture
def heir(tmp_path: Path) -> Path:
    """Return a record of six readings that began with what an earlier campaign had found, without wandering zeros."""
    said = {"noise = ": 'drift = "0 um/h"\nnoise = '}
    text = slide(first='kept = 0.8\nprior = "last.axiscal"\n').text + SECOND
    last = write_record(tmp_path / "last.axiscal", slide(), read_on(1)[:12])
    accept(last, Bumped("isg", 1e-5, "2026-11-28"))
    for old, new in said.items():
        text = text.replace(old, new)
    described = campaign_from_texts(
        text, "campaign.toml", slide().machine.text, "machine.toml", prior_text=carried_text(last)
    )
    return write_record(tmp_path / "main.axiscal", described, read_on(1, again=1)[:6])


def test_a_set_up_mounted_anew_has_unknowns_of_its_own_beside_what_is_inherited(heir: Path, command: Command) -> None:
    branch = heir.with_name("branch.axiscal")
    with Record.open(heir, write=False) as record:
        write_copy(record, branch)
    read(heir, read_on(1, again=1)[6:8], "laser")
    read(branch, [replace(each, value=each.value + 250e-6) for each in read_on(1, again=1)[8:13]], "laser")
    read(branch, read_on(1, again=1)[13:15])
    assert "--same-mounting, or not, --mounted-anew" in command("adopt", heir, branch).refusal
    assert run(["adopt", str(heir), str(branch), "--mounted-anew"]) == 0
    with Campaign.open(heir, write=False) as campaign:
        setups, known = campaign.description.setups, campaign.estimate()
        assert campaign.description.bump_of("isg") == Bumped("isg", 1e-5, "2026-11-28")  # which its machine has shown
        anew = setups[-1].name
        assert [setup.name for setup in setups] == ["laser", "dial", anew]
        assert anew.startswith("laser, mounted for ")
        mean, covariance = dense(campaign, setups)
        assert not known.outliers
        belief, own = known.knowledge.belief, known.knowledge.observation
        kept = [*range(own.errors.size), *(int(own.unknowns_of(index)[0]) for index in range(3))]
        np.testing.assert_allclose(belief.mean[kept], mean, rtol=0, atol=1e-10)
        np.testing.assert_allclose(belief.covariance[np.ix_(kept, kept)], covariance, rtol=0, atol=1e-16)
        assert belief.mean[kept[-1]] - belief.mean[kept[-3]] > 150e-6


def test_what_was_mounted_anew_goes_on_is_never_asked_for_and_comes_back_as_what_it_was(
    main: Path, branch: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    read(branch, read_on(1)[6:8], "laser")
    assert run(["adopt", str(main), str(branch), "--mounted-anew"]) == 0
    (anew,) = {setup for setup, _ in values(main)} - {"laser"}
    read(branch, read_on(1)[8:9], "laser")
    assert run(["adopt", str(main), str(branch)]) == 0  # which mounting it was has been said
    assert [setup for setup, _ in values(main)] == ["laser"] * 6 + [anew] * 3
    held = main.read_bytes()
    assert run(["adopt", str(main), str(branch), "--mounted-anew"]) == 0
    assert main.read_bytes() == held
    assert run(["adopt", str(branch), str(main)]) == 0  # they are its own
    assert [setup for setup, _ in values(branch)] == ["laser"] * 9
    with Campaign.open(main) as campaign:
        assert {place.setup for place in campaign.prepared()} <= {"laser", "dial"}
        last = campaign.state.readings[-1]
        with pytest.raises(ReadingError, match="stood for a branch"):
            campaign.record(1e-6, at=last.place)
        campaign.undo()
        assert campaign.estimate().accuracy.rms > 0
    heritage = last_campaign(carried_text(main))
    assert [setup.name for setup in heritage[0].setups] == ["laser", "dial", anew]
    assert len(heritage[1]) == 8
    copied = tmp_path / "third.axiscal"
    copied.write_bytes(branch.read_bytes())
    capsys.readouterr()
    assert run(["adopt", str(main), str(branch), "--mounted-anew", "--same-mounting"]) == 2


def accept(file: Path, mistake: Accepted | Bumped) -> None:
    """Let a person accept a mistake, or read a bump."""
    with Record.open(file) as record:
        record.append(mistake)


def test_what_is_taken_over_is_as_it_was_recorded_whatever_either_side_has_accepted(
    main: Path, branch: Path, command: Command
) -> None:
    first, more = values(main), [(each.setup, each.value) for each in read_on(1)[6:8]]
    read(branch, read_on(1)[6:8], "laser")
    accept(branch, Accepted("sign", ("laser",), factor=-1.0))
    accept(branch, Accepted("jump", ("laser",), 4, name="laser, before reading 4"))
    assert values(branch)[0] == ("laser, before reading 4", -first[0][1])
    assert "took back" not in command("adopt", main, branch, "--same-mounting").printed
    assert [value for _, value in values(main)] == [value for _, value in [*first, *more]]
    with Campaign.open(main) as campaign:
        assert not campaign.state.mounted
    accept(main, Accepted("jump", ("laser",), 7, name="laser, before reading 7"))
    for here, there in [(main, branch), (branch, main)]:
        held = here.read_bytes()
        assert run(["adopt", str(here), str(there), "--same-mounting"]) == 0
        assert here.read_bytes() == held
    read(branch, read_on(1)[8:9], "laser")
    assert run(["adopt", str(main), str(branch), "--same-mounting"]) == 0
    assert values(main)[-1] == ("laser", read_on(1)[8].value)


def test_a_ball_that_others_read_too_is_not_mounted_anew_without_them(tmp_path: Path) -> None:
    station = (Unknown("station_x", 1e-3, "centre at 0, 0, 0"), Unknown("zero", 1e-4, "bar of 150 mm"))
    setup = replace(slide().setups[0], unknowns=station)
    assert stands_with_others(setup) == "centre at 0, 0, 0"
    assert stands_with_others(replace(setup, unknowns=station[1:])) == ""
