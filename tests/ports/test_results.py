"""The database of results: each case once, one head at a time, nothing of another study."""

from __future__ import annotations

import re
import shlex
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from axiscal.exceptions import StudyError
from axiscal.ports.study import results as results_module
from axiscal.ports.study.results import FILE, Results
from axiscal.ports.study.study_case import Done

ONE = {"axiscal": "1"}


def _opened(folder: Path, digest: str = "d", resume: bool = False, versions: dict[str, str] = ONE) -> Results:
    return Results(folder, "text", digest, versions, resume)


def test_a_case_is_kept_once_and_is_there_when_opened_again(tmp_path: Path) -> None:
    with _opened(tmp_path) as results:
        results.keep(Done("a", {"U_um": 0.1}))
        results.keep(Done("a", {"U_um": 0.2}))
        results.keep(Done("b", None, "wrong"))
    with _opened(tmp_path, resume=True) as results:
        assert results.keys() == {"a", "b"}
        assert results.all() == {"a": Done("a", {"U_um": 0.1}), "b": Done("b", None, "wrong")}


def test_one_that_was_ended_at_its_beginning_is_begun_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def ended(value: object) -> str:
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(results_module, "canonical", ended)
        with pytest.raises(KeyboardInterrupt):
            _opened(tmp_path)
    with _opened(tmp_path, resume=True) as results:
        assert results.keys() == set()


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
        assert results.keys() == {"a"}


def test_two_heads_do_not_work_in_one_folder(tmp_path: Path) -> None:
    with _opened(tmp_path), pytest.raises(StudyError, match="Another process works on the study"):
        _opened(tmp_path, resume=True)
    with _opened(tmp_path, resume=True):
        pass


def test_a_file_that_is_no_database_is_refused_in_a_sentence(tmp_path: Path) -> None:
    (tmp_path / FILE).write_bytes(b"no database at all, " * 100)
    with pytest.raises(StudyError, match="cannot be read"):
        _opened(tmp_path, resume=True)


def test_a_byte_in_its_table_of_tables_that_is_no_text_is_said_in_a_sentence(tmp_path: Path) -> None:
    with _opened(tmp_path):
        pass
    file = tmp_path / FILE
    file.write_bytes(file.read_bytes().replace(b"tablecasescases", b"tablec\xe1sescases"))
    with pytest.raises(StudyError, match="cannot be read"):
        _opened(tmp_path, resume=True)


def test_another_database_is_left_alone(tmp_path: Path) -> None:
    with closing(sqlite3.connect(tmp_path / FILE)) as database:
        database.execute("CREATE TABLE mine (x)")
    with pytest.raises(StudyError, match="no database of a study"):
        _opened(tmp_path, resume=True)


@pytest.mark.parametrize(
    "change",
    [
        *("DELETE FROM study", "INSERT INTO study SELECT * FROM study"),
        *(f"UPDATE study SET versions = {value}" for value in ("''", "'1'", "'[]'", "7", "x'ff'", "'[' || versions")),
        *(f"UPDATE cases SET result = {value}" for value in ("''", "'null'", "'1'", "'[]'", "7", "x'ff'", "'{\"a\":'")),
        *(
            f"""UPDATE cases SET result = '{{"U_um":{value}}}'"""
            for value in ("NaN", "1e999", "[]", "{}", "1" + 400 * "0")
        ),
        "UPDATE cases SET error = x'ff'",
        "UPDATE cases SET key = x'ff'",
    ],
)
def test_what_is_no_result_is_refused_in_a_sentence(tmp_path: Path, change: str) -> None:
    with _opened(tmp_path) as results:
        results.keep(Done("a", {"U_um": 0.1, "agreement": "agree", "reached": True, "said": None}))
    with closing(sqlite3.connect(tmp_path / FILE, isolation_level=None)) as database:
        database.execute(change)
    said = "cannot be read|is not the one that was kept"
    with pytest.raises(StudyError, match=said), _opened(tmp_path, resume=True) as results:
        results.all()


@pytest.mark.parametrize(
    "change",
    [
        """result = '{"U_um":0.2}'""",
        """result = '{"U_um":0.1,"said":"so"}'""",
        "result = CAST(x'7b22555f756d223a302e317dff' AS TEXT)",
        "result = NULL",
        "error = 'it did not end'",
        "key = 'c'",
        "digest = (SELECT digest FROM cases WHERE key = 'b')",
    ],
)
def test_a_changed_result_is_not_believed_and_can_be_worked_on_again(tmp_path: Path, change: str) -> None:
    folder = tmp_path / "two words"
    with _opened(folder) as results:
        results.keep(Done("a", {"U_um": 0.1}))
        results.keep(Done("b", {"U_um": 0.3}))
    with closing(sqlite3.connect(folder / FILE, isolation_level=None)) as database:
        database.execute(f"UPDATE cases SET {change} WHERE key = 'a'")
    with (
        pytest.raises(StudyError, match="is not the one that was kept") as caught,
        _opened(folder, resume=True) as it,
    ):
        it.all()
    found = re.search("by `(sqlite3 .*?)`", str(caught.value))
    assert found is not None
    _, file, change_back = shlex.split(found[1])
    with closing(sqlite3.connect(file, isolation_level=None)) as database:
        database.execute(change_back)
    with _opened(folder, resume=True) as results:
        assert results.keys() <= {"b"}


def test_a_case_without_a_digest_is_not_believed(tmp_path: Path) -> None:
    with _opened(tmp_path) as results:
        results.keep(Done("a", {"U_um": 0.1}))
    with closing(sqlite3.connect(tmp_path / FILE, isolation_level=None)) as database:
        database.execute("UPDATE cases SET digest = NULL")
    with pytest.raises(StudyError, match="Name another folder"), _opened(tmp_path, resume=True) as results:
        results.all()


def test_results_that_were_begun_before_cases_had_digests_go_on_and_are_held_from_then_on(tmp_path: Path) -> None:
    kept = {"a": Done("a", {"U_um": 0.1, "agreement": "für"}), "b": Done("b", None, "wrong")}
    with _opened(tmp_path) as results:
        for done in kept.values():
            results.keep(done)
    with closing(sqlite3.connect(tmp_path / FILE, isolation_level=None)) as database:
        database.execute("ALTER TABLE cases DROP COLUMN digest")
    for _ in range(2):
        with _opened(tmp_path, resume=True) as results:
            assert results.all() == kept
    with closing(sqlite3.connect(tmp_path / FILE, isolation_level=None)) as database:
        database.execute("""UPDATE cases SET result = '{"U_um":0.2}' WHERE key = 'a'""")
    with pytest.raises(StudyError, match="is not the one that was kept"), _opened(tmp_path, resume=True) as results:
        results.all()


def test_a_database_that_is_full_is_said(tmp_path: Path) -> None:
    with _opened(tmp_path) as results:
        results._database.execute("PRAGMA max_page_count = 6")
        with pytest.raises(StudyError, match="cannot be written"):
            _keep_many(results)
        kept = results.keys()
    with _opened(tmp_path, resume=True) as results:
        assert results.keys() == kept


def _keep_many(results: Results) -> None:
    for number in range(1000):
        results.keep(Done(str(number), {"said": "x" * 1000}))
