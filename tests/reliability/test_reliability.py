"""The trials of `make reliability`, in small."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest

from axiscal.exceptions import AxiscalError
from tests.reliability import (
    bad_files,
    changed,
    command_faults,
    forged,
    fuzz,
    power_loss,
    record_faults,
    salvaged,
    same_bytes,
    set_faults,
    store_clients,
    writers,
)
from tests.reliability.trial import Trial


def test_a_fault_while_a_record_is_begun_leaves_none_or_a_whole_one() -> None:
    assert record_faults.begun().lost == 0


def test_reading_a_record_writes_nothing_so_that_a_full_or_read_only_disk_does_not_matter() -> None:
    assert record_faults.read().lost == 0


@pytest.mark.parametrize("kind", bad_files.KINDS, ids=lambda kind: kind.name)
def test_a_number_of_any_length_is_refused_in_words_that_do_not_repeat_it(kind: bad_files.Kind, tmp_path: Path) -> None:
    """Python converts no whole number of more than 4,300 digits; of a table the line is named."""
    (tmp_path / "machine.toml").write_bytes(bad_files.KINDS[0].good)
    path = bad_files.place(kind, tmp_path)
    for number in list(re.finditer(rb"\d+", kind.good))[:30]:
        path.write_bytes(kind.good[: number.start()] + b"9" * 5000 + kind.good[number.end() :])
        try:
            kind.read(path)
        except AxiscalError as refused:
            text, line = str(refused), kind.good.count(b"\n", 0, number.start()) + 1
            assert not re.search(r"\d{61}|Exceeds the limit", text)
            assert "/" not in kind.name or f"{path.name}, line {line}: " in text


@pytest.mark.long
def test_a_fault_while_a_record_is_written_loses_nothing_acknowledged() -> None:
    trial = record_faults.written()
    assert (trial.lost, trial.tried > 40) == (0, True)


@pytest.mark.long
@pytest.mark.parametrize("first", [True, False])
def test_a_fault_while_results_are_written_leaves_a_whole_set(first: bool) -> None:
    trial: Trial = set_faults.alone(first)
    assert (trial.lost, trial.tried > 40) == (0, True)


@pytest.mark.long
def test_results_among_other_files_are_whole_where_there_is_a_manifest() -> None:
    trial = set_faults.with_others()
    assert (trial.lost, trial.tried > 40) == (0, True)


@pytest.mark.long
@pytest.mark.parametrize(("command", "every"), [("start", 5), ("init", 7), ("export, over earlier tables", 17)])
def test_a_fault_in_a_command_loses_nothing_and_blocks_nothing(command: str, every: int) -> None:
    trial = command_faults.tried(command, every)
    assert (trial.lost, trial.detail, trial.tried > 4) == (0, "", True)


@pytest.mark.long
def test_a_kill_while_a_record_is_brought_leaves_nothing_behind_its_second_try() -> None:
    trial = command_faults.tried("bring", hows=("kill",))
    assert (trial.lost, trial.detail, trial.tried > 4) == (0, "", True)


def test_no_bit_of_a_record_changes_unseen() -> None:
    trial = changed.bits(every=29)
    assert (trial.lost, trial.tried > 300) == (0, True)


def test_a_record_that_lacks_its_end_is_damaged() -> None:
    assert changed.ends().lost == 0


@pytest.mark.parametrize("name", salvaged.DAMAGES)
def test_what_stands_whole_in_a_damaged_record_comes_back(name: str) -> None:
    trial = salvaged.tried(name, 3)
    assert (trial.lost, trial.tried) == (0, 3), trial.detail


def test_who_has_no_key_changes_no_signed_record_unseen() -> None:
    trial = forged.tried(60)
    assert (trial.lost, trial.tried) == (0, 60 + 6 + 33)


@pytest.mark.long
def test_lost_power_leaves_everything_that_was_acknowledged() -> None:
    assert power_loss.lost(150).lost == 0


def test_a_clock_that_goes_back_changes_no_order() -> None:
    assert changed.clock().lost == 0


def test_killed_writers_leave_everything_that_they_acknowledged_in_the_file_alone() -> None:
    trial = writers.killed(20)
    assert (trial.lost, trial.detail.startswith("0 ")) == (0, False)


def test_eight_processes_at_once_lose_and_double_nothing() -> None:
    assert writers.at_once(8, 10).lost == 0


@pytest.mark.long
def test_clients_of_a_store_whose_connections_are_cut_lose_and_double_nothing() -> None:
    trial = store_clients.clients(2, 6)
    assert (trial.lost, trial.tried > 10) == (0, True), trial.detail


@pytest.mark.long
def test_statements_of_a_measurer_stop_nobody_else() -> None:
    trial = store_clients.statements(40)
    assert trial.lost == 0, trial.detail


def test_the_corpus_is_as_large_as_is_said() -> None:
    assert len(list(bad_files.corpus())) >= 300


FEWER = {"linuxcnc/X.comp": 8}
"""LinuxCNC itself passes over rows of a table that it cannot read, and what it makes of the rest is what counts."""


@pytest.mark.parametrize("kind", bad_files.KINDS, ids=lambda kind: kind.name)
def test_a_file_changed_at_random_is_an_error_of_ours_or_still_good(kind: bad_files.Kind) -> None:
    fuzz.fuzzed(kind, 25)


def test_a_file_that_takes_a_processor_too_long_is_a_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fuzz, "MOST", 0.0)
    with pytest.raises(AssertionError, match="s of a processor"):
        fuzz.fuzzed(bad_files.KINDS[0], 1)


@pytest.mark.parametrize("kind", bad_files.KINDS, ids=lambda kind: kind.name)
def test_a_bad_file_is_one_error_of_ours_or_still_good(kind: bad_files.Kind, tmp_path: Path) -> None:
    """Every way to spoil it that is small; the large ones are in `make reliability`, each with its time and memory."""
    refused = 0
    (tmp_path / "machine.toml").write_bytes(bad_files.KINDS[0].good)
    path = bad_files.place(kind, tmp_path)
    for spoil in bad_files.WAYS.values():
        content = spoil(kind.good)
        if len(content) < 50_000:
            path.write_bytes(content)
            try:
                kind.read(path)
            except AxiscalError as failure:
                refused += len(str(failure)) > 20
    assert refused > FEWER.get(kind.name, 10)


@pytest.mark.long
def test_other_surroundings_give_the_same_bytes(monkeypatch: pytest.MonkeyPatch) -> None:
    def few(_seeds: int, _folder: Path) -> Iterator[same_bytes.Surroundings]:
        yield same_bytes.Surroundings(
            "all", {"PYTHONHASHSEED": "7", "TZ": "Asia/Kathmandu", "OPENBLAS_NUM_THREADS": "2"}
        )

    monkeypatch.setattr(same_bytes, "CAMPAIGNS", ("printer",))
    monkeypatch.setattr(same_bytes, "_variables", few)
    trial = same_bytes.compared(long=False)
    assert (trial.tried, trial.lost) == (1, 0)


def test_surroundings_that_give_other_bytes_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def texts(place: same_bytes.Surroundings) -> list[Mapping[str, str]]:
        return [{"table.csv": "1,5" if place.name == "locale de_DE" else "1.5"}]

    monkeypatch.setattr(same_bytes, "_texts", texts)
    monkeypatch.setattr(same_bytes, "installed", lambda _name, _folder: True)
    trial = same_bytes.compared(long=True)
    assert (trial.tried, trial.lost, trial.detail) == (21 + 3 + 3 + 2, 1, "other bytes: locale de_DE")


def test_a_language_that_is_tried_is_really_spoken(tmp_path: Path) -> None:
    if not same_bytes.installed("de_DE", tmp_path):
        pytest.skip("needs Debian's locales")
    said = "import locale; locale.setlocale(locale.LC_ALL, ''); print(locale.localeconv()['decimal_point'])"
    env = {"LOCPATH": str(tmp_path), "LC_ALL": "de_DE.UTF-8"}
    run = subprocess.run([sys.executable, "-c", said], env=env, capture_output=True, text=True, check=True)
    assert run.stdout.strip() == ","
