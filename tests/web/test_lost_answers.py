"""A network that fails, and a server that is killed, lose and double nothing: what is sent twice counts once."""

import contextlib
import http.client
import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from uuid import uuid4

import pytest

from tests.web.browser import Browser
from tests.web.served import PATIENCE, Served, kept, served, serving, started
from tests.web.test_page import arrived, stand

KILLED = """
import os, signal, sys
from axiscal.web.desk import Desk
once = Desk.once
def killed(desk, *step):
    {before}
    os.kill(os.getpid(), signal.SIGKILL)
Desk.once = killed
from axiscal.cli import main
sys.argv[0] = "axiscal"
raise SystemExit(main())
"""
"""`axiscal serve` that is killed at a step, before its answer goes out."""
MOMENTS = {"it is done": "once(desk, *step)", "it is begun": "pass"}


@contextmanager
def killed_at_a_step(record: Path, before: str, *options: str) -> Iterator[Served]:
    """Serve a record until the first step kills the server."""
    with serving(record, *options, program=KILLED.format(before=before)) as (page, process):
        yield page
        assert process.wait(timeout=PATIENCE) == -signal.SIGKILL


@pytest.mark.parametrize("moment", MOMENTS)
def test_an_answer_that_is_lost_with_the_server_is_sent_again_and_counts_once(tmp_path: Path, moment: str) -> None:
    record, reading = started(tmp_path), {"text": "-1.7", "step": str(uuid4())}
    with killed_at_a_step(record, MOMENTS[moment]) as page, contextlib.suppress(OSError, http.client.HTTPException):
        last = page.state()["last"]
        page.call("readings", after=last, **reading)
    assert kept(record) == ([-1.7] if moment == "it is done" else [])
    with served(record) as page:
        for _ in range(3):
            assert page.call("readings", after=last, **reading).status == 200
        assert page.call("readings", after=last, text="-1.7", step=str(uuid4())).status == 409
    assert kept(record) == [-1.7]


def test_each_step_counts_once_and_a_refused_one_may_come_again(tmp_path: Path) -> None:
    record = started(tmp_path)
    with served(record) as page:
        first, own = page.state()["last"], str(uuid4())
        assert page.call("readings", after=first, text="-1.7").status == 200
        assert page.call("readings", after=first, text="0.5", step=own).status == 409
        assert page.call("readings", after=page.state()["last"], text="0.5", step=own).status == 200
        forged = {"text": f'"step":"{(skip := str(uuid4()))}"'}
        for path, body in (("notes", forged), ("skips", {"reason": "blocked"}), ("undo", {})):
            body = {"step": skip if path == "skips" else str(uuid4()), "after": page.state()["last"], **body}
            if path == "notes":
                del body["after"]
            before = page.state()["last"]
            assert page.call(path, **body).status == 200
            assert (once := page.state()["last"]) > before
            repeated = page.call(path, **body)
            assert (repeated.status, repeated.document["sentence"]) == (200, "That is kept already.")
            assert page.state()["last"] == once
        assert page.call("undo", after=0, step="no id").status == 422
    assert kept(record) == [-1.7, 0.5]


@pytest.mark.long
@pytest.mark.chromium
def test_a_minute_without_network_keeps_what_is_typed(browser: Browser, tmp_path: Path) -> None:
    record = started(tmp_path)
    with served(record) as server:
        page = browser.page(768, 1024)
        arrived(page, server)
        stand(page)
        page.until("document.activeElement.id === 'field'")
        os.kill(server.process, signal.SIGSTOP)  # it takes in what is sent, and answers later
        page.enter("-1.7")
        page.until("localStorage.getItem('axiscal steps').includes('-1.7')")
        os.kill(server.process, signal.SIGCONT)
        page.until("document.getElementById('count').textContent === 'reading 2 of 4'")
        page.call("Network.enable")
        gone = {"latency": 0, "downloadThroughput": -1, "uploadThroughput": -1}
        page.call("Network.emulateNetworkConditions", offline=True, **gone)
        page.enter("0.5")
        page.until("document.getElementById('heard').textContent.startsWith('No answer yet')")
        assert kept(record) == [-1.7]
        page.call("Network.emulateNetworkConditions", offline=False, **gone)
        page.until("document.getElementById('count').textContent === 'reading 3 of 4'")
        page.until("localStorage.getItem('axiscal steps') === '[]'")
    assert kept(record) == [-1.7, 0.5]
