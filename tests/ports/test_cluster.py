"""A cluster of its own processes: Dask's scheduler and a worker, started as a person would."""

from __future__ import annotations

import os
import shutil
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from axiscal.exceptions import SchedulerError
from axiscal.ports.study import cluster
from axiscal.ports.study.cluster import Cluster
from axiscal.ports.study.study_case import Done, WorkItem, here
from tests.ports.deeds import COUNT, doubled_slowly, ending_once, numbers, refusing_odd

ROOT = Path(__file__).resolve().parents[2]
pytestmark = pytest.mark.filterwarnings("ignore:.*:DeprecationWarning", "ignore:.*:ResourceWarning")


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    """The address of a scheduler with one worker, both separate processes."""
    with _scheduler() as (where, _), _started("worker", where, "--nworkers", "1", "--nthreads", "1", "--no-dashboard"):
        yield where


@contextmanager
def _scheduler() -> Iterator[tuple[str, subprocess.Popen[bytes]]]:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = str(free.getsockname()[1])
    with _started("scheduler", "--host", "127.0.0.1", "--port", port, "--no-dashboard") as process:
        yield f"tcp://127.0.0.1:{port}", process


@contextmanager
def _started(kind: str, *words: str) -> Iterator[subprocess.Popen[bytes]]:
    with_us = ["setpriv", "--pdeathsig", "TERM"] if shutil.which("setpriv") else []  # a killed run leaves none behind
    command = [*with_us, sys.executable, "-m", "dask", kind, *words]
    paths = os.pathsep.join([str(ROOT), *sys.path])
    process = subprocess.Popen(
        command, cwd=ROOT, env=os.environ | {"PYTHONPATH": paths}, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    try:
        yield process
    finally:
        process.terminate()
        try:
            process.wait(15)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def _sorted(found: list[Done]) -> list[Done]:
    return sorted(found, key=lambda done: done.key)


@pytest.mark.long
def test_a_cluster_gives_what_one_process_gives(address: str) -> None:
    questions = numbers(3 * cluster.IN_FLIGHT)
    assert _sorted(list(Cluster(address, "same")(refusing_odd, questions))) == _sorted(
        list(here(refusing_odd, questions))
    )


@pytest.mark.long
def test_a_worker_of_a_cluster_that_is_killed_loses_nothing(address: str, tmp_path: Path) -> None:
    questions = [WorkItem(str(n), (n, str(tmp_path / "killed") if n == 5 else "")) for n in range(COUNT)]
    found = list(Cluster(address, "killed")(ending_once, questions))
    assert (tmp_path / "killed").exists()
    assert {done.key: done.result for done in found} == {str(n): {"twice": 2 * n} for n in range(COUNT)}


class Waiting:
    """A future whose answer went with its worker, and comes from another after so many looks; a client of it."""

    def __init__(self, looks: int, status: str) -> None:
        self.looks, self.status = looks, status

    def result(self, timeout: float) -> Done:
        """Return the answer, if it is there after so many seconds."""
        assert timeout > 0
        self.looks -= 1
        if self.looks >= 0:
            raise TimeoutError
        return Done("1", {"twice": 2})


def test_an_answer_that_went_with_its_worker_is_waited_for_while_the_scheduler_is_there() -> None:
    waiting: Any = Waiting(3, "running")
    assert cluster._result(waiting, waiting, WorkItem("1", 1), "tcp://here:1").result == {"twice": 2}
    gone: Any = Waiting(3, "connecting")
    with pytest.raises(SchedulerError, match="went away"):
        cluster._result(gone, gone, WorkItem("1", 1), "tcp://here:1")


def test_workers_of_another_version_are_refused(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "versions", lambda: {"axiscal": "0.0.0"})
    with pytest.raises(SchedulerError, match=r"has axiscal .*, and this is 0\.0\.0"):
        list(Cluster(address, "version")(doubled_slowly, numbers(3)))


@pytest.mark.long
def test_a_scheduler_that_goes_away_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "_LOST", 2.0)
    with _scheduler() as (where, process), _started("worker", where, "--nthreads", "1", "--no-dashboard"):
        coming = Cluster(where, "gone")(doubled_slowly, numbers(400))
        assert next(coming).result is not None
        process.send_signal(signal.SIGKILL)
        with pytest.raises(SchedulerError, match="went away"):
            list(coming)


def test_a_scheduler_that_is_not_there_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "_CONNECT", 0.5)
    with pytest.raises(SchedulerError, match=r"no scheduler answers at tcp://127\.0\.0\.1:9"):
        list(Cluster("tcp://127.0.0.1:9", "d")(doubled_slowly, numbers(2)))


def test_a_scheduler_without_workers_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "_WORKERS", 0.5)
    with _scheduler() as (where, _), pytest.raises(SchedulerError, match="has no worker"):
        list(Cluster(where, "d")(doubled_slowly, numbers(2)))


@pytest.mark.parametrize("address", ["nowhere", "udp://127.0.0.1:1", "tcp://127.0.0.1:many", "tcp://127.0.0.1"])
def test_an_address_that_is_none_is_refused(address: str) -> None:
    with pytest.raises(SchedulerError, match="no address of a scheduler"):
        list(Cluster(address, "d")(doubled_slowly, numbers(2)))


def test_tls_needs_certificates_which_dask_is_told() -> None:
    with pytest.raises(SchedulerError, match=r"needs certificates.*distributed\.comm\.tls"):
        list(Cluster("tls://127.0.0.1:9", "d")(doubled_slowly, numbers(2)))


def test_without_dask_it_is_said_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(SchedulerError, match=r"pip install \"axiscal\[dask\]\""):
        list(Cluster("tcp://127.0.0.1:9", "d")(doubled_slowly, numbers(2)))


def test_a_scheduler_on_this_computer_or_over_tls_is_not_open_to_others() -> None:
    ours = ["tcp://127.0.0.1:8786", "tls://10.0.0.5:8786"]
    others = ["tcp://10.0.0.5:8786", "tcp://127.0.0.1.example.org:1"]
    assert [Cluster(where, "d").open_to_others for where in (*ours, *others)] == [False, False, True, True]


def test_the_package_is_loaded_without_dask() -> None:
    said = "import sys, axiscal.cli.study; print(sorted({'dask', 'distributed'} & set(sys.modules)))"
    paths = {"PYTHONPATH": os.pathsep.join(sys.path)}
    assert subprocess.run([sys.executable, "-c", said], env=os.environ | paths, capture_output=True).stdout == b"[]\n"
