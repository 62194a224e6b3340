"""Refusals that a person meets at the machine, in German: no English sentence among them."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from axiscal.cli.app import run
from axiscal.exceptions import Faults, ReadingError, RecordError
from axiscal.language.spoken import speaking
from tests.docs import languages
from tests.generators.begun import begun
from tests.generators.texts import FOUR_READINGS

ENGLISH = re.compile(r"\b(the|is|are|not|and|or|of|give|write|there|this|that|with|it|no|such|was)\b", re.IGNORECASE)
REFUSED = {
    "no record": "step next none.axiscal",
    "a folder": "step next .",
    "no question": "step record m.axiscal '1 um'",
    "two records": "step start campaign.toml m.axiscal",
    "an unknown unit": "step record asked.axiscal '1 parsec'",
    "a comma": "step record asked.axiscal '1,5 um'",
    "no number": "step record asked.axiscal 'much um'",
    "another quantity": "step record asked.axiscal '1 deg'",
    "an absurd reading": "step record asked.axiscal '5 km'",
    "an absurd std": "step record asked.axiscal '1 um' --std '0 um'",
    "nothing to take back": "step undo asked.axiscal",
    "a plan without an end": "plan endless.toml",
    "an option alone": "plan campaign.toml --gap 2",
    "no accuracy": "plan campaign.toml --target '0 um'",
    "no campaign": "step start none.toml",
    "a broken campaign": "step start broken.toml",
    "a source without a file": "step run campaign.toml --source csv:none.csv --out out",
    "a source of nothing": "step run campaign.toml --source exec: --out out",
    "a misspelt key": "plan misspelt.toml",
    "a bare number": "plan bare.toml",
    "an unknown machine": "plan unknown.toml",
    "a plan of too many": "plan campaign.toml --readings 5000",
    "programs for no control": "plan campaign.toml --readings 3 --gcode klingon --out programs",
    "tables for no control": "export m.axiscal --to klingon --out tables",
    "no built-in machine": "init first --machine mill7 --instrument interferometer --target '5 um'",
    "a line cut short": "data iso230 short.csv",
    "no readings": "data estimate campaign.toml none.csv --out estimated",
    "no store": "shop sync m.axiscal",
    "no study": "study campaign.toml --out study",
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A record nobody has asked of, one with a question, and campaigns that are none."""
    made = tmp_path_factory.mktemp("refused")
    texts = {
        "campaign.toml": FOUR_READINGS,
        "endless.toml": FOUR_READINGS.replace("readings = 4", ""),
        "broken.toml": FOUR_READINGS.replace("[target]", "[target"),
        "misspelt.toml": FOUR_READINGS.replace("readings = 4", "readings = 4\nbudgte = '3 min'"),
        "bare.toml": FOUR_READINGS.replace("0.5 um", "0.5"),
        "unknown.toml": FOUR_READINGS.replace("one-axis", "one-axes"),
        "short.csv": "target_mm,direction,run,deviation_um\n10,+,1\n",
    }
    started = (("step", "start", "campaign.toml", f"{name}.axiscal") for name in ("m", "asked"))
    begun(made, texts, *started, ("step", "next", "asked.axiscal"))
    return made


@pytest.mark.parametrize("name", REFUSED)
def test_a_refusal_is_in_german(
    name: str, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:

    monkeypatch.chdir(folder)
    monkeypatch.setenv("AXISCAL_LANGUAGE", "de")
    monkeypatch.delenv("AXISCAL_STORE", raising=False)
    assert run(shlex.split(REFUSED[name])) == 1
    text = re.sub(r'`[^`]*`|"[^"]*"|\([^()]*\)|\S+\.(?:axiscal|toml|csv)|--\S+', "", capsys.readouterr().err)
    text = " ".join(line for line in text.splitlines() if not line.startswith("Mind"))
    assert text.startswith("axiscal: ")
    assert ENGLISH.findall(text) == [], text


def test_a_failure_is_said_in_the_language_that_is_spoken_when_it_is_printed() -> None:
    faults = Faults()
    for line in (3, 5, 7):
        with faults.noted():
            raise ReadingError("{value} is not a finite number", "Give one value", "a.csv", line, value="nan")
    with faults.noted():
        raise RecordError("There is nothing to take back", "Go on with `axiscal step next`", "a.csv", 9)
    with pytest.raises(ReadingError) as raised:
        faults.refuse()
    assert str(raised.value) == (
        "a.csv, line 3: nan is not a finite number. Give one value. (3 times, up to line 7.) "
        "Also: line 9: There is nothing to take back. Go on with `axiscal step next`."
    )
    with speaking("de"):
        assert str(raised.value) == (
            "a.csv, Zeile 3: nan ist keine endliche Zahl. Einen Wert angeben. (3-mal, bis Zeile 7.) "
            "Außerdem: Zeile 9: Nichts kann zurückgenommen werden. Weiter mit `axiscal step next`."
        )


def test_no_refusal_is_in_english_alone() -> None:
    assert [place for place, done in languages.refusals() if not done] == []


def test_each_place_of_a_refusal_gets_its_value() -> None:
    assert list(languages.gaps()) == []
