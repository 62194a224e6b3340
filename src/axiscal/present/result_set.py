"""Results as a set: a manifest beside them says what is whole, and without one the next writer completes the set.

New results are written into a folder inside of theirs, with a manifest as the last file, and waited for. Then the old
manifest goes, one result after another takes its place, and the new manifest comes last.
"""

from __future__ import annotations

import contextlib
import errno
import hashlib
import json
import os
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path, PurePosixPath, PureWindowsPath

from axiscal.document.durable import drafts_left, sync_folder, write_whole
from axiscal.present.result import RecordState

RECORD = "campaign.axiscal"
MANIFEST = "manifest.json"
_BEFORE = "before.json"
_SCHEMA = "axiscal-manifest/1"


@contextmanager
def result_set(folder: Path, manifest: str = MANIFEST) -> Iterator[Path]:
    """Yield a folder to write into, `manifest` by `write_manifest` as the last; then its files take their places.

    Where the block raises, everything is as before.  Raises OSError.
    """
    fresh, staging = not folder.exists(), folder / f".results.{os.getpid()}.new"
    staging.mkdir(parents=True)
    try:
        yield staging
        _refuse_what_blocks(staging, folder)
        for path in (staging, *(each for each in staging.rglob("*") if each.is_dir())):
            sync_folder(path)
    except BaseException:
        shutil.rmtree(staging, ignore_errors=True)
        if fresh:
            with contextlib.suppress(OSError):
                folder.rmdir()
        raise
    if (folder / manifest).exists():
        os.replace(folder / manifest, staging / _BEFORE)
        sync_folder(folder)
    _take_places(staging, folder, manifest)


def write_manifest(folder: Path, record: RecordState, versions: Mapping[str, str], name: str = MANIFEST) -> None:
    """Write what a set consists of: state of the record, programs, and the SHA-256 of every file; raises OSError."""
    every = (path for path in folder.rglob("*") if path.is_file())
    files = sorted(path for path in every if path.suffix not in (".axiscal", ".before"))
    document = {
        "schema": _SCHEMA,
        "record": record.model_dump(),
        "versions": dict(sorted(versions.items())),
        "files": {path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest() for path in files},
    }
    write_whole(folder / name, (json.dumps(document, indent=2, ensure_ascii=False) + "\n").encode())


def _files(folder: Path) -> list[str]:
    """Return the names of all files below a folder, links to folders among them."""
    found = (path for path in folder.rglob("*") if path.is_symlink() or not path.is_dir())
    return sorted(path.relative_to(folder).as_posix() for path in found)


def _listed(manifest: Path) -> set[str]:
    """Return the files of a set by its manifest; none where it is no manifest of ours.

    What it names outside of its folder is nobody's result: whoever believed that would remove other people's files.
    """
    try:
        document = json.loads(manifest.read_bytes())
        return {name for name in document["files"] if _inside(name)} if document["schema"] == _SCHEMA else set()
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return set()


def _inside(name: str) -> bool:
    """Whether a name can be that of a file in a set: below its folder, and no record, which no manifest names."""
    path = PureWindowsPath(name)  # to which both / and \\ part folders
    within = bool(path.parts) and not path.anchor and ".." not in path.parts
    return within and path.suffix != ".axiscal" and name.isprintable()


def _refuse_what_blocks(staging: Path, folder: Path) -> None:
    """Raise OSError where a folder stands in the place of a file, or something else in the place of its folder."""
    for name in _files(staging):
        if (folder / name).is_dir():
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(folder / name))
        for parent in (folder / part for part in PurePosixPath(name).parents):
            if parent.exists() and not parent.is_dir():
                raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(parent))


def _take_places(staging: Path, folder: Path, manifest: str) -> None:
    """Bring what is new into a folder, without what a manifest of before, or a writer that is gone, left there."""
    drafts = {staging, *filter(Path.is_dir, drafts_left(folder, "results"))}
    new, known = _listed(staging / manifest), (draft / name for draft in drafts for name in (_BEFORE, manifest))
    for old in sorted(set[str]().union(*map(_listed, known)) - new):
        with contextlib.suppress(FileNotFoundError, NotADirectoryError, IsADirectoryError):
            (folder / old).unlink()
        with contextlib.suppress(OSError):  # the folders that held nothing else
            for parent in list(PurePosixPath(old).parents)[:-1]:
                (folder / parent).rmdir()
    for name in _files(staging):
        if name not in (manifest, _BEFORE):
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            os.replace(staging / name, folder / name)
    for part in {parent for name in new for parent in PurePosixPath(name).parents}:
        sync_folder(folder / part)
    os.replace(staging / manifest, folder / manifest)
    sync_folder(folder)
    for draft in drafts:
        shutil.rmtree(draft)
