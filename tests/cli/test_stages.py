"""What a command that takes long says of itself: one line that changes."""

from __future__ import annotations

import io
import subprocess
import sys
import threading

import pytest

from axiscal.cli import stages
from axiscal.cli.stages import StageLine
from axiscal.language.stages import Listener, listening, stage, staged


class Terminal(io.StringIO):
    """A stderr that a person looks at."""

    def isatty(self) -> bool:
        return True


def test_nothing_is_said_in_the_first_seconds(monkeypatch: pytest.MonkeyPatch) -> None:
    err = Terminal()
    monkeypatch.setattr("sys.stderr", err)
    shown = StageLine()
    with listening(Listener(shown.stages, shown.wipe)), stage("one"):
        shown.show(shown.start + 1.0)
        assert err.getvalue() == ""
        shown.show(shown.start + 2.5)
        assert err.getvalue().strip() == "one, 2 s so far"


def test_on_a_terminal_one_line_changes_and_goes_when_the_work_is_done(monkeypatch: pytest.MonkeyPatch) -> None:
    err = Terminal()
    monkeypatch.setattr("sys.stderr", err)
    shown = StageLine()
    shown.start -= 4.0
    with listening(Listener(shown.stages, shown.wipe)):
        for _ in staged("readings", "abcdefghijklmnopqrst", 20):
            shown.show(shown.start + 4.0)
    said = [line.rstrip() for line in err.getvalue().split("\r") if line.strip()]
    assert said[0] == "readings, 0 of 20, 4 s so far"
    assert said[10].startswith("readings, 10 of 20, about ")
    assert "left, 4 s so far" in said[10]
    assert err.getvalue().split("\r")[-2].isspace()


def test_ctrl_c_that_was_answered_ends_with_status_1_and_not_by_the_signal() -> None:
    """Python itself ends a process by the signal where it met the code of a text, whoever caught it."""
    program = (
        "import signal, axiscal.cli, axiscal.cli.app\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"  # ignored where the tests run in the background
        "def run(words):\n"
        "    try:\n"
        "        exec('import os, signal, time; os.kill(os.getpid(), signal.SIGINT); time.sleep(9)')\n"
        "    except KeyboardInterrupt:\n"
        "        return 1\n"
        "axiscal.cli.app.run = run\n"
        "raise SystemExit(axiscal.cli.main())\n"
    )
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 1


def test_a_command_is_watched_until_it_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    err, looked = Terminal(), threading.Event()
    monkeypatch.setattr("sys.stderr", err)
    monkeypatch.setattr(stages, "_QUIET", 0.0)
    monkeypatch.setattr(stages, "_LOOK", 0.001)
    show = StageLine.show

    def seen(self: StageLine, now: float) -> None:
        show(self, now)
        if err.getvalue():
            looked.set()

    monkeypatch.setattr(StageLine, "show", seen)
    monkeypatch.delenv("AXISCAL_PROGRESS")
    before = threading.active_count()
    with stages.shown_stages(), stage("long work"):
        assert looked.wait(20)
    assert err.getvalue().startswith("\rlong work, ")
    assert threading.active_count() == before
