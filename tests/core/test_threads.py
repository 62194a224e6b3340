"""BLAS works with one thread where axiscal computes, and with as many as before where it does not."""

import subprocess
import sys
from pathlib import Path

import pytest

TWO_THREADS = """
import numpy as np
from threadpoolctl import ThreadpoolController
from axiscal_core.threads import one_thread

def threads():
    return sorted({library.num_threads for library in ThreadpoolController().select(user_api="blas").lib_controllers})

ThreadpoolController().limit(limits=2)
"""
WATCHED = """
import scipy.linalg
ThreadpoolController().limit(limits=2)
libraries, outside = ThreadpoolController().select(user_api="blas").lib_controllers, []

def watched(name, real):
    def call(*arguments, **named):
        if any(library.num_threads != 1 for library in libraries):
            outside.append(name)
        return real(*arguments, **named)
    return call

for name in ("qr", "cholesky", "eigh", "svd", "lstsq", "solve"):
    setattr(np.linalg, name, watched(name, getattr(np.linalg, name)))
"""
CAMPAIGN = """machine = "three-axis-mill"
scales = "estimate"
[target]
readings = 8
[[setups]]
name = "probe"
instrument = "probe"
direction = "x"
reach = { X = ["0 mm", "600 mm"], Y = ["0 mm", "400 mm"], Z = ["0 mm", "400 mm"] }
"""


def said(script: str, folder: Path, before: str = TWO_THREADS) -> str:
    """Return what a program prints: the limit is one of the process, and this one has its own."""
    command = [sys.executable, "-c", before + script]
    return subprocess.run(command, check=True, capture_output=True, text=True, cwd=folder).stdout.strip()


def test_a_door_gives_back_what_was_before_even_after_an_error(tmp_path: Path) -> None:
    script = """
print(threads())
try:
    with one_thread():
        print(threads())
        one_thread()(lambda: print(threads()))()
        print(threads())
        raise ValueError
except ValueError:
    print(threads())
"""
    assert said(script, tmp_path).split("\n") == ["[2]", "[1]", "[1]", "[1]", "[2]"]


def test_the_last_of_several_threads_of_python_opens_the_limit(tmp_path: Path) -> None:
    script = """
from threading import Event, Thread
inside, leave = Event(), Event()

@one_thread()
def other():
    inside.set()
    leave.wait(60)

thread = Thread(target=other)
with one_thread():
    thread.start()
    inside.wait(60)
print(threads())
leave.set()
thread.join()
print(threads())
"""
    assert said(script, tmp_path).split("\n") == ["[1]", "[2]"]


@pytest.mark.long
def test_every_command_computes_with_one_thread(tmp_path: Path) -> None:
    (tmp_path / "campaign.toml").write_text(CAMPAIGN)
    script = """
from axiscal.cli.app import run
for command in (
    "machine check three-axis-mill",
    "start campaign.toml a.axiscal",
    "plan campaign.toml --candidates 50",
    "run campaign.toml --source sim:1 --out results",
):
    outside.clear()
    assert run(command.split()) == 0
    print("computed outside:", outside, threads())
"""
    answers = [line for line in said(WATCHED + script, tmp_path).split("\n") if line.startswith("computed")]
    assert answers == ["computed outside: [] [2]"] * 4
