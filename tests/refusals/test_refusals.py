"""What is wrong is refused in just the sentence that stands beside it: place, fault and remedy, on printable lines."""

from dataclasses import replace

import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.document.gone import GoneKind, gone
from axiscal.machine import load_machine
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


@pytest.mark.parametrize(("kind", "name"), [(kind, name) for kind, sentences in gone().items() for name in sentences])
def test_all_that_is_gone_is_refused_with_what_to_use_instead(kind: GoneKind, name: str) -> None:
    last = name.rpartition(".")[2]
    assert any(f"{last} is gone. {gone()[kind][name]}." in row.says for row in refusals("gone").rows if row.of == kind)


@pytest.mark.parametrize("row", [row for row in refusals("gone").rows if row.of == "keys"], ids=lambda row: row.wrong)
def test_a_record_with_a_key_that_is_gone_opens_as_without_it(row: Row) -> None:
    with_it, without = (
        campaign_from_texts(text, "campaign.toml", load_machine("one-axis").text, "one-axis")
        for text in (refusals("gone").text(row), refusals("gone").texts["keys"])
    )
    assert without == replace(with_it, text=without.text) != with_it


def test_every_kind_of_file_has_rows() -> None:
    titles = {row.of.partition(", of")[0] for row in refusals("files").rows}
    assert {kind.title for kind in FORMATS} - {"a file of laser software"} <= titles


def test_every_reader_of_old_tables_has_rows() -> None:
    takers = {name for name in controllers() if "--on-top-of" in exporter(name).takes}
    assert takers <= {row.of.split()[0] for row in refusals("old_table").rows}
