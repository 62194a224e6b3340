"""What is wrong is refused in just the sentence that stands beside it: place, fault and remedy, on printable lines."""

from __future__ import annotations

import pytest

from axiscal.measurement.readers.files import FORMATS
from axiscal.tables.registry import controllers, exporter
from tests.refusals.reading import BESIDE, Row, kinds, refusals, said

ROWS = [(kind, row) for kind in kinds() for row in refusals(kind).rows]


@pytest.mark.parametrize(("kind", "row"), ROWS, ids=[f"{kind}-{row.wrong[:40]!a}" for kind, row in ROWS])
def test_what_is_wrong_is_refused_in_these_words(kind: str, row: Row) -> None:
    assert said(kind, row.of, refusals(kind).text(row)) == row.says != ""
    _, *others = row.says.splitlines()
    assert all(line.startswith(("- ", "And ")) for line in others)
    assert row.says.replace("\n", "").isprintable()


@pytest.mark.parametrize("kind", kinds())
def test_what_the_rows_spoil_is_right(kind: str) -> None:
    spoilt = {name: text for name, text in refusals(kind).texts.items() if text and not name.endswith(BESIDE)}
    assert [f"{name}: {fault}" for name, text in spoilt.items() if (fault := said(kind, name, text))] == []


def test_every_kind_of_file_has_rows() -> None:
    titles = {row.of.partition(", of")[0] for row in refusals("files").rows}
    assert {kind.title for kind in FORMATS} - {"a file of laser software"} <= titles


def test_every_reader_of_old_tables_has_rows() -> None:
    takers = {name for name in controllers() if "--on-top-of" in exporter(name).takes}
    assert takers <= {row.of.split()[0] for row in refusals("old_table").rows}
