"""Results in a folder that holds other things as well: those stay, whatever a manifest there says."""

import json
from pathlib import Path

import pytest

from axiscal.present.result_set import MANIFEST
from benchmarks.reliability.set_faults import content, of_age, write_set


def everything(folder: Path) -> dict[str, bytes]:
    """Return all files below a folder, by name."""
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize("place", ["mine.txt", "tables/mine.txt", "tables/csv/mine.txt", "data/mine.txt"])
def test_a_file_of_somebody_stays_wherever_it_lies_among_the_results(tmp_path: Path, place: str) -> None:
    out = tmp_path / "out"
    write_set(out, "old")
    (out / place).parent.mkdir(exist_ok=True)
    (out / place).write_text("mine")
    write_set(out, "new")
    assert (out / place).read_text() == "mine"
    assert content(out) == of_age("new")  # and nothing of the earlier set


@pytest.mark.parametrize(
    "name",
    [
        "../victim.txt",
        "tables/../../victim.txt",
        "..\\victim.txt",
        "{top}/victim.txt",
        "C:/victim.txt",
        "mill.axiscal",
        "",
        "\0",
        "nothing/here.txt",
        "tables/csv",
    ],
)
def test_a_manifest_removes_nothing_but_files_of_a_set(tmp_path: Path, name: str) -> None:
    out = tmp_path / "out"
    write_set(out, "old")
    for mine in (out / "mine.txt", out / "mill.axiscal", tmp_path / "victim.txt", out / "..\\victim.txt"):
        mine.write_text("mine")
    before = everything(tmp_path).keys()
    manifest = json.loads((out / MANIFEST).read_text())
    manifest["files"][name.format(top=tmp_path)] = ""
    (out / MANIFEST).write_text(json.dumps(manifest))
    write_set(out, "old")
    assert everything(tmp_path).keys() == before


@pytest.mark.parametrize(
    "manifest",
    [
        '{"files": {"mine.txt": ""}}',
        '{"schema": "axiscal-manifest/1", "files": [["mine.txt"]]}',
        '{"schema": "axiscal-manifest/1"}',
        '["mine.txt"]',
        "no JSON",
        100_000 * "[",
    ],
)
def test_what_is_no_manifest_of_ours_removes_nothing(tmp_path: Path, manifest: str) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    (tmp_path / MANIFEST).write_text(manifest)
    write_set(tmp_path, "new")
    assert (tmp_path / "mine.txt").read_text() == "mine"
    assert content(tmp_path) == of_age("new")


def test_what_stands_in_the_place_of_a_result_is_named_and_all_is_as_before(tmp_path: Path) -> None:
    out = tmp_path / "out"
    write_set(out, "old")
    (out / "mine.txt").write_text("mine")
    (out / "tables" / "csv" / "new.csv").mkdir()
    (out / "tables" / "csv" / "new.csv" / "mine.txt").write_text("mine")
    before = everything(tmp_path)
    with pytest.raises(IsADirectoryError, match=r"new\.csv"):
        write_set(out, "new")
    assert everything(tmp_path) == before
    other = tmp_path / "other"
    other.mkdir()
    (other / "tables").write_text("mine")
    before = everything(tmp_path)
    with pytest.raises(NotADirectoryError, match="tables"):
        write_set(other, "new")
    assert everything(tmp_path) == before
