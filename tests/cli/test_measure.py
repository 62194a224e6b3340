"""The prompt, driven through a pseudo-terminal as a person would: a whole campaign, and what goes wrong on the way."""

from __future__ import annotations

import os
import pty
import re
import select
import signal
import sys
import time
from pathlib import Path

import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.cli import app
from tests.commands import Command
from tests.generators.begun import begun
from tests.generators.texts import FOUR_READINGS
from tests.web.served import kept

STANDS = "Enter when it stands, or ? > "
WARM = "Temperature of the machine's scale [degC], Enter: not measured > "
PATIENCE = 60.0
"""s: for a prompt to come on a busy computer."""


class Terminal:
    """`axiscal measure` in a terminal of its own."""

    def __init__(self, folder: Path, *arguments: str) -> None:
        self.screen, self._read = "", 0
        self.pid, self.terminal = pty.fork()
        if self.pid == 0:
            os.chdir(folder)
            signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored where the tests run in the background
            signal.signal(signal.SIGHUP, signal.SIG_DFL)  # and this one where they outlive a terminal
            words = [sys.executable, "-m", "axiscal", "measure", *arguments]
            os.execvpe(sys.executable, words, {**os.environ, "TERM": "dumb", "AXISCAL_LANGUAGE": "en"})

    def until(self, prompt: str) -> str:
        """Return what came on the screen up to and with a prompt since the last one."""
        while prompt not in self.screen[self._read :]:
            ready, _, _ = select.select([self.terminal], [], [], PATIENCE)
            assert ready, f"no {prompt!r} after: {self.screen}"
            try:
                came = os.read(self.terminal, 4096)
            except OSError:
                came = b""
            assert came, f"ended before {prompt!r}: {self.screen}"
            self.screen += came.decode()
        end = self.screen.index(prompt, self._read) + len(prompt)
        shown, self._read = self.screen[self._read : end], end
        return shown

    def type(self, line: str) -> None:
        """Type a line."""
        os.write(self.terminal, (line + "\n").encode())

    def stand(self, warm: str = "") -> None:
        """Say that the laser stands, and how warm the scale is."""
        self.type("")
        self.until(WARM)
        self.type(warm)

    def ended(self) -> int:
        """Return the exit status; minus the number of the signal that ended it."""
        return os.waitstatus_to_exitcode(os.waitpid(self.pid, 0)[1])


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with a campaign that has been started."""
    begun(tmp_path, {"campaign.toml": FOUR_READINGS}, ("start", "campaign.toml", "mill.axiscal"))
    return tmp_path


def test_a_whole_campaign_from_the_prompt_alone(folder: Path) -> None:
    terminal = Terminal(folder)
    shown = terminal.until(STANDS)
    assert 'Set-up "laser": mount: interferometer; it reads along x, while X moves' in shown
    terminal.type("1.5")  # no reading: it does not stand yet
    assert "press Enter when the set-up stands" in terminal.until(STANDS)
    terminal.stand("70")
    assert '"70 degC" is too large. Write a value from -20 degC to 60 degC' in terminal.until(WARM)
    terminal.type("21,4")
    shown = terminal.until("reading [um] > ")
    assert 'The readings of "laser" are brought from 21,4 degC to 20 degC' in shown
    assert "reading 1 of 4" in shown
    assert "+ where the tool stands too far towards +x" in shown
    terminal.type("-1,7")
    assert "Kept reading 1; it is on the disk" in terminal.until("reading [um] > ")
    terminal.type("twelve")
    assert "Type the number that the instrument shows" in terminal.until("reading [um] > ")
    terminal.type("0.0005 mm")
    assert "Kept reading 2" in terminal.until("reading [um] > ")
    terminal.type("undo")
    assert "Took back reading 2" in terminal.until("reading [um] > ")
    terminal.type("400")
    assert re.search(r"It is about \d+ um away from what is expected, ± \d", terminal.until("Enter to read again: "))
    terminal.type("")
    terminal.until("reading [um] > ")
    for value in ("0.4", "1.1", "0.2"):
        terminal.type(value)
        shown = terminal.until("Kept reading ")
    assert "Done: 4 readings taken" in terminal.until("note or pause > ")
    terminal.type("note it was 21.4 °C")
    terminal.until("note or pause > ")
    terminal.type("undo")
    assert "Took back reading 4" in terminal.until("reading [um] > ")
    terminal.type("0.2")
    terminal.until("note or pause > ")
    terminal.type("")
    assert "MEASURED   4 readings" in terminal.until("mill-results/report.pdf")
    assert terminal.ended() == 0
    assert kept(folder / "mill.axiscal") == [-1.7, 0.4, 1.1, 0.2]
    assert (folder / "mill-results" / "report.pdf").is_file()
    with Campaign.open(folder / "mill.axiscal", write=False) as campaign:
        assert campaign.state.notes[-1].text == "it was 21.4 °C"
        assert campaign.description.setup("laser").warmer == pytest.approx(1.4)


@pytest.mark.long
def test_a_pause_goes_on_where_it_was_and_answers_no_question_of_another_program(folder: Path) -> None:
    first = Terminal(folder)
    first.until(STANDS)
    first.stand()
    first.until("reading [um] > ")
    first.type("2")
    first.until("reading [um] > ")
    first.type("pause")
    assert "Go on: axiscal measure mill.axiscal" in first.until("measure mill.axiscal")
    assert first.ended() == 0
    second = Terminal(folder, "mill.axiscal")
    assert "reading 2 of 4" in second.until("reading [um] > ")
    with Campaign.open(folder / "mill.axiscal") as other:
        other.record(2.5e-6)
    second.type("9.9")
    shown = second.until("reading [um] > ")
    assert "the record has moved on" in shown
    assert "reading 3 of 4" in shown
    second.type("skip the beam is blocked")
    assert "Skipped" in second.until("reading [um] > ")
    second.type("\x04")
    assert second.ended() == 0
    assert kept(folder / "mill.axiscal") == [2.0, 2.5]


def test_ctrl_c_ends_with_a_sentence_and_status_one(folder: Path) -> None:
    terminal = Terminal(folder)
    terminal.until(STANDS)
    time.sleep(0.3)  # between its prompt and its reading Python would heed the signal only after the next key
    os.write(terminal.terminal, b"\x03")
    said = " ".join(terminal.until("axiscal measure").split())
    assert "0 readings are kept in mill.axiscal; go on with: axiscal measure" in said
    assert terminal.ended() == 1


def test_the_record_is_asked_for_where_there_are_two(
    folder: Path, command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    (folder / "other.axiscal").write_bytes((folder / "mill.axiscal").read_bytes())
    monkeypatch.chdir(folder)
    assert "mill.axiscal, other.axiscal" in command("status").refusal
    monkeypatch.setenv("AXISCAL_RECORD", str(folder / "mill.axiscal"))
    assert app.run(["status"]) == 0
