"""Faults while results are written: whoever looks finds the earlier set or the new one, and the next try works."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

from axiscal.document.durable import exchanged
from axiscal.present.result import RecordState
from axiscal.present.result_set import MANIFEST, mend, result_set, write_manifest
from benchmarks.reliability.faults import faults
from benchmarks.reliability.trial import Say, Trial, scratch

NAMES = ("result.json", "tables/linuxcnc/X.comp", "tables/csv/X.csv")
_MINE = ("mine.txt", "tables/mine.txt")
Content = Mapping[str, str]


def write_set(folder: Path, age: str, live: Path | None = None) -> None:
    """Write results that tell their age.  live : a record in the folder that stays"""
    with result_set(folder, live=live) as inside:
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
    whole = ({}, of_age("new")) if first else (of_age("old"), of_age("new"))
    return _tried(what, first, beside=False, allowed=whole)


def with_others() -> Trial:
    """Write results into a folder that holds a file of somebody: then it is the manifest that says what is whole."""
    return _tried("the same in a folder with other files, by the manifest", False, beside=True, allowed=())


def _tried(what: str, first: bool, beside: bool, allowed: tuple[Content, ...]) -> Trial:
    def work(folder: Path, say: Say) -> None:
        write_set(folder / "out", "new")
        say("done")

    def lost(folder: Path, said: tuple[str, ...]) -> bool:
        out = folder / "out"
        if not (first or out.exists() or in_one_step):
            mend(out)
            put_back.append(out)
        found = content(out) if out.exists() else {}
        wrong = ("done" in said and found != of_age("new")) or bool(allowed and found not in allowed)
        if beside:
            wrong |= (out / MANIFEST).exists() and not _agrees(out)
            mend(out)  # and then no new set comes
            wrong |= (out / MANIFEST).exists() and not _agrees(out)
            wrong |= any((out / name).read_text() != "mine" for name in _MINE)
        write_set(out, "again")
        left = [path.name for path in (*folder.iterdir(), *out.iterdir()) if path.name.startswith(".")]
        return wrong or content(out) != of_age("again") or bool(left)

    put_back = list[Path]()
    with scratch() as top:
        in_one_step = _in_one_step(top)
        before = top / "before"
        before.mkdir()
        if not first:
            write_set(before / "out", "old")
        if beside:
            for name in _MINE:
                (before / "out" / name).write_text("mine")
        outcomes = [lost(top / "now", outcome.said) for _, outcome in faults(before, top / "now", work)]
    detail = f"{len(put_back)} put back by the next command" if put_back else ""
    return Trial(what, len(outcomes), sum(outcomes), detail)


def _in_one_step(top: Path) -> bool:
    """Whether names can change places in one step on this disk; not on exFAT, say."""
    one, other = top / "one", top / "other"
    one.touch()
    other.touch()
    can = exchanged(one, other)
    one.unlink()
    other.unlink()
    return can


def _agrees(out: Path) -> bool:
    """Whether all that the manifest names is of its age, and there."""
    manifest = json.loads((out / MANIFEST).read_text())
    age = manifest["versions"]["axiscal"]
    return all((out / name).exists() and (out / name).read_text() == age for name in manifest["files"])
