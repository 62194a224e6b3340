"""A signed record whose readings somebody changed, sums and chain made anew: no command goes on with it unsaid."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import read_campaign
from axiscal.exceptions import RecordError
from axiscal.measurement.reading import Reading
from axiscal.record.signing import KEY, PERSON
from tests.commands import Command
from tests.generators.plain_records import CAMPAIGN, HEAD, MACHINE, lines_in, write_record

VALUES = 0.3, 0.6, 2.0, 3.4, 3.7, 5.4, 5.8, 6.9, 8.6, 8.7, 10.4, 10.8
"""um: an even slope and half a um of noise."""
GIVEN = {
    "VALUE": ["1 um"],
    "TEXT": ["warm"],
    "REASON": ["blocked"],
    "CAUSE": [],
    "TO": ["copy.axiscal"],
    "OTHER": ["forged.axiscal"],
    "NEW": ["new.axiscal"],
    "POSES.csv": ["poses.csv"],
}
"""What is put in the place of each argument beside the record."""
OPTIONS = {"export": ["--to", "csv", "--out", "tables"], "finish": ["--out", "results"], "report": ["--out", "r.pdf"]}
LEFT = {"step start"}
"""The record is what it makes."""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: Command) -> Path:
    """A folder with a record that is signed to its end, and one whose third reading was changed since."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv(KEY, str(tmp_path / "key.pem"))
    monkeypatch.setenv(PERSON, "Anna")
    (tmp_path / "machine.toml").write_text(MACHINE)
    (tmp_path / "campaign.toml").write_text(CAMPAIGN)
    with Campaign.create(tmp_path / "signed.axiscal", read_campaign(tmp_path / "campaign.toml")) as campaign:
        campaign.adopt(tuple(Reading("along x", (0.02 * n,), (1,), 1e-6 * value) for n, value in enumerate(VALUES)))
    assert command("data", "sign", "signed.axiscal").status == 0
    content = (tmp_path / "signed.axiscal").read_bytes()
    lines = lines_in(content)
    forged = [line._replace(said=line.said.replace('"value":2e-06', '"value":9e-06')) for line in lines]
    assert sum(one != other for one, other in zip(lines, forged, strict=True)) == 1
    write_record(tmp_path / "forged.axiscal", content[:HEAD], forged)
    (tmp_path / "poses.csv").write_text("X_mm\n20\n")
    return tmp_path


def commands(command: Command, group: str = "") -> Iterator[tuple[str, list[str]]]:
    """Yield each command that the help lists and that takes a record, with the names of its arguments."""
    for heading, listed in re.findall(r"^(\S[^\n]*):\n((?:  .*\n?)+)", command(*group.split(), "--help").out, re.M):
        if not heading.lower().endswith(("commands", "groups")):
            continue
        for name in re.findall(r"^  (\w+)", listed, re.M):
            words = f"{group} {name}".strip()
            usage = command(*words.split(), "--help").out.split("\n\n")[0]
            if "COMMAND" in usage:
                yield from commands(command, words)
            elif "RECORD" in usage and words not in LEFT:
                yield words, re.findall(r"[{\[]([A-Z][\w.]*)[}\]]", usage.replace("[OPTIONS]", ""))


def test_every_command_that_takes_a_record_refuses_a_forged_one_or_says_it(folder: Path, command: Command) -> None:
    every = dict(commands(command))
    assert len(every) >= 15
    for words, arguments in every.items():
        given = [word for name in arguments for word in (["forged.axiscal"] if name == "RECORD" else GIVEN[name])]
        before = {path.name for path in folder.iterdir()}
        found = command(*words.split(), *given, *OPTIONS.get(words, []))
        made = {path.name for path in folder.iterdir()} - before
        if words in ("status", "step status"):
            assert "changed since it was signed at event" in found.said
        elif words in ("data repair", "data merge"):
            assert re.search(r"Left out: event \d+ \(signed\)", found.said)
            assert b"signed): it answers" in (folder / "new.axiscal").read_bytes()
            (folder / "new.axiscal").unlink()
        else:
            assert "The record was changed since Anna signed it at event" in found.refusal, words
            assert not made, words
    assert "changed since it was signed" in command("step", "status", "forged.axiscal", "--json").document["signed"]
    assert command("step", "status", "signed.axiscal", "--json").document["signed"].startswith("signed by Anna")


def test_a_forged_record_is_no_prior(folder: Path, command: Command) -> None:
    (folder / "next.toml").write_text(f'prior = "forged.axiscal"\n{CAMPAIGN}')
    assert "was changed since Anna signed it" in command("plan", "next.toml").refusal
    with pytest.raises(RecordError, match="was changed since Anna signed it"):
        Campaign.open(folder / "forged.axiscal")
