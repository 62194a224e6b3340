"""Of thousands of readings the report lists the first ones, and says by hash which file has all of them."""

from __future__ import annotations

import hashlib
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from axiscal.language.spoken import speaking
from axiscal.present.data_files import LISTED, listed, readings_csv
from axiscal.present.page import render
from axiscal.present.printed import pdf
from tests.present.test_page import five_axis_summary

_MANY = LISTED + 3


def test_a_usual_campaign_is_listed_whole() -> None:
    summary = five_axis_summary(40)
    assert len(listed(summary).rows) == 40
    assert listed(summary).words == ""
    assert "SHA-256 is" not in render(summary)


@pytest.mark.parametrize("language", ["en", "de"])
def test_the_page_lists_the_first_ones_and_names_the_file_of_all(language: str) -> None:
    summary = five_axis_summary(_MANY)
    kept = readings_csv(summary)
    assert kept.count(b"\n") == _MANY + 1
    with speaking(language):
        page = render(summary)
    listing = page[page.index('<section id="details">') :]
    listing = listing[: listing.index("</table>")]
    assert [int(number) for number in re.findall(r'<td class="n">(\d+)</td><td>set-up', listing)] == [
        *range(1, LISTED + 1)
    ]
    assert hashlib.sha256(kept).hexdigest() in listing
    assert "data/readings.csv" in listing


@pytest.mark.long
def test_the_paper_does_the_same(tmp_path: Path) -> None:
    if shutil.which("pdftotext") is None:
        pytest.skip("Debian package poppler-utils is not installed")
    summary = five_axis_summary(_MANY)
    (tmp_path / "report.pdf").write_bytes(pdf(summary))
    command = ["pdftotext", "-layout", str(tmp_path / "report.pdf"), "-"]
    words = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    flat = re.sub(r"\s+", " ", words)
    assert f"The first {LISTED} of {_MANY} readings are listed here" in flat
    assert hashlib.sha256(readings_csv(summary)).hexdigest() in flat.replace(" ", "")
    numbers = [int(each) for each in re.findall(r"^\s*(\d+)(?: ×)?\s+set-up", words, re.MULTILINE)]
    assert numbers == [*range(1, LISTED + 1)]
