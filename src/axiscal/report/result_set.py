"""Results as a set: whoever looks into their folder finds the earlier ones or the new ones, all of them, never some.

New results are written into a folder beside, with a manifest as the last file, and waited for. Where their folder holds
nothing else, the two folders change places in one step. Where it holds other things as well, or is a disk of its own,
the old manifest goes first, then one result after another takes its place, and the new manifest comes last: while there
is no manifest, there is no set, and whoever writes there next brings it to its end.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import re
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from axiscal.record.durable import exchanged, is_running, sync_folder, written
from axiscal.report.summary import RecordState

RECORD = "campaign.axiscal"
MANIFEST = "manifest.json"
_RESULTS = {RECORD, MANIFEST, "result.json", "report.html", "report.pdf", "data", "certificate.xml", "tables"}
_BEFORE = "before.json"
_STAGING = re.compile(r"\.(?P<name>.+)\.(?P<process>\d+)\.(?P<kind>new|old)")


@contextmanager
def result_set(folder: Path, manifest: str = MANIFEST, live: Path | None = None) -> Iterator[Path]:
    """Yield a folder to write into, `manifest` by `write_manifest` as the last; then it takes the place of `folder`.

    live : a record in `folder` that is still written to, which stays where it is
    Where the block raises, everything is as before.  Raises OSError.
    """
    mend(folder)
    folder.parent.mkdir(parents=True, exist_ok=True)
    staging = _beside(folder, live) if _holds_nothing_else(folder, manifest) else None
    whole = staging is not None
    if staging is None:
        staging = _within(folder)
        staging.mkdir()
    try:
        yield staging
        _sync_all(staging)
    except BaseException:
        shutil.rmtree(staging, ignore_errors=True)
        raise
    if whole:
        _swap(staging, folder)
    else:
        _bring(staging, folder, manifest)


def mend(folder: Path) -> None:
    """Bring to its end, or remove, what a writer that is gone has left of results in this folder; raises OSError."""
    with contextlib.suppress(FileNotFoundError):
        for path in sorted(folder.parent.iterdir()):
            found = _STAGING.fullmatch(path.name)
            if found and found["name"] == folder.name and path.is_dir() and not is_running(int(found["process"])):
                _put_back(path, folder) if found["kind"] == "old" else shutil.rmtree(path)
        for path in sorted(folder.iterdir()):
            found = _STAGING.fullmatch(path.name)
            if found and found["name"] == "results" and path.is_dir() and not is_running(int(found["process"])):
                _go_on(path, folder)
            elif path.name in {f".{name}.part" for name in _RESULTS}:
                path.unlink()


def write_manifest(folder: Path, record: RecordState, versions: Mapping[str, str], name: str = MANIFEST) -> None:
    """Write what a set consists of: state of the record, programs, the SHA-256 of every file; raises OSError."""
    files = sorted(path for path in folder.rglob("*") if path.is_file() and path.suffix != ".axiscal")
    document = {
        "schema": "axiscal-manifest/1",
        "record": {"file": record.file, "event": record.event, "hash": record.hash},
        "versions": dict(sorted(versions.items())),
        "files": {path.relative_to(folder).as_posix(): _hash(path) for path in files},
    }
    written(folder / name, (json.dumps(document, indent=2, ensure_ascii=False) + "\n").encode())


def _hash(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _holds_nothing_else(folder: Path, manifest: str) -> bool:
    """Whether a folder can change places with another: nothing in it is anybody else's, nobody stands in it."""
    if not folder.exists():
        return True
    real, here = folder.resolve(), Path.cwd()
    if folder.is_symlink() or os.path.ismount(real) or real == here or real in here.parents:
        return False
    names = {path.name for path in folder.iterdir()}
    own = _RESULTS if manifest == MANIFEST else _listed(folder / manifest) | {manifest}
    return names <= own and os.access(real.parent, os.W_OK)


def _listed(manifest: Path) -> set[str]:
    """Return the names in a folder that its manifest names, none where it has no manifest."""
    try:
        files = json.loads(manifest.read_bytes())["files"]
        return {Path(name).parts[0] for name in files if Path(name).name == name or ".." not in Path(name).parts}
    except (OSError, ValueError, KeyError, TypeError, IndexError):
        return set()


def _beside(folder: Path, live: Path | None) -> Path | None:
    """Return a new folder beside, with the record that is written to in both; None where a file cannot be in two."""
    staging = folder.parent / f".{folder.name}.{os.getpid()}.new"
    staging.mkdir()
    if live is not None:
        try:
            os.link(live, staging / live.name)
        except OSError:
            shutil.rmtree(staging)
            return None
    return staging


def _within(folder: Path) -> Path:
    return folder / f".results.{os.getpid()}.new"


def _sync_all(folder: Path) -> None:
    for path in (folder, *(each for each in folder.rglob("*") if each.is_dir())):
        sync_folder(path)


def _swap(staging: Path, folder: Path) -> None:
    if not folder.exists():
        os.rename(staging, folder)
        sync_folder(folder.parent)
        return
    staging.chmod(folder.stat().st_mode & 0o7777)
    if not exchanged(staging, folder):
        old = folder.parent / f".{folder.name}.{os.getpid()}.old"
        os.rename(folder, old)
        os.rename(staging, folder)
        staging = old
    sync_folder(folder.parent)
    shutil.rmtree(staging, ignore_errors=True)  # the earlier set; what stays of it goes at the next start


def _put_back(old: Path, folder: Path) -> None:
    if folder.exists():
        shutil.rmtree(old)
    else:
        os.rename(old, folder)


def _bring(staging: Path, folder: Path, manifest: str) -> None:
    """Move a set that is whole into a folder that holds other things as well."""
    if (folder / manifest).exists():
        os.replace(folder / manifest, staging / _BEFORE)
        sync_folder(folder)
    _go_on(staging, folder)


def _go_on(staging: Path, folder: Path) -> None:
    manifests = [path for path in staging.iterdir() if path.name.startswith("manifest")]
    if manifests and (folder / manifests[0].name).exists():
        manifests = []  # it was whole, and nothing of it has been brought
    for old in _listed(staging / _BEFORE) if manifests else ():
        _remove(folder / old)
    for path in sorted(staging.iterdir()) if manifests else ():
        if path not in (*manifests, staging / _BEFORE):
            _remove(folder / path.name)
            os.rename(path, folder / path.name)
    sync_folder(folder)
    for path in manifests:
        os.replace(path, folder / path.name)
    sync_folder(folder)
    shutil.rmtree(staging)


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)
