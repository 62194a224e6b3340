"""The trials of `make reliability`, in small."""

from __future__ import annotations

import pytest

from tests.reliability import record_faults, set_faults
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
