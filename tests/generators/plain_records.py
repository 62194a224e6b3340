"""Records as a reader of their first page would write them: hashes, chains and sums by hashlib and zlib alone."""

import gzip
import hashlib
import json
import random
import zlib
from collections.abc import Sequence
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import NamedTuple

from tests.generators.texts import campaign_text, machine_text, setup_text

HEAD, OLD_START, NONE = 4096, 3 * 4096, 64 * "0"
_EARLIER = Path(__file__).parents[1] / "record" / "earlier" / "halved-lengths.axiscal.gz"
MACHINE = machine_text("w-X'-b-t", {"X": (0, 300)}, {"EXX": "20 um"})
CAMPAIGN = campaign_text(
    "machine.toml",
    setup_text("along x", "interferometer", direction="x", moves=["X"]),
    target={"readings": 500},
    compensation_active=False,
)


class PlainLine(NamedTuple):
    """What one line says: when, kind, what happened."""

    at: str
    kind: str
    said: str


def lines_in(content: bytes) -> list[PlainLine]:
    """Return what the lines of a whole record say."""
    said = (json.loads(line[65:]) for line in content[HEAD:].split(b"\n")[:-1])
    return [PlainLine(each["t"], each["k"], dumped(each["p"])) for each in said]


def dumped(said: object) -> str:
    """Return JSON as a record has it."""
    return json.dumps(said, ensure_ascii=False, separators=(",", ":"), sort_keys=True)


def written_lines(
    lines: Sequence[PlainLine], campaign: str, behind: Sequence[bytes] = (), writer: str = "ab"
) -> list[bytes]:
    """Return lines as a record has them, each an entry, behind others."""
    found = list(behind)
    for number, (at, kind, said) in enumerate(lines, len(behind) + 1):
        before = found[-1][:64].decode() if found else NONE
        text = (
            f'{{"a":"{before}","b":"{campaign}","e":[{number},{number}],"n":{number},"t":"{at}","w":"{writer}","k":"{kind}",'
            f'"p":{said}}}'
        ).encode()
        found.append(hashlib.sha256(text).hexdigest().encode() + b" " + text + b"\n")
    return found[len(behind) :]


def front(first_page: bytes, least: int) -> bytes:
    """Return the head of a record with at least so many events.  first_page : of any"""
    text = b"axiscal record 4 of at least %012d events" % least
    count = (text + b" %08x" % zlib.crc32(text)).ljust(63) + b"\n"
    return 2 * count.ljust(512) + first_page[1024:HEAD]


def summed(text: str) -> bytes:
    """Return a text with its sum behind it."""
    return text.encode() + b"%08x" % zlib.crc32(text.encode())


def old_record(lines: Sequence[PlainLine]) -> bytes:
    """Return a record of form 3 that says this, each line an entry."""
    chain, found = NONE, list[bytes]()
    for at, kind, said in lines:
        chain = hashlib.sha256(f"{chain} {kind} {said}".encode()).hexdigest()
        found.append(summed(f"{chain} {at} {kind} {said} .") + b"\n")
    end = OLD_START + sum(map(len, found))
    mark = summed(f"mark {len(found)} {len(found)} {end} {chain} ")
    first = gzip.decompress(_EARLIER.read_bytes())[:HEAD]
    return first + (mark.ljust(159) + b"\n").ljust(4095) + b"\n" + b"\n".rjust(4096) + b"".join(found)


def write_record(path: Path, first_page: bytes, lines: Sequence[PlainLine]) -> None:
    """Write a record that says this."""
    path.write_bytes(front(first_page, len(lines)) + b"".join(written_lines(lines, 32 * "c")))


def values_in(lines: Sequence[PlainLine]) -> list[float]:
    """Return the values of all readings that were recorded."""
    return [json.loads(line.said)["value"] for line in lines if line.kind == "recorded"]


def story(seed: int, later: float = 0.0, clock: bool = True, count: int = 30) -> list[PlainLine]:
    """Return what a campaign of a small machine says, from one unchanged description.

    later : s after a time that is the same for all; clock : readings say when they were taken; count : of readings
    """
    chance, begun = random.Random(seed), datetime(2026, 3, 2, 7, tzinfo=UTC) + timedelta(seconds=later)
    now, found = begun, list[PlainLine]()

    def say(kind: str, **said: object) -> None:
        by = {"computer": "bench", "person": "anna"}
        text = json.dumps(said | by, separators=(",", ":"), sort_keys=True)
        found.append(PlainLine(now.isoformat(timespec="milliseconds"), kind, text))

    texts = {"campaign_text": CAMPAIGN, "machine_text": MACHINE, "prior_text": ""}
    sources = {"campaign_source": "campaign.toml", "machine_source": "machine.toml", "versions": {"axiscal": "1"}}
    say("created", **texts, **sources, usual_doubts=True, fine_knots=True)
    for number in range(1, count + 1):
        place = {"setup": "along x", "position": [0.005 * number], "approach": [1], "check": False, "reading": number}
        now += timedelta(milliseconds=chance.randrange(500, 8000))
        say("asked", **place)
        now += timedelta(milliseconds=chance.randrange(500, 8000))
        value: dict[str, object] = {"value": chance.gauss(0, 1e-5), "std": None, "others": [], "accepted": False}
        say("recorded", **place, **value, time=(now - begun).total_seconds() if clock else None)
    return found
