"""The same campaigns in other surroundings: hash seeds, time zones, languages, threads, interpreters."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory

from axiscal.language.spoken import LANGUAGES
from axiscal.record.payload import encode
from axiscal.record.store import Record
from benchmarks.reliability.trial import Trial
from tests.golden.given import Given, given
from tests.golden.playing import FIXED

CAMPAIGNS = ("iso_test", "printer", "learnt")
SOURCES = Path(__file__).resolve().parents[2] / "src"
LOCALES = ("de_DE", "tr_TR")
ZONES = ("Asia/Kathmandu", "America/St_Johns", "Pacific/Kiritimati")
_SPENT = re.compile(r"\b\d+(\.\d+)? s\b")
_HASH = re.compile(r"\b[0-9a-f]{64}\b")


@dataclass(frozen=True, slots=True)
class Surroundings:
    """Where a campaign is played: variables of the process, and the interpreter."""

    name: str
    variables: Mapping[str, str] = field(default_factory=dict)
    python: str = sys.executable


def compared(long: bool, pythons: Sequence[str] = ()) -> Trial:
    """Return how many surroundings gave other bytes than the usual ones.

    long : 21 hash seeds instead of 3;  pythons : interpreters in which the package's requirements are installed
    """
    with TemporaryDirectory() as folder:
        usual = _texts(Surroundings("as usual"))
        places = list(_variables(21 if long else 3, Path(folder)))
        other = [place.name for place in places if _texts(place) != _expected(place, usual)]
        unnamed = _unnamed(usual, _version(sys.executable))
        other += [p for p in pythons if _unnamed(_texts(Surroundings(p, python=p)), _version(p)) != unnamed]
        named = [place.name for place in places if place.name.startswith("locale")] + [
            f"Python {_version(p)}" for p in pythons
        ]
    what = "surroundings in which three campaigns give the same bytes"
    detail = f"other bytes: {', '.join(other)}" if other else f"hash seeds, zones, threads, {', '.join(named)}"
    return Trial(what, len(places) + len(pythons), len(other), detail)


def _expected(place: Surroundings, usual: list[Mapping[str, str]]) -> list[Mapping[str, str]]:
    """Return files as usual; commands answer in the language of the computer, as they do where somebody names it."""
    language = place.variables.get("LANG", "")[:2]
    if language not in LANGUAGES:
        return usual
    named = _texts(Surroundings(language, {"AXISCAL_LANGUAGE": language}))
    return [
        {name: (said if name.startswith("answer") else files)[name] for name in files}
        for files, said in zip(usual, named, strict=True)
    ]


def _version(python: str) -> str:
    run = subprocess.run([python, "--version"], capture_output=True, text=True, check=True)
    return run.stdout.split()[-1]


def _unnamed(texts: list[Mapping[str, str]], version: str) -> list[Mapping[str, str]]:
    """Return the texts without the interpreter's version, which documents name, and the hashes of what names it.

    A PDF holds both where they cannot be taken out: it is left away.
    """
    kept = ({name: text for name, text in one.items() if not name.endswith(".pdf")} for one in texts)
    return [
        {name: _HASH.sub("<hash>", text).replace(version, "<version>") for name, text in one.items()} for one in kept
    ]


def _variables(seeds: int, folder: Path) -> Iterator[Surroundings]:
    yield from (Surroundings(f"hash seed {s}", {"PYTHONHASHSEED": str(s)}) for s in range(seeds))
    yield from (Surroundings(f"zone {zone}", {"TZ": zone}) for zone in ZONES)
    for threads in ("1", "2", "4"):
        yield Surroundings(f"{threads} threads", {"OPENBLAS_NUM_THREADS": threads, "OMP_NUM_THREADS": threads})
    for name in LOCALES:
        if installed(name, folder):
            own = {"LOCPATH": str(folder), "LC_ALL": f"{name}.UTF-8", "LANG": f"{name}.UTF-8"}
            yield Surroundings(f"locale {name}", own)


def installed(name: str, folder: Path) -> bool:
    """Return whether the language could be compiled into the folder (by localedef, from Debian's package locales)."""
    tool = shutil.which("localedef")
    if tool is None:
        return False
    words = [tool, "-i", name, "-f", "UTF-8", str(folder / f"{name}.UTF-8")]
    return subprocess.run(words, capture_output=True, check=False, env=dict(os.environ)).returncode == 0


def _texts(place: Surroundings) -> list[Mapping[str, str]]:
    """Return files and answers of all campaigns, by name; without the seconds that the work took."""
    return [_played(given(name), place) for name in CAMPAIGNS]


def _played(campaign: Given, place: Surroundings) -> Mapping[str, str]:
    usual = {"PYTHONPATH": str(SOURCES), "PYTHONDONTWRITEBYTECODE": ""}  # compiled once, not with every command
    env = {**os.environ, **FIXED, **usual, **place.variables}
    with TemporaryDirectory() as parent:
        folder = Path(parent, campaign.name)
        shutil.copytree(campaign.folder, folder)
        answers = {}
        for number, command in enumerate(campaign.commands):
            words = [place.python, "-m", "axiscal", *command.words]
            run = subprocess.run(words, cwd=folder, env=env, capture_output=True, encoding="utf-8", check=False)
            answers[f"answer {number}"] = _SPENT.sub("<spent>", f"{run.returncode}{run.stdout}{run.stderr}")
        return answers | dict(_files(folder))


def _files(folder: Path) -> Iterator[tuple[str, str]]:
    """Yield what was written, by name; a record as its events without the time of writing."""
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder).as_posix()
        if path.suffix == ".axiscal":
            with Record.open(path, write=False) as record:
                yield name, repr([encode(stored.event) for stored in record.events()])
        elif path.is_file() and path.suffix not in (".axiscal-wal", ".axiscal-shm"):
            yield name, path.read_bytes().decode("utf-8", "backslashreplace")
