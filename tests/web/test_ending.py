"""Ctrl-C of `axiscal serve` while something long is computed: it ends all the same, and says what was left."""

import contextlib
import signal
import threading
from pathlib import Path

import pytest

from axiscal.campaign.campaign import Campaign
from tests.web.served import PATIENCE, Served, serving, started

LONG = """
import functools, sys, time
from {room} import {holder}
done = {holder}.{step}
@functools.wraps(done)
def long(subject, *words, **more):
    {before}
    sys.stderr.write("at work\\n")
    sys.stderr.flush()
    {lost}
    for _ in range(10**6):
        time.sleep(0.01)
{holder}.{step} = long
from axiscal.cli import main
sys.argv[0] = "axiscal"
raise SystemExit(main())
"""
"""`axiscal serve` with a step of the desk that takes hours."""


LOST = """try:
        for _ in range(10**6):
            time.sleep(0.01)
    except KeyboardInterrupt:
        pass"""
"""An interruption that nobody hears of, as one that comes while Python clears up."""


def ended(record: Path, program: str, *, asked: bool) -> tuple[int, str, str]:
    """Return status and what is said of a server that gets Ctrl-C while it computes."""
    with serving(record, program=program) as (page, process):
        assert process.stderr is not None
        if asked:
            last = page.state()["last"]
            request = threading.Thread(target=_read, args=(page, last), daemon=True)
            request.start()
        while "at work" not in process.stderr.readline():
            pass
        process.send_signal(signal.SIGINT)
        said, complaint = process.communicate(timeout=PATIENCE)
        return process.returncode, said, complaint


def _read(page: Served, last: int) -> None:
    """Give a reading, whose answer never comes."""
    with contextlib.suppress(OSError):
        page.call("readings", after=last, text="0.4")


@pytest.mark.long
def test_what_is_computed_meanwhile_is_broken_off(tmp_path: Path) -> None:
    record = started(tmp_path)
    status, said, complaint = ended(
        record, LONG.format(room="axiscal.web.desk", holder="Desk", step="think", before="pass", lost=LOST), asked=False
    )
    assert (status, complaint) == (0, "")
    assert "Ended; every reading is kept. What was being computed was broken off; what is kept is shown" in said


def test_a_reading_that_was_kept_is_there_when_its_answer_was_broken_off(tmp_path: Path) -> None:
    record = started(tmp_path)
    before = "done(subject, *words, **more)"
    program = LONG.format(room="axiscal.present.guide", holder="slips", step="keep", before=before, lost="pass")
    status, said, complaint = ended(record, program, asked=True)
    assert (status, complaint) == (0, "")
    assert "What was being computed was broken off" in said
    with Campaign.open(record, write=False) as campaign:
        assert [reading.value for reading in campaign.state.readings] == [pytest.approx(0.4e-6)]
