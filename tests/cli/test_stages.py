"""What a command that takes long says of itself: one line that changes."""

from __future__ import annotations

import io
import subprocess
import sys

import pytest

from axiscal.cli import stages
from axiscal.language.stages import stage


class Terminal(io.StringIO):
    """A stderr that a person looks at."""

    def isatty(self) -> bool:
        return True


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


def test_a_command_is_watched_and_its_line_goes_when_it_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    err = Terminal()
    monkeypatch.setattr("sys.stderr", err)
    monkeypatch.delenv("AXISCAL_PROGRESS")
    with stages.shown_stages(), stage("long"), stage("a part"):
        pass
    assert [line.strip() for line in err.getvalue().split("\r") if line] == ["long …", "a part …", "long …", ""]
