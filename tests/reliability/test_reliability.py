"""The trials of `make reliability`, in small."""

import re
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from axiscal.exceptions import AxiscalError
from benchmarks.reliability import (
    bad_files,
    changed,
    command_faults,
    damages,
    forged,
    fuzz,
    record_faults,
    set_faults,
    writers,
)
from benchmarks.reliability.trial import Trial

TRIALS: dict[str, tuple[Callable[[], Trial], int]] = {
    "a record is begun": (record_faults.begun, 10),
    "a record is read": (record_faults.read, 0),
    "bits of a record": (lambda: changed.bits(every=29), 300),
    "ends of a record": (changed.ends, 300),
    "a clock that goes back": (changed.clock, 4),
    **{f"damaged: {name}": (partial(damages.tried, name, 1, n), 0) for n, name in enumerate(damages.DAMAGES)},
    "signed records": (lambda: forged.tried(60), 60 + 6 + 32),
    "killed writers": (lambda: writers.killed(20), 19),
    "writers at once": (lambda: writers.at_once(8, 10), 79),
}
LONG: dict[str, tuple[Callable[[], Trial], int]] = {
    "a record is written": (record_faults.written, 40),
    "results over earlier ones": (lambda: set_faults.alone(False), 40),
    "start": (lambda: command_faults.tried("start", 5), 4),
}
"""In small, and more than how many have to be tried."""


@pytest.mark.parametrize(
    ("tried", "most"),
    [
        *(pytest.param(*each, id=name) for name, each in TRIALS.items()),
        *(pytest.param(*each, id=name, marks=pytest.mark.long) for name, each in LONG.items()),
    ],
)
def test_nothing_is_lost_or_wrong(tried: Callable[[], Trial], most: int) -> None:
    trial = tried()
    assert trial.lost == 0, trial
    assert trial.tried > most


@pytest.mark.parametrize("kind", bad_files.KINDS, ids=str)
def test_a_number_of_any_length_is_refused_in_words_that_do_not_repeat_it(kind: bad_files.Kind, tmp_path: Path) -> None:
    """Python converts no whole number of more than 4,300 digits; of a table the line is named."""
    path = bad_files.place(kind, tmp_path)
    for number in list(re.finditer(rb"\d+", kind.good))[:10]:
        path.write_bytes(kind.good[: number.start()] + b"9" * 5000 + kind.good[number.end() :])
        try:
            kind.read(path)
        except AxiscalError as refused:
            text, line = str(refused), kind.good.count(b"\n", 0, number.start()) + 1
            assert not re.search(r"\d{61}|Exceeds the limit", text)
            assert "/" not in kind.name or f"{path.name}, line {line}: " in text


FEWER = {"linuxcnc/X.comp": 8, "a Marlin map (M420 V)": 8, "touches as a firmware printed them, of grbl": 8}
"""LinuxCNC itself passes over rows of a table that it cannot read, and a log holds other lines than those of a map."""


@pytest.mark.parametrize("kind", bad_files.KINDS, ids=str)
def test_a_file_changed_at_random_is_an_error_of_ours_or_still_good(kind: bad_files.Kind) -> None:
    fuzz.fuzzed(kind, 25)


@pytest.mark.parametrize("kind", bad_files.KINDS, ids=str)
def test_a_bad_file_is_one_error_of_ours_or_still_good(kind: bad_files.Kind, tmp_path: Path) -> None:
    """Every way to spoil it that is small; the large ones are in `make reliability`, each with its time and memory."""
    refused = 0
    path = bad_files.place(kind, tmp_path)
    for spoil in bad_files.WAYS.values():
        content = spoil(kind.good)
        if len(content) < 50_000:
            path.write_bytes(content)
            try:
                kind.read(path)
            except AxiscalError as failure:
                refused += len(str(failure)) > 20
    assert refused > FEWER.get(str(kind), 10)
