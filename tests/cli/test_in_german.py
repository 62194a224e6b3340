"""Documents of commands stay as programs know them, whatever language is spoken."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from axiscal.cli.app import run
from tests.generators.begun import begun
from tests.generators.texts import FOUR_READINGS


def test_documents_are_the_same_in_every_language(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    said = list[object]()
    for language in ("en", "de"):
        folder = tmp_path / language
        begun(folder, {"c.toml": FOUR_READINGS}, ("start", "c.toml", "m.axiscal"))
        monkeypatch.chdir(folder)
        monkeypatch.setenv("AXISCAL_LANGUAGE", language)
        for command in ("next m.axiscal", "record m.axiscal 0.3um", "record m.axiscal 900um --at X=120mm"):
            run([*command.split(), "--json"])
        said.append([json.loads(part) for part in re.split(r"(?<=\n)(?=\{\n)", capsys.readouterr().out)])
    assert said[0] == said[1]
