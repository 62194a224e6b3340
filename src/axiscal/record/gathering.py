"""The records that are named together: files, those of a folder, and "store:" for all campaigns of the store."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from axiscal.exceptions import RecordError
from axiscal.record.log import STORED
from axiscal.record.opening import is_stored, store_database


def is_store(named: Path) -> bool:
    """Whether the whole store is named, and no campaign of it."""
    return str(named) == STORED


def gathered(named: Iterable[Path]) -> list[Path]:
    """Return the names of single records, by which each is opened; raises RecordError where the store cannot tell."""
    found = list[Path]()
    for each in named:
        if is_store(each):
            found += _of_store()
        elif not is_stored(each) and each.is_dir():
            found += sorted(each.glob("*.axiscal"))
        else:
            found.append(each)
    return found


def records_of(shop: Path) -> list[Path]:
    """Return the records of a folder, or of the store; raises RecordError for anything else."""
    if not is_store(shop) and not shop.is_dir():
        remedy = f"Name the folder that holds the records, or {STORED} for the campaigns on the server"
        raise RecordError("This is no folder", remedy, shop)
    return gathered([shop])


def _of_store() -> list[Path]:
    from axiscal.record.postgres.campaigns_there import campaigns_there

    database = store_database()
    try:
        return [each.path for each in campaigns_there(database)]
    finally:
        database.close()
