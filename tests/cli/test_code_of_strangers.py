"""An instrument that came with a record runs only where somebody said yes to its text on this computer."""

import hashlib
import os
import py_compile
import sys
from importlib.util import cache_from_source
from pathlib import Path

import pytest

from axiscal.cli import printing
from axiscal.document import consent
from tests.commands import Command
from tests.measurement.test_written_instruments import GRID, HEAD

SAYING = f"{GRID}\nfrom pathlib import Path\n\nwith Path('RAN').open('a') as file:\n    file.write('ran')\n"
NEVER = (("step", "status"), ("step", "status", "--json"), ("data", "copy"), ("data", "repair"))


@pytest.fixture
def ran(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: Command) -> Path:
    """The file in which the instrument of a record says that it ran; its owner began it on another computer."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "owner"))
    monkeypatch.setattr(consent, "_HERE", set[str]())
    ran = tmp_path / "ran"
    (tmp_path / "own.py").write_text(SAYING.replace("RAN", str(ran)))
    setup = 'name = "plate"\ninstrument = "own.py:Grid"\nmoves = ["X", "Y"]\n'
    (tmp_path / "campaign.toml").write_text(HEAD + setup)
    assert command("step", "start", "campaign.toml", "mill.axiscal").status == 0
    assert command("step", "record", "mill.axiscal", "1 um", "2 um", "--at", "X=120 mm Y=200 mm").status == 0
    return ran


@pytest.fixture
def strange(ran: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The same on a computer where nobody has said anything."""
    ran.unlink()
    for module in [name for name in sys.modules if name.startswith("axiscal_written_")]:
        monkeypatch.delitem(sys.modules, module)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(ran.with_name("user")))
    monkeypatch.setattr(consent, "_HERE", set[str]())
    return ran


def test_who_began_the_campaign_is_not_asked(ran: Path, command: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(consent, "_HERE", set[str]())  # as in another process
    assert command("step", "next", "mill.axiscal").status == 0
    with ran.with_name("own.py").open("a") as file:
        file.write("# another text\n")
    assert "own.py is code that came with this campaign" in command("step", "next", "mill.axiscal").refusal


def test_what_only_looks_never_runs_it(strange: Path, command: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    for said in ("", hashlib.sha256(strange.with_name("own.py").read_bytes()).hexdigest()):
        monkeypatch.setenv(consent.RUN, said)
        for words in NEVER:
            new = [f"new{len(said)}.axiscal"] if "repair" in words else []
            assert "reading" in command(*words, "mill.axiscal", *new).printed, words
            assert not strange.exists(), words


def test_without_a_terminal_it_is_refused_and_the_variable_says_yes(
    strange: Path, command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    digest = hashlib.sha256(strange.with_name("own.py").read_bytes()).hexdigest()
    for words in (("finish",), ("report",), ("step", "next"), ("export", "--to", "csv", "--out", "t"), ("verify",)):
        assert f"sha {digest}" in command(*words, "mill.axiscal").refusal
    (strange.with_name("next.toml")).write_text(
        'prior = "mill.axiscal"\n'
        + HEAD.replace("[[setups]]", "")
        + """
[[setups]]
name = "laser"
instrument = "interferometer"
direction = "x"
moves = ["X"]
"""
    )
    assert f"sha {digest}" in command("plan", "next.toml").refusal
    assert not strange.exists()
    monkeypatch.setenv(consent.RUN, f"{64 * '0'} {digest}")
    assert command("step", "next", "mill.axiscal").status == 0
    assert strange.exists()


def test_a_person_is_asked_once_for_each_text(strange: Path, command: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    answers, asked = iter(["", "y"]), list[str]()

    def answered(prompt: str) -> str:
        asked.append(prompt)
        return next(answers)

    monkeypatch.setattr(printing, "ask", answered)
    monkeypatch.setattr("sys.stdin.isatty", lambda: True)
    assert command("step", "next", "mill.axiscal").status == 1
    found = command("step", "next", "mill.axiscal")
    lines = len(strange.with_name("own.py").read_text().splitlines())
    assert f"Run {lines} lines of {strange.with_name('own.py')}" in " ".join(found.err.split())
    monkeypatch.setattr(consent, "_HERE", set[str]())
    assert (found.status, command("step", "next", "mill.axiscal").status, len(asked)) == (0, 0, 2)


def test_what_was_compiled_beside_it_does_not_run(
    strange: Path, command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Python would take a file of __pycache__ that names time and size of the text, whatever it holds."""
    own, other = strange.with_name("own.py"), strange.with_name("other.py")
    other.write_text(own.read_text().replace("/ran'", "/nar'"))
    os.utime(other, ns=(own.stat().st_atime_ns, own.stat().st_mtime_ns))
    assert other.stat().st_size == own.stat().st_size
    py_compile.compile(str(other), cache_from_source(str(own)))
    monkeypatch.setenv(consent.RUN, hashlib.sha256(own.read_bytes()).hexdigest())
    assert command("step", "next", "mill.axiscal").status == 0
    assert strange.exists()
    assert not strange.with_name("nar").exists()
