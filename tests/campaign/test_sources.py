"""Sources of readings: what they are sent, what they may answer, and how they fail."""

import json
import math
import shlex
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from axiscal.campaign.sources import Answer, Skip, Source, open_source
from axiscal.campaign.sources import exec as exec_source
from axiscal.campaign.sources.exec import ExecSource
from axiscal.document import line_program
from axiscal.exceptions import InputError, SourceError
from axiscal.measurement.instruments.distance import TouchedSphere
from axiscal.measurement.instruments.rotation import Level
from axiscal.measurement.setup import Setup
from tests.generators.designs import of_kind
from tests.generators.requests import REQUEST, SETUP, SIMULATOR

LEVEL = replace(of_kind(SETUP, Level), name="level on the table")
Opened = Callable[[str], Source]


@pytest.fixture
def opened() -> Iterator[Opened]:
    sources: list[Source] = []

    def open_one(text: str) -> Source:
        sources.append(open_source(text, SIMULATOR, timeout=20))
        return sources[-1]

    yield open_one
    for source in sources:
        source.close()


@pytest.fixture
def answering(tmp_path: Path, opened: Opened) -> Callable[[str], Source]:
    """Open a command that runs a script for each line it reads, which it finds in `asked`."""

    def start(script: str) -> Source:
        path = tmp_path / "instrument.py"
        body = "\n    ".join(script.splitlines())
        path.write_text(f"import sys, json, time\nfor line in sys.stdin:\n    asked = json.loads(line)\n    {body}\n")
        return opened(f"exec:{shlex.quote(sys.executable)} -u {shlex.quote(str(path))}")

    return start


def say(text: str) -> str:
    return f"print({text!r})"


def test_the_request_is_the_documented_line() -> None:
    request = replace(REQUEST, pose=(0.12, math.radians(30)))
    assert json.loads(json.dumps(request.message())) == {
        "reading": 7,
        "setup": "laser along X",
        "instrument": "interferometer",
        "direction": [1, 0, 0],
        "position": {"X": 120.0, "C": 30.0},
        "approach": {"X": "+"},
        "units": {"X": "mm", "C": "deg"},
    }


def test_a_command_sees_the_request_and_its_answer_comes_back_in_si(answering: Callable[[str], Source]) -> None:
    source = answering('print(json.dumps({"value": asked["position"]["X"], "unit": "um"}))')
    assert source.read(REQUEST) == Answer(120e-6)
    assert source.read(replace(REQUEST, pose=(0.6, 0))) == Answer(600e-6)


@pytest.mark.parametrize(
    ("line", "setup", "answer"),
    [
        ('{"value": 1.7, "unit": "um"}', SETUP, Answer(1.7e-6)),
        ('{"value": 1.7, "unit": "µm", "std": 0.5}', SETUP, Answer(1.7e-6, 0.5e-6)),
        ('{"value": -2, "unit": "nm", "std": null}', SETUP, Answer(-2e-9)),
        ('{"value": 1, "unit": "um", "reading": 7, "temperature": 20.1}', SETUP, Answer(1e-6)),
        ('{"value": 2.5, "unit": "urad"}', LEVEL, Answer(2.5e-6)),
        ('{"value": 1, "unit": "arcsec"}', LEVEL, Answer(math.pi / 648000)),
        ('{"skip": " the beam is blocked "}', SETUP, Skip("the beam is blocked")),
    ],
)
def test_answers_that_are_understood(
    answering: Callable[[str], Source], line: str, setup: Setup, answer: Answer | Skip
) -> None:
    got = answering(say(line)).read(replace(REQUEST, setup=setup))
    if isinstance(answer, Answer) and isinstance(got, Answer):
        assert got.value == pytest.approx(answer.value, rel=1e-15)
        assert got.std == (None if answer.std is None else pytest.approx(answer.std, rel=1e-15))
    else:
        assert got == answer


@pytest.mark.parametrize("line", ["[" * 50_000, "x" * 200_000], ids=["brackets", "letters"])
def test_a_line_without_end_is_refused(answering: Callable[[str], Source], line: str) -> None:
    with pytest.raises(SourceError, match="no JSON object"):
        answering(say(line)).read(REQUEST)


def test_a_command_that_dies_is_quoted(answering: Callable[[str], Source], capfd: pytest.CaptureFixture[str]) -> None:
    source = answering('sys.stderr.write("no laser on port 3\\n"); sys.exit(4)')
    for _ in range(2):
        with pytest.raises(SourceError, match=r"ended with status 4.*: no laser on port 3\. .*--resume"):
            source.read(REQUEST)
    assert "no laser on port 3" in capfd.readouterr().err


def test_a_command_that_stalls_is_given_up(answering: Callable[[str], Source], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(exec_source, "GRACE", 0.2)
    source = answering("time.sleep(60)")
    assert isinstance(source, ExecSource)
    source._timeout = 0.2
    with pytest.raises(SourceError, match=r"not answered within 0\.2 s"):
        source.read(REQUEST)
    source.close()


def test_a_line_that_nobody_asked_for_is_not_taken_for_the_next_answer(answering: Callable[[str], Source]) -> None:
    line = '{"value": 1, "unit": "um"}'
    source = answering(f"sys.stdout.write({line!r} + chr(10) + {line!r} + chr(10))")
    assert isinstance(source, ExecSource)
    source.read(REQUEST)
    with pytest.raises(SourceError, match="without being asked"):
        source.read(REQUEST)


FORKS = """
import os, sys, time
if os.fork() == 0:
    print(os.getpid(), file=open(sys.argv[1], "w"), flush=True)
    time.sleep(600)
"""
FLOODS = """
import sys
while True:
    print("word " * 200)
"""


def script(opened: Opened, tmp_path: Path, text: str, argument: str) -> ExecSource:
    path = tmp_path / "instrument.py"
    path.write_text(text)
    source = opened("exec:" + shlex.join([sys.executable, "-u", str(path), argument]))
    assert isinstance(source, ExecSource)
    return source


def test_a_command_that_leaves_its_work_to_a_child_and_ends_is_noticed(opened: Opened, tmp_path: Path) -> None:
    """The child keeps the pipes open: waiting for their end would last as long as a reading may."""
    child = tmp_path / "child"
    source = script(opened, tmp_path, FORKS, str(child))
    with pytest.raises(SourceError, match="ended with status 0 before it answered"):
        source.read(REQUEST)
    source.close()
    while not child.exists() or not child.read_text().strip():
        time.sleep(0.01)
    for _ in range(1000):
        if not Path(f"/proc/{child.read_text().strip()}").exists() or "Z" in _state(child):
            break
        time.sleep(0.01)
    else:
        pytest.fail("the child still runs")


def _state(child: Path) -> str:
    try:
        return Path(f"/proc/{child.read_text().strip()}/stat").read_text().split()[2]
    except OSError:
        return "Z"


@pytest.mark.long
def test_a_flood_is_bounded(opened: Opened, tmp_path: Path) -> None:
    source = script(opened, tmp_path, FLOODS, "")
    source._timeout = 1.0
    for _ in range(2):
        with pytest.raises(SourceError, match=r"without being asked|no JSON object"):
            source.read(REQUEST)
    assert len(source._lines._heard) <= 2 * line_program.LONGEST
    source.close()


def test_a_command_that_will_not_end_is_ended(
    answering: Callable[[str], Source], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(exec_source, "GRACE", 0.2)
    source = answering(
        "import signal; signal.signal(signal.SIGTERM, signal.SIG_IGN)\n"
        + say('{"value": 1, "unit": "um"}')
        + "\nwhile True: time.sleep(1)"
    )
    assert isinstance(source, ExecSource)
    source.read(REQUEST)
    source.close()
    source.close()
    assert source._lines.process.returncode == -9


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("target_mm,direction,run,deviation_um\n0,+,1,1\n", "a test of one axis"),
        ("0 0 1\n9 0 1\n", "a list of points X Y Z"),
    ],
)
def test_a_file_that_is_not_in_the_order_asked_is_no_source(
    opened: Opened, tmp_path: Path, text: str, says: str
) -> None:
    (tmp_path / "r.csv").write_text(text)
    with pytest.raises(InputError, match=f"this is {says}.*, and no table of readings in the order asked"):
        opened(f"csv:{tmp_path}/r.csv")


def test_the_noise_of_a_reading_does_not_depend_on_those_before(opened: Opened) -> None:
    through, resumed = opened("sim:3"), opened("sim:3")
    readings = [through.read(replace(REQUEST, reading=number)) for number in range(1, 6)]
    assert resumed.read(replace(REQUEST, reading=5)) == readings[-1]
    assert len(set(readings)) == 5


@pytest.fixture
def table(tmp_path: Path, opened: Opened) -> Callable[[str], Source]:
    def write(text: str) -> Source:
        (tmp_path / "r.csv").write_text(text)
        return opened(f"csv:{tmp_path}/r.csv")

    return write


def test_a_table_answers_in_its_order(table: Callable[[str], Source]) -> None:
    source = table("value_um\n1.5\n-2\n")
    assert [source.read(REQUEST), source.read(REQUEST)] == [Answer(1.5e-6), Answer(-2e-6)]
    with pytest.raises(SourceError, match="there are 2 readings in it, and reading 9"):
        source.read(replace(REQUEST, reading=9))


def test_a_table_answers_with_the_three_values_of_a_sphere(table: Callable[[str], Source]) -> None:
    source = table("value_x_um,value_y_um,value_z_um\n1,2,3\n")
    assert source.read(replace(REQUEST, setup=of_kind(SETUP, TouchedSphere))) == Answer(1e-6, others=(2e-6, 3e-6))


def test_a_resumed_run_goes_on_in_the_table(tmp_path: Path) -> None:
    (tmp_path / "r.csv").write_text("value_um\n1\n2\n3\n")
    source = open_source(f"csv:{tmp_path}/r.csv", SIMULATOR, taken=2)
    assert source.read(REQUEST) == Answer(3e-6)
    with pytest.raises(SourceError, match="fewer readings than the 4"):
        open_source(f"csv:{tmp_path}/r.csv", SIMULATOR, taken=4)


def test_a_row_that_agrees_is_answered(table: Callable[[str], Source]) -> None:
    text = "setup,X_mm,C_deg,approach,value_um,value_urad,std_um\nlaser along X,120.0005,30,X+,1.5,,0.5\n,,,,-1,,\n"
    source = table(text)
    assert source.read(REQUEST) == Answer(1.5e-6, 0.5e-6)
    assert source.read(REQUEST) == Answer(-1e-6)
