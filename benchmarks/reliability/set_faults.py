"""Faults while results are written: the manifest never says what is not so, and the next try works."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

from axiscal.present.result import RecordState
from axiscal.present.result_set import MANIFEST, result_set, write_manifest
from benchmarks.reliability.faults import faults
from benchmarks.reliability.trial import Say, Trial, scratch

NAMES = ("result.json", "tables/linuxcnc/X.comp", "tables/csv/X.csv")
_MINE = ("mine.txt", "tables/mine.txt")
Content = Mapping[str, str]


def write_set(folder: Path, age: str) -> None:
    """Write results that tell their age."""
    with result_set(folder) as inside:
        for name in (*NAMES, f"tables/csv/{age}.csv"):
            (inside / name).parent.mkdir(parents=True, exist_ok=True)
            (inside / name).write_text(age)
        write_manifest(inside, RecordState(file="mill.axiscal", event=3, hash=64 * "0"), {"axiscal": age})


def content(folder: Path) -> Content:
    """Return the results in a folder, by name."""
    found = (path for path in folder.rglob("*") if path.is_file() and path.name not in (MANIFEST, "mine.txt"))
    return {path.relative_to(folder).as_posix(): path.read_text() for path in found}


def of_age(age: str) -> Content:
    """Return what `write_set` writes."""
    return dict.fromkeys((*NAMES, f"tables/csv/{age}.csv"), age)


def alone(first: bool) -> Trial:
    """Write results into a folder of their own, for the first time or over an earlier set."""
    what = "faults while results are written" + (" for the first time" if first else " over an earlier set")
    return _tried(what, () if first else NAMES, ())


def with_others() -> Trial:
    """Write results into a folder that holds files of somebody."""
    return _tried("the same in a folder with other files", NAMES, _MINE)


def _tried(what: str, earlier: tuple[str, ...], mine: tuple[str, ...]) -> Trial:
    def work(folder: Path, say: Say) -> None:
        write_set(folder / "out", "new")
        say("done")

    def lost(folder: Path, said: tuple[str, ...]) -> bool:
        out = folder / "out"
        wrong = "done" in said and content(out) != of_age("new")
        wrong |= not _agrees(out) or any((out / name).read_text() != "mine" for name in mine)
        write_set(out, "again")
        left = [path.name for path in (*folder.iterdir(), *out.iterdir()) if path.name.startswith(".")]
        return wrong or content(out) != of_age("again") or bool(left)

    with scratch() as top:
        before = top / "before"
        before.mkdir()
        if earlier:
            write_set(before / "out", "old")
        for name in mine:
            (before / "out" / name).write_text("mine")
        outcomes = [lost(top / "now", outcome.said) for _, outcome in faults(before, top / "now", work)]
    return Trial(what, len(outcomes), sum(outcomes))


def _agrees(out: Path) -> bool:
    """Whether all that a manifest names is of its age, and there; where there is none, nothing is said."""
    if not (out / MANIFEST).exists():
        return True
    manifest = json.loads((out / MANIFEST).read_text())
    age = manifest["versions"]["axiscal"]
    return all((out / name).exists() and (out / name).read_text() == age for name in manifest["files"])
