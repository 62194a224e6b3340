"""Whoever speaks German reads German on every screen of the usual commands; documents stay as programs know them."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from axiscal.cli.app import run
from tests.generators.begun import begun
from tests.generators.texts import FOUR_READINGS

ENGLISH = re.compile(r"\b(the|of|and|is|are|to|for|with|not|no|reading|readings|kept|left|found|go|from)\b")
COMMANDS = [
    "plan c.toml",
    "start c.toml new.axiscal",
    "next m.axiscal",
    "skip m.axiscal Strahl --next",
    "undo m.axiscal",
    'record m.axiscal "0.3 um"',
    'record m.axiscal "900 um" --at "X=120 mm"',
    "note m.axiscal Spindel",
    "status m.axiscal",
    "export m.axiscal --to linuxcnc",
    "verify m.axiscal",
    "verify m.axiscal --plan check.csv",
    'verify m.axiscal --source sim:3 --tolerance "5 um"',
    'verify m.axiscal --source sim:3 --tolerance "50 um"',
    "step next m.axiscal --beyond",
    "finish m.axiscal --out out",
]


@pytest.mark.long
def test_no_screen_is_in_english(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    begun(tmp_path, {"c.toml": FOUR_READINGS}, ("start", "c.toml", "m.axiscal"))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("AXISCAL_LANGUAGE", "de")
    found = dict[str, list[str]]()
    for command in COMMANDS:
        run([word.strip('"') for word in re.findall(r'"[^"]*"|\S+', command)])
        shown = "".join(capsys.readouterr())
        assert shown.strip()
        own = re.sub(r'axiscal [a-z]+[^\n]*|[\w./-]+\.(csv|toml|axiscal|pdf|txt)|„[^“]*“|"[^"]*"|`[^`]*`', "", shown)
        if words := ENGLISH.findall(own):
            found[command] = [*words, shown]
    assert "\n".join(f"{name}: {words}" for name, words in found.items()) == ""


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
