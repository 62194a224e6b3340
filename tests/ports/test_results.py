"""The file of results and their table: each case once, one head at a time, nothing of another study."""

from __future__ import annotations

import csv
import errno
import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.exceptions import StudyError
from axiscal.ports.study import results as results_module
from axiscal.ports.study.results import FILE, Results, rows_of, write_table
from axiscal.ports.study.study_case import Done
from axiscal.ports.study.study_file import read_study
from tests.ports.texts import STUDY, written

ONE = {"axiscal": "1"}


def _opened(folder: Path, digest: str = "d", resume: bool = False, versions: dict[str, str] = ONE) -> Results:
    return Results(folder, "text", digest, versions, resume)


def test_a_case_is_kept_once_and_is_there_when_opened_again(tmp_path: Path) -> None:
    with _opened(tmp_path) as results:
        results.keep(Done("a", {"U_um": 0.1}))
        results.keep(Done("a", {"U_um": 0.2}))
        results.keep(Done("b", None, "wrong"))
    with _opened(tmp_path, resume=True) as results:
        assert results.found.keys() == {"a", "b"}
        assert dict(results.found) == {"a": Done("a", {"U_um": 0.1}), "b": Done("b", None, "wrong")}


def test_a_folder_without_results_needs_no_resume(tmp_path: Path) -> None:
    for _ in range(2):
        with _opened(tmp_path / "deep" / "er"):
            pass


@pytest.mark.parametrize(
    ("digest", "resume", "versions", "said"),
    [
        ("d", False, ONE, "holds a study already"),
        ("other", True, ONE, "has been changed since"),
        ("other", False, ONE, "holds a study already"),
        ("d", True, {"axiscal": "2"}, "begun with axiscal 1, and this is 2"),
    ],
)
def test_results_of_another_study_are_refused(
    tmp_path: Path, digest: str, resume: bool, versions: dict[str, str], said: str
) -> None:
    with _opened(tmp_path) as results:
        results.keep(Done("a", {}))
    with pytest.raises(StudyError, match=said):
        _opened(tmp_path, digest, resume, versions)
    with _opened(tmp_path, resume=True) as results:
        assert results.found.keys() == {"a"}


def test_two_heads_do_not_work_in_one_folder(tmp_path: Path) -> None:
    with _opened(tmp_path), pytest.raises(StudyError, match="Another process works on the study"):
        _opened(tmp_path, resume=True)
    with _opened(tmp_path, resume=True):
        pass


@pytest.mark.parametrize(
    "content", [b"", b"\n", b"no results at all, " * 100, b"[1]\n", b"\xff\n", b'{"digest":"d"}\n']
)
def test_another_file_is_left_alone_and_said_in_a_sentence(tmp_path: Path, content: bytes) -> None:
    (tmp_path / FILE).write_bytes(content)
    with pytest.raises(StudyError, match="cannot be read of which study"):
        _opened(tmp_path, resume=True)
    assert (tmp_path / FILE).read_bytes() == content


KEPT = {
    "a": Done("a", {"U_um": 0.1, "agreement": "für", "reached": True, "said": None}),
    "b": Done("b", None, "wrong: \udcff \u2028"),
    "c": Done("c", {"U_um": 0.3}),
}


def _all_kept(folder: Path) -> bytes:
    """Return the file of three cases."""
    with _opened(folder) as results:
        for done in KEPT.values():
            results.keep(done)
    return (folder / FILE).read_bytes()


@given(at=st.integers(0, 10**6), bit=st.integers(0, 7))
def test_a_changed_line_is_no_result_and_its_case_is_worked_on_again(
    tmp_path_factory: pytest.TempPathFactory, at: int, bit: int
) -> None:
    folder = tmp_path_factory.mktemp("study")
    whole = _all_kept(folder)
    first = whole.index(b"\n") + 1
    changed, at = bytearray(whole), first + at % (len(whole) - first)
    changed[at] ^= 1 << bit
    (folder / FILE).write_bytes(changed)
    with _opened(folder, resume=True) as results:
        left = dict(results.found)
        assert left.items() <= KEPT.items()
        assert len(left) >= 1
        for done in KEPT.values():
            results.keep(done)
    with _opened(folder, resume=True) as results:
        assert dict(results.found) == KEPT


def test_a_file_that_was_cut_off_anywhere_goes_on(tmp_path: Path) -> None:
    whole = _all_kept(tmp_path)
    for end in range(whole.index(b"\n") + 1, len(whole)):
        (tmp_path / FILE).write_bytes(whole[:end])
        with _opened(tmp_path, resume=True) as results:
            assert len(results.found) == whole[:end].count(b"\n") - 1
            for done in KEPT.values():
                results.keep(done)
        assert (tmp_path / FILE).read_bytes() == whole


@pytest.mark.parametrize("value", ["NaN", "1e999", "1" + 5000 * "0"])
def test_what_json_cannot_say_is_no_result(tmp_path: Path, value: str) -> None:
    _all_kept(tmp_path)
    with (tmp_path / FILE).open("a") as file:
        file.write(f'{{"key":"d","result":{{"U_um":{value}}},"error":"","sha256":""}}\n')
    with _opened(tmp_path, resume=True) as results:
        assert dict(results.found) == KEPT


def test_a_disk_that_is_full_is_said_and_nothing_half_is_believed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(handle: int, offset: int, content: bytes) -> None:
        os.pwrite(handle, content[: len(content) // 2], offset)
        raise OSError(errno.ENOSPC, "No space left on device")

    with _opened(tmp_path) as results:
        results.keep(KEPT["a"])
        with monkeypatch.context() as patched:
            patched.setattr(results_module, "write_at", full)
            with pytest.raises(StudyError, match="cannot be written: No space left"):
                results.keep(KEPT["c"])
        assert results.found.keys() == {"a"}
        results.keep(KEPT["b"])
    with _opened(tmp_path, resume=True) as results:
        assert dict(results.found) == {key: KEPT[key] for key in "ab"}


TEXT = STUDY.replace("machines = 2", "machines = 4\nseed = 4")


def test_rows_are_in_the_order_of_the_study(tmp_path: Path) -> None:
    study = read_study(written(tmp_path, TEXT))
    keys = [case.key for case in study.cases()]
    found = {key: Done(key, {"U_um": 0.1 * n, "said": "drift"}) for n, key in enumerate(keys)}
    rows = rows_of(study, dict(reversed(found.items())))
    assert [row["U_um"] for row in rows] == [0.1 * n for n in range(8)]
    assert [row["machine"] for row in rows] == [0, 1, 2, 3] * 2


def test_the_table_holds_every_case_and_what_was_wrong(tmp_path: Path) -> None:
    study = read_study(written(tmp_path, TEXT))
    first, second, *_ = (case.key for case in study.cases())
    found = {first: Done(first, {"U_um": 1.25, "said": ""}), second: Done(second, None, 'no "place", at all')}
    path = write_table(tmp_path, rows_of(study, found))
    assert path.name == "cases.csv"
    rows = list(csv.DictReader(path.read_text().splitlines()))
    assert (rows[0]["U_um"], rows[1]["U_um"]) == ("1.25", "")
    assert [row["error"] for row in rows] == ["", 'no "place", at all']
    assert rows[0]["setups"] == '["laser"]'
