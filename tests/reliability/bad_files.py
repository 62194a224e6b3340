"""A corpus of bad files: every way to spoil a file, for every kind of file that is read.

Each is read in a process of its own: one typed error, in a second of processor time and 200 MB, or it is still good.
"""

from __future__ import annotations

import os
import random
import resource
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import read_campaign
from axiscal.evaluation.standards import evaluate, positioning_test
from axiscal.exceptions import AxiscalError
from axiscal.machine.description import load_machine
from axiscal.measurement.readers.csv_table import read_poses
from axiscal.measurement.readers.files import read_any, recognised
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import read_truth
from axiscal.record.events import Created, Event, Recorded
from axiscal.record.line_form import EventText
from axiscal.record.payload import encode
from axiscal.record.store import content_of
from tests.generators.texts import campaign_text, machine_text, setup_text
from tests.measurement.test_instrument_files import MAP, MESH, RTL
from tests.measurement.test_level_survey import SURVEY
from tests.measurement.test_readers import READINGS, TRUTH
from tests.reliability.old_tables import GOOD, INI, read_machine, read_old_table
from tests.reliability.trial import Trial, scratch

SECONDS, MEGABYTES = 1.0, 200.0
MACHINE = machine_text("w-X'-b-Y-t", {"X": (0, 300), "Y": (0, 200)}, {"EXX": "20 um", "EYX": "10 um"})
CAMPAIGN = campaign_text(
    "machine.toml",
    setup_text("along x", "interferometer", direction="x", moves=["X"], park={"Y": "100 mm"}, noise="0.3 um"),
    target={"rms": "2 um", "readings": 40},
)
ISO = "target_mm,direction,run,deviation_um\n" + "".join(
    f"{target},{way},{run},{target / 100 + run}\n" for run in (1, 2, 3) for way in "+-" for target in (0, 100, 200)
)
POSES = "X_mm,Y_mm,approach\n10,20,X+ Y-\n30,40,\n"
EXPLOSION = 5_000_000


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of file: the name it has, a good one, and what reads it."""

    name: str
    good: bytes
    read: Callable[[Path], object]


def _kind(name: str, text: str, read: Callable[[Path], object]) -> Kind:
    return Kind(name, text.encode(), read)


def _record() -> bytes:
    """Return the file of a record with two readings."""
    created = Created(MACHINE, CAMPAIGN, "machine.toml", "campaign.toml", {"axiscal": "0.1.0"})
    readings = [Recorded(Reading("along x", (0.1 * n, 0.1), (1, 0), 1e-6 * n)) for n in (1, 2)]
    happened: list[Event] = [created, *readings]
    rows = [EventText("2026-01-01T00:00:00.000+00:00", *encode(event), event is happened[-1]) for event in happened]
    return content_of(rows)[0]


def _recorded(path: Path) -> None:
    Campaign.open(path, write=False).close()


KINDS = (
    _kind("machine.toml", MACHINE, load_machine),
    _kind("campaign.toml", CAMPAIGN, read_campaign),
    _kind("readings.csv", READINGS, read_any),
    _kind("truth.csv", TRUTH, read_truth),
    _kind("poses.csv", POSES, read_poses),
    _kind("iso.csv", ISO, lambda path: evaluate(positioning_test(recognised(path)))),
    _kind("test.rtl", RTL, read_any),
    _kind("heightmap.csv", MAP, read_any),
    _kind("printer.cfg", MESH, read_any),
    _kind("survey.txt", SURVEY, read_any),
    Kind("mill.axiscal", _record(), _recorded),
    _kind("machine.ini", INI, read_machine),
    *(
        _kind(f"{controller}/{name}", text, partial(read_old_table, controller))
        for (controller, name), text in GOOD.items()
    ),
)


def place(kind: Kind, folder: Path) -> Path:
    """Return where a file of a kind is written; the good machine.toml beside it stays."""
    path = folder / ("other.toml" if kind.name == "machine.toml" else kind.name)
    path.parent.mkdir(exist_ok=True)
    return path


def _number(text: bytes) -> Callable[[bytes], bytes]:
    """Return what puts a text in the place of the last number of a file."""

    def spoil(good: bytes) -> bytes:
        end = max((k for k in range(len(good)) if good[k : k + 1].isdigit()), default=0) + 1
        begin = end
        while begin and good[begin - 1 : begin] in b"0123456789.":
            begin -= 1
        return good[:begin] + text + good[end:]

    return spoil


def _in_the_middle(text: bytes) -> Callable[[bytes], bytes]:
    return lambda good: good[: len(good) // 2] + text + good[len(good) // 2 :]


WAYS: Mapping[str, Callable[[bytes], bytes]] = {
    "empty": lambda good: b"",
    "one byte": lambda good: good[:1],
    "only blanks": lambda good: b"   \n\n\t\n",
    "half": lambda good: good[: len(good) // 2],
    "first line": lambda good: good.splitlines(keepends=True)[0],
    "without its first line": lambda good: b"".join(good.splitlines(keepends=True)[1:]),
    "lines in reverse": lambda good: b"".join(reversed(good.splitlines(keepends=True))),
    "twice": lambda good: good + good,
    "NUL": _in_the_middle(b"\0"),
    "not UTF-8": _in_the_middle(b"\xc4\xa7\xff\xfe"),
    "UTF-16": lambda good: good.decode(errors="replace").encode("utf-16"),
    "GBK": lambda good: good.replace(b"m", "钻".encode("gbk"), 1),
    "escape": _in_the_middle(b"\x1b[31m"),
    "not a number": _number(b"nan"),
    "infinite": _number(b"inf"),
    "1e400": _number(b"1e400"),
    "decimal comma": _number(b"1,5,5"),
    "hexadecimal": _number(b"0x1F"),
    "a word": _number(b"seven"),
    "minus minus": _number(b"--3"),
    "two points": _number(b"1.2.3"),
    "Arabic digits": _number("٣".encode()),
    "a formula": _number(b"=1+2"),
    "many digits": _number(b"9" * 5000),
    "quote left open": _in_the_middle(b'"'),
    "three quotes": _in_the_middle(b'"""'),
    "long line": _in_the_middle(b"a" * EXPLOSION),
    "many commas": _in_the_middle(b"," * EXPLOSION),
    "many lines": _in_the_middle(b"x\n" * (EXPLOSION // 50)),
    "deep brackets": _in_the_middle(b"[" * 100_000),
    "deep tables": _in_the_middle(b"\n" + b"a." * 20_000 + b"b = 1\n"),
    "random": lambda good: random.Random(len(good)).randbytes(4096),
    "every letter another": lambda good: bytes((byte + 1) % 256 for byte in good),
    "carriage returns": lambda good: good.replace(b"\n", b"\r"),
    "tabs for commas": lambda good: good.replace(b",", b"\t"),
    "semicolons for commas": lambda good: good.replace(b",", b";"),
}


def corpus() -> Iterator[tuple[Kind, str, bytes]]:
    """Yield kind, way and content of every bad file."""
    for kind in KINDS:
        for way, spoil in WAYS.items():
            yield kind, way, spoil(kind.good)


def read_all(every: int = 1) -> Trial:
    """Read every bad file, or every so manieth."""
    files = list(corpus())[::every]
    with scratch() as top:
        (top / "machine.toml").write_bytes(KINDS[0].good)
        outcomes = [_read(kind, content, top, way) for kind, way, content in files]
    wrong = [outcome for outcome in outcomes if outcome not in ("refused", "read")]
    detail = f"{outcomes.count('refused')} refused, {outcomes.count('read')} still good; {'; '.join(wrong[:5])}"
    return Trial("bad files read", len(files), len(wrong), detail.rstrip("; "))


def _read(kind: Kind, content: bytes, top: Path, way: str) -> str:
    path = place(kind, top)
    path.write_bytes(content)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    child = os.fork()
    if child == 0:
        os._exit(_status(kind, path))
    _, status, used = os.wait4(child, 0)
    path.unlink()
    said = {0: "read", 1: "refused"}.get(os.waitstatus_to_exitcode(status), "a traceback")
    if used.ru_utime + used.ru_stime > SECONDS:
        said = f"{used.ru_utime + used.ru_stime:.1f} s"
    if (used.ru_maxrss - before) / 1024 > MEGABYTES:
        said = f"{(used.ru_maxrss - before) / 1024:.0f} MB"
    return said if said in ("read", "refused") else f"{kind.name}, {way}: {said}"


def _status(kind: Kind, path: Path) -> int:
    try:
        kind.read(path)
    except AxiscalError:
        return 1
    except BaseException:  # noqa: BLE001 - a defect, whatever it is
        return 2
    return 0
