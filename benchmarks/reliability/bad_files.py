"""A corpus of bad files: every way to spoil a file, for every kind of file that is read.

Right files are those of `tests/refusals`, and a record. Each bad one is read in a process of its own: one typed error,
in a second of processor time and 200 MB, or it is still good.
"""

from __future__ import annotations

import os
import random
import resource
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path

from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import campaign_from_texts, read_campaign
from axiscal.description.ini_file import read_ini
from axiscal.description.ini_machine import machine_of
from axiscal.evaluation.standards import evaluate, positioning_test
from axiscal.exceptions import AxiscalError
from axiscal.machine.description import load_machine, machine_from_text
from axiscal.measurement.readers.csv_readings import Around, read_poses
from axiscal.measurement.readers.files import recognised
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import read_truth
from axiscal.record.events import Created, Event, Recorded
from axiscal.record.lines import EventText
from axiscal.record.payload import encode
from axiscal.record.store import content_of
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.loaded import read_old
from axiscal.tables.registry import loaded
from benchmarks.reliability.trial import Trial, scratch
from tests.measurement.test_readers import TRUTH
from tests.refusals.reading import refusals

SECONDS, MEGABYTES = 1.0, 200.0
POSES = "X_mm,Y_mm,approach\n10,20,X+ Y-\n30,40,\n"
EXPLOSION = 5_000_000


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of file.  name : as a file; good : a right one; read : what reads it; titled : what is in it"""

    name: str
    good: bytes
    read: Callable[[Path], object]
    titled: str = ""

    def __str__(self) -> str:
        return self.titled or self.name


def _texts(kind: str) -> Mapping[str, str]:
    """Return right texts of a kind by their titles, without the descriptions beside them."""
    texts = refusals(kind).texts.items()
    return {title: text for title, text in texts if text and not title.endswith(".toml")}


MACHINE, CAMPAIGN = (refusals("files").texts[f"{name}.toml"] for name in ("machine", "campaign"))


@cache
def _around() -> Around:
    """Return a campaign that says where the nodes of maps lie."""
    campaign = campaign_from_texts(CAMPAIGN, "campaign.toml", MACHINE, "machine.toml")
    return Around(campaign.machine.axes, campaign.setups)


def _old_table(controller: str, template: str, path: Path) -> object:
    machine = machine_from_text(refusals("old_table").texts["machine.toml"])
    return loaded(controller, machine, ExportOptions(old_files=read_old([str(path)]), template=template))


def _record() -> bytes:
    """Return the file of a record with two readings."""
    created = Created(MACHINE, CAMPAIGN, "machine.toml", "campaign.toml", {"axiscal": "0.1.0"})
    readings = [Recorded(Reading("probe", (0.1 * n, 0.1, 0.0), (1, 0, 0), 1e-6 * n)) for n in (1, 2)]
    happened: list[Event] = [created, *readings]
    return content_of([EventText("2026-01-01T00:00:00.000+00:00", *encode(event)) for event in happened])


def _kinds() -> Iterator[Kind]:
    yield Kind("mill.toml", refusals("machine").texts["mill"].encode(), load_machine)
    yield Kind("campaign.toml", CAMPAIGN.encode(), partial(read_campaign, target_needed=False, asking=False))
    yield Kind("truth.csv", TRUTH.encode(), read_truth)
    yield Kind("poses.csv", POSES.encode(), read_poses)
    yield Kind("mill.axiscal", _record(), lambda path: Campaign.open(path, write=False).close())
    yield Kind("machine.ini", _texts("ini")["small"].encode(), lambda path: machine_of(read_ini(path)))
    iso = _texts("positioning")["test"].encode()
    yield Kind("iso.csv", iso, lambda path: evaluate(positioning_test(recognised(path))))
    for title, text in _texts("files").items():
        yield Kind("file.txt", text.encode(), lambda path: recognised(path, _around()), title)
    for title, text in _texts("old_table").items():
        controller, name = title.split()
        yield Kind(f"{controller}/{name}", text.encode(), partial(_old_table, controller, text))


KINDS = tuple(_kinds())


def place(kind: Kind, folder: Path) -> Path:
    """Return where a file of a kind is written, with a good machine.toml in the folder."""
    (folder / "machine.toml").write_text(MACHINE, encoding="utf-8")
    path = folder / kind.name
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


def read_all() -> Trial:
    """Read every kind of file spoilt in every way."""
    with scratch() as top:
        outcomes = [_read(kind, spoil(kind.good), top, way) for kind in KINDS for way, spoil in WAYS.items()]
    wrong = [outcome for outcome in outcomes if outcome not in ("refused", "read")]
    detail = f"{outcomes.count('refused')} refused, {outcomes.count('read')} still good; {'; '.join(wrong[:5])}"
    return Trial("bad files read", len(outcomes), len(wrong), detail.rstrip("; "))


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
    return said if said in ("read", "refused") else f"{kind}, {way}: {said}"


def _status(kind: Kind, path: Path) -> int:
    try:
        kind.read(path)
    except AxiscalError:
        return 1
    except BaseException:  # noqa: BLE001 - a defect, whatever it is
        return 2
    return 0
