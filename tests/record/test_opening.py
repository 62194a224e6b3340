"""Which records a name means: a file, a folder of them, a campaign of the store, or all of it."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path

import pytest

from axiscal.exceptions import RecordError
from axiscal.record import copies
from axiscal.record.copies import carried_text, file_name, gathered, is_store, is_stored, opened_log, records_of

THERE = [Path("store:one"), Path("store:two")]


@pytest.fixture
def shop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a folder of two records and something else, beside a store of two campaigns."""
    for name in ("b.axiscal", "a.axiscal", "notes.txt"):
        (tmp_path / name).write_text("")

    def part(name: str) -> Callable[[], AbstractContextManager[list[tuple[Path, None]]]]:
        assert name == "server-logs"
        return lambda: nullcontext([(path, None) for path in THERE])

    monkeypatch.setattr(copies, "part", part)
    return tmp_path


def test_a_campaign_of_the_store_begins_with_its_word(tmp_path: Path) -> None:
    assert [is_stored(name) for name in ("store:mill", Path("store:mill"), "mill", "my store:mill")] == [
        True, True, False, False,
    ]  # fmt: skip
    assert [is_store(Path(name)) for name in ("store:", "store:mill", "store")] == [True, False, False]
    assert file_name(Path("store:mill")) == Path("mill.axiscal")
    assert file_name(tmp_path / "mill.cal") == tmp_path / "mill.cal"
    for nameless in ("store:", "store:  "):
        with pytest.raises(RecordError, match="No campaign of the store is named"):
            opened_log(nameless)


def test_a_folder_means_its_records_in_order_and_the_store_all_of_its_campaigns(shop: Path) -> None:
    inside, other = [shop / "a.axiscal", shop / "b.axiscal"], shop / "else.cal"
    assert gathered([shop]) == inside
    assert gathered([other, Path("store:three"), shop, Path("store:")]) == [
        other, Path("store:three"), *inside, *THERE,
    ]  # fmt: skip
    assert records_of(shop) == inside
    assert records_of(Path("store:")) == THERE
    for none in (shop / "nowhere", shop / "notes.txt", Path("store:one")):
        with pytest.raises(RecordError, match="This is no folder"):
            records_of(none)


def test_what_a_type_has_taught_is_carried_as_it_is_and_all_else_is_a_record(tmp_path: Path) -> None:
    file, text = tmp_path / "type.json", '{"schema": "axiscal-type/1", "of": "Fräse"}\n'
    file.write_text(text, encoding="utf-8")
    assert carried_text(file) == text
    file.write_bytes(text.encode() + b"\xff")
    with pytest.raises(RecordError, match="The file of the type is damaged"):
        carried_text(file)
    for other in (" " + text, '{"schema": "axiscal-result/1"}', "{" + 200 * " " + text):
        file.write_text(other, encoding="utf-8")
        with pytest.raises(RecordError, match="not a campaign record"):
            carried_text(file)
    with pytest.raises(RecordError):
        carried_text(tmp_path / "nowhere")
