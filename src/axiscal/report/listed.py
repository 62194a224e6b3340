"""Which readings a report lists: of thousands the first ones, with the name and the hash of the file that has all."""

from __future__ import annotations

from collections.abc import Sequence
from hashlib import sha256
from typing import NamedTuple

from axiscal.language.spoken import said
from axiscal.report.data_files import READINGS, readings_csv
from axiscal.report.summary import HistoryRow, Summary

LISTED = 1000
"""Twenty pages; a matter of taste: nobody reads more on paper, and 20,000 take a minute and gigabytes to set."""


class ReadingsListed(NamedTuple):
    """rows : that are listed; words : where the others are, empty where there are none."""

    rows: Sequence[HistoryRow]
    words: str


def listed(summary: Summary) -> ReadingsListed:
    """Return the readings that are listed; raises SummaryError for a figure that is not finite."""
    rows = [row for row in summary.history if row.position]
    if len(rows) <= LISTED:
        return ReadingsListed(rows, "")
    words = said(
        "The first {count} of {whole} readings are listed here. All of them stand in {file} of the results, whose "
        "SHA-256 is {hash}.",
        count=LISTED,
        whole=len(rows),
        file=f"data/{READINGS}",
        hash=sha256(readings_csv(summary)).hexdigest(),
    )
    return ReadingsListed(rows[:LISTED], words)
