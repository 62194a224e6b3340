"""Results as a set: whoever looks into their folder finds the earlier ones or the new ones, all of them, never some.

New results are written into a folder beside, with a manifest as the last file, and waited for. The two folders change
places in one step if the old one holds nothing else. Some disks know no such step (exFAT): a kill between two leaves
the earlier set beside, and the next writer puts it back. If the old folder holds other things as well, or is another
disk, the old manifest goes first. Then one result after another takes its place, and the new manifest comes last.
Without a manifest there is no set, and the next writer completes it.
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

from axiscal.document.durable import drafts_left, exchanged, sync_folder, write_whole
from axiscal.present.result import RecordState

RECORD = "campaign.axiscal"
MANIFEST = "manifest.json"
_BEFORE = "before.json"
_SCHEMA = "axiscal-manifest/1"


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
        staging = folder / f".results.{os.getpid()}.new"
        staging.mkdir()
    try:
        yield staging
        if not whole:
            _refuse_what_blocks(staging, folder)
        for path in (staging, *(each for each in staging.rglob("*") if each.is_dir())):
            sync_folder(path)
    except BaseException:
        shutil.rmtree(staging, ignore_errors=True)
        raise
    if whole:
        _swap(staging, folder)
        return
    if (folder / manifest).exists():
        os.replace(folder / manifest, staging / _BEFORE)
        sync_folder(folder)
    _go_on(staging, folder)


def mend(folder: Path) -> None:
    """Bring to its end, or remove, what a writer that is gone has left of results in this folder; raises OSError."""
    with contextlib.suppress(FileNotFoundError):
        for path in filter(Path.is_dir, drafts_left(folder.parent, folder.name)):
            if path.suffix == ".old" and not folder.exists():
                os.rename(path, folder)
            else:
                shutil.rmtree(path)
        for path in filter(Path.is_dir, drafts_left(folder, "results")):
            _go_on(path, folder)


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


def _holds_nothing_else(folder: Path, manifest: str) -> bool:
    """Whether a folder can change places with another: nothing in it is anybody else's, nobody stands in it."""
    if not folder.exists():
        return True
    real, here = folder.resolve(), Path.cwd()
    if folder.is_symlink() or os.path.ismount(real) or real == here or real in here.parents:
        return False
    own = _listed(folder / manifest) | {manifest} | ({RECORD} if manifest == MANIFEST else set())
    first = {PurePosixPath(name).parts[0] for name in own}
    alone = all(path.name in first for path in folder.iterdir()) and set(_files(folder)) <= own
    return alone and os.access(real.parent, os.W_OK)


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


def _beside(folder: Path, live: Path | None) -> Path | None:
    """Return a new folder beside, with the record that is written to in both; None where none can be."""
    staging = folder.parent / f".{folder.name}.{os.getpid()}.new"
    staging.mkdir()
    try:
        if live is not None and live.exists():
            os.link(live, staging / live.name)
    except OSError:
        shutil.rmtree(staging)
        return None
    return staging


def _swap(staging: Path, folder: Path) -> None:
    if not folder.exists():
        os.rename(staging, folder)
        sync_folder(folder.parent)
        return
    staging.chmod(folder.stat().st_mode & 0o7777)
    if not exchanged(staging, folder):
        old = folder.parent / f".{folder.name}.{os.getpid()}.old"
        os.rename(folder, old)
        try:
            os.rename(staging, folder)
        except OSError:
            os.rename(old, folder)
            raise
        staging = old
    sync_folder(folder.parent)
    shutil.rmtree(staging, ignore_errors=True)  # the earlier set; what stays of it goes at the next start


def _refuse_what_blocks(staging: Path, folder: Path) -> None:
    """Raise OSError where a folder stands in the place of a file, or something else in the place of its folder."""
    for name in _files(staging):
        if (folder / name).is_dir():
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(folder / name))
        for parent in (folder / part for part in PurePosixPath(name).parents):
            if parent.exists() and not parent.is_dir():
                raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(parent))


def _go_on(staging: Path, folder: Path) -> None:
    manifests = [path for path in staging.iterdir() if path.name.startswith("manifest")]
    if manifests and not (folder / manifests[0].name).exists():  # else it was whole, and nothing of it has been brought
        for old in sorted(_listed(staging / _BEFORE) - _listed(manifests[0])):
            with contextlib.suppress(FileNotFoundError, NotADirectoryError, IsADirectoryError):
                (folder / old).unlink()
            with contextlib.suppress(OSError):  # the folders that held nothing else
                for parent in list(PurePosixPath(old).parents)[:-1]:
                    (folder / parent).rmdir()
        for name in _files(staging):
            if staging / name not in (*manifests, staging / _BEFORE):
                (folder / name).parent.mkdir(parents=True, exist_ok=True)
                os.replace(staging / name, folder / name)
        for part in {parent for name in _listed(manifests[0]) for parent in PurePosixPath(name).parents}:
            sync_folder(folder / part)
        for path in manifests:
            os.replace(path, folder / path.name)
    sync_folder(folder)
    shutil.rmtree(staging)
