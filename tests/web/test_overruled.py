"""A display in mm that a person reads all the same: each answer says so, and that the readings contradict it."""

import json
import shutil
import subprocess
from pathlib import Path

import pytest

from benchmarks.zoo.running import given
from tests.generators.texts import FOUR_READINGS
from tests.web.served import served, started

WORDS = 'Taken all the same: the test at mounting "laser" failed.'
SHOWN = ["0.014", "-0.009", "0.021", "0.003", "-0.017", "0.011", "-0.006", "0.018"]
"""mm, where the page asks for um."""


@pytest.mark.long
def test_a_test_that_was_overruled_stands_in_all_that_is_printed(tmp_path: Path) -> None:
    if shutil.which("pdftotext") is None:
        pytest.skip("needs Debian's poppler-utils")
    record = started(tmp_path, FOUR_READINGS.replace("readings = 4", f"readings = {len(SHOWN)}"))
    with served(record) as page:
        refused = page.call("jogs", after=page.state()["last"], text="0.1")
        assert "The display is in mm" in refused.document["sentence"]
        assert page.call("jogs", after=page.state()["last"], text="0.1", anyway=True).status == 200
        for text in SHOWN:
            kept = page.call("readings", after=page.state()["last"], text=text, cause="really")
            assert kept.status == 200, kept.document
    out = tmp_path / "out"
    screen = given("finish", record, "--out", out)
    result = json.loads((out / "result.json").read_text(encoding="utf-8"))
    command = ["pdftotext", "-l", "1", str(out / "report.pdf"), "-"]
    first = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert result["answer"]["overruled"] == ["laser"]
    assert result["agreement"]["contradict"]
    for text in (screen.printed, first):
        assert WORDS in " ".join(text.split())
        assert "contradict each other" in text
