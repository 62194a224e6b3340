"""[sisters] of campaign.toml: which records of other machines are to teach what this one is like."""

from __future__ import annotations

import glob
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from axiscal.document import Document, shown
from axiscal.exceptions import DescriptionError
from axiscal.record.log import STORED

if TYPE_CHECKING:
    from axiscal.description.campaign_schema import SistersTable


@dataclass(frozen=True, slots=True)
class SistersNamed:
    """records : in the order of their names, "store:" for all of the store; type : what their machines are called, None
    for any; directions : in which sisters may differ together
    """

    records: tuple[Path, ...]
    directions: int
    type: str | None = None


def sisters_named(table: SistersTable | None, document: Document) -> SistersNamed | None:
    """Return the records that [sisters] names beside campaign.toml; None where it names none.

    A record that is opened again carries what they taught, and needs none of them. Raises DescriptionError for two
    priors, and for a name that is no text.
    """
    if table is None or (table.records is None and table.type is None):
        return None
    if document.data.get("prior"):
        what = "[sisters] names records, and `prior` names another prior"
        raise document.fault(DescriptionError(what, "Leave one of them out"), "sisters", "records")
    named = STORED if table.records is None else table.records
    patterns = (named,) if isinstance(named, str) else tuple(named)
    found = set[Path]()
    for pattern in patterns:
        if not pattern.strip() or not pattern.isprintable():
            fault = DescriptionError(f"records = {shown(pattern)} names no file", 'Write "records/*.axiscal"')
            raise document.fault(fault, "sisters", "records")
        if pattern.startswith(STORED):
            found.add(Path(pattern))
            continue
        found |= {Path(name) for name in glob.glob(str(document.path.parent / pattern))}
    return SistersNamed(tuple(sorted(found)), table.directions, table.type)
