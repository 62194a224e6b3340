"""The trials of `make reliability`, in small."""

from __future__ import annotations

from pathlib import Path

import pytest

from axiscal.exceptions import AxiscalError
from tests.reliability import bad_files, changed, fuzz, power_loss, record_faults, set_faults, writers
from tests.reliability.trial import Trial


def test_a_fault_while_a_record_is_begun_leaves_none_or_a_whole_one() -> None:
    assert record_faults.begun().lost == 0


def test_reading_a_record_writes_nothing_so_that_a_full_or_read_only_disk_does_not_matter() -> None:
    assert record_faults.read().lost == 0


def test_a_fault_while_a_record_is_written_loses_nothing_acknowledged() -> None:
    trial = record_faults.written()
    assert (trial.lost, trial.tried > 40) == (0, True)


@pytest.mark.parametrize("first", [True, False])
def test_a_fault_while_results_are_written_leaves_a_whole_set(first: bool) -> None:
    trial: Trial = set_faults.alone(first)
    assert (trial.lost, trial.tried > 40) == (0, True)


def test_results_among_other_files_are_whole_where_there_is_a_manifest() -> None:
    trial = set_faults.with_others()
    assert (trial.lost, trial.tried > 40) == (0, True)


def test_no_bit_of_a_record_changes_unseen() -> None:
    trial = changed.bits(every=29)
    assert (trial.lost, trial.tried > 300) == (0, True)


def test_a_record_that_lacks_its_end_is_damaged() -> None:
    assert changed.ends().lost == 0


def test_lost_power_leaves_everything_that_was_acknowledged() -> None:
    assert power_loss.lost(150).lost == 0


def test_a_clock_that_goes_back_changes_no_order() -> None:
    assert changed.clock().lost == 0


def test_killed_writers_leave_everything_that_they_acknowledged_in_the_file_alone() -> None:
    assert writers.killed(10).lost == 0


def test_eight_processes_at_once_lose_and_double_nothing() -> None:
    assert writers.at_once(8, 10).lost == 0


def test_the_corpus_is_as_large_as_is_said() -> None:
    assert len(list(bad_files.corpus())) >= 300


@pytest.mark.parametrize("kind", bad_files.KINDS, ids=lambda kind: kind.name)
def test_a_file_changed_at_random_is_an_error_of_ours_or_still_good(kind: bad_files.Kind) -> None:
    fuzz.fuzzed(kind, 25)


@pytest.mark.parametrize("kind", bad_files.KINDS, ids=lambda kind: kind.name)
def test_a_bad_file_is_one_error_of_ours_or_still_good(kind: bad_files.Kind, tmp_path: Path) -> None:
    """Every way to spoil it that is small; the large ones are in `make reliability`, each with its time and memory."""
    refused = 0
    (tmp_path / "machine.toml").write_bytes(bad_files.KINDS[0].good)
    path = tmp_path / ("other.toml" if kind.name == "machine.toml" else kind.name)
    for spoil in bad_files.WAYS.values():
        content = spoil(kind.good)
        if len(content) < 50_000:
            path.write_bytes(content)
            try:
                kind.read(path)
            except AxiscalError as failure:
                refused += len(str(failure)) > 20
    assert refused > 10
