"""Processes that work, that are killed, and whose head is killed."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from axiscal.document.durable import is_running
from axiscal.ports.study.results import FILE, Processes, Results, run_missing
from axiscal.ports.study.study_case import Done, WorkItem, here
from tests.ports.deeds import COUNT, doubled, ending_always, ending_once, numbers, refusing_odd

ROOT = Path(__file__).resolve().parents[2]
_PATIENCE = 60.0


def _by_key(found: list[Done]) -> dict[str, Done]:
    assert len({done.key for done in found}) == len(found)
    return {done.key: done for done in found}


def test_processes_answer_each_question_once_with_one_thread_each() -> None:
    found = _by_key(list(Processes(2)(doubled, numbers())))
    assert {key: done.result["twice"] for key, done in found.items() if done.result} == {
        str(number): 2 * number for number in range(COUNT)
    }
    workers = {done.result["process"] for done in found.values() if done.result}
    assert len(workers) == 2
    assert os.getpid() not in workers
    assert {done.result["threads"] for done in found.values() if done.result} == {1}
    assert not any(is_running(worker) for worker in workers)


def test_what_is_wrong_with_one_question_is_kept_and_the_others_go_on() -> None:
    alone, spread = (_by_key(list(engine(refusing_odd, numbers(6)))) for engine in (here, Processes(2)))
    assert alone == spread
    assert alone["1"] == Done("1", None, "one is wrong. Take two.")
    assert alone["3"].error == "a defect in axiscal: ZeroDivisionError: odd"
    assert alone["4"].result == {"twice": 8}


def test_a_worker_that_is_killed_is_replaced_and_its_question_asked_again(tmp_path: Path) -> None:
    killing = {3, 4, 11}
    questions = [
        WorkItem(str(n), (n, str(tmp_path / f"killed-{n}") if n in killing else "")) for n in range(COUNT)
    ]  # fmt: skip
    found = _by_key(list(Processes(2)(ending_once, questions)))
    assert len(list(tmp_path.glob("killed-*"))) == len(killing)
    assert {key: done.result for key, done in found.items()} == {str(n): {"twice": 2 * n} for n in range(COUNT)}


def test_a_question_that_ends_every_process_becomes_an_error_and_harms_no_other() -> None:
    found = _by_key(list(Processes(2)(ending_always, numbers(8))))
    assert found["3"].result is None
    assert "ended without a word, 4 times" in found["3"].error
    assert [key for key, done in sorted(found.items()) if done.result is None] == ["3"]


def test_leaving_early_ends_the_processes() -> None:
    coming = Processes(2)(doubled, numbers())
    first = next(coming)
    coming.close()
    assert first.result is not None
    assert not is_running(first.result["process"])


@pytest.mark.long
@pytest.mark.skipif(sys.platform == "win32", reason="needs SIGKILL")
def test_a_head_that_is_killed_loses_nothing_and_leaves_no_process(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "tests.ports.head", str(tmp_path)]
    head = subprocess.Popen(command, cwd=ROOT, env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)})
    try:
        _wait(lambda: _kept(tmp_path) >= 5)
        workers = _children(head.pid)
    finally:
        head.send_signal(signal.SIGKILL)
        head.wait()
    assert workers
    _wait(lambda: not any(is_running(worker) for worker in workers))
    before = _kept(tmp_path)
    assert 5 <= before < 200
    with Results(tmp_path, "text", "digest", {"axiscal": "1"}, resume=True) as results:
        ran = run_missing(results, numbers(200), 200, doubled, here)
        found = dict(results.found)
    assert (ran.there, ran.computed, ran.failed) == (before, 200 - before, 0)
    assert {key: done.result["twice"] for key, done in found.items() if done.result} == {
        str(number): 2 * number for number in range(200)
    }


def _wait(done: Callable[[], bool]) -> None:
    until = time.monotonic() + _PATIENCE
    while not done():
        assert time.monotonic() < until
        time.sleep(0.05)


def _kept(folder: Path) -> int:
    file = folder / FILE
    return file.read_bytes().count(b"\n") - 1 if file.exists() else 0


def _children(process: int) -> list[int]:
    """Return the processes that a process has started, those that work and those that watch over them."""
    found = list[int]()
    for entry in Path("/proc").glob("[0-9]*/stat"):
        try:
            parent = int(entry.read_text().rpartition(")")[2].split()[1])
        except OSError:
            continue
        if parent == process:
            found.append(int(entry.parent.name))
    return found
