"""The table of results."""

from __future__ import annotations

import csv
from pathlib import Path

from axiscal.ports.study.results import rows_of, write_table
from axiscal.ports.study.study_case import Done
from axiscal.ports.study.study_file import read_study
from tests.ports.texts import STUDY, written

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
