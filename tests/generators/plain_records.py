"""Records as a reader of their first page would write them: chains, sums and marks by hashlib and zlib alone."""

from __future__ import annotations

import hashlib
import json
import random
import zlib
from collections.abc import Sequence
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import NamedTuple

from tests.generators.texts import campaign_text, machine_text, setup_text

START = 3 * 4096
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
    parts = (line.decode().split(" ", 3) for line in content[START:].split(b"\n")[:-1])
    return [PlainLine(at, kind, rest[: rest.rindex(" ")]) for _, at, kind, rest in parts]


def summed(text: str) -> bytes:
    """Return a text with its sum behind it."""
    return text.encode() + b"%08x" % zlib.crc32(text.encode())


def written_lines(lines: Sequence[PlainLine]) -> list[bytes]:
    """Return lines as a record has them, each chained to the one before."""
    chain, found = 64 * "0", list[bytes]()
    for at, kind, said in lines:
        chain = hashlib.sha256(f"{chain} {kind} {said}".encode()).hexdigest()
        found.append(summed(f"{chain} {at} {kind} {said} .") + b"\n")
    return found


def front(first_page: bytes, lines: Sequence[bytes]) -> bytes:
    """Return the head and the marks of a record that has these lines."""
    end = START + sum(map(len, lines))
    mark = summed(f"mark {len(lines)} {len(lines)} {end} {lines[-1][:64].decode()} ")
    return first_page + (mark.ljust(159) + b"\n").ljust(4095) + b"\n" + b"\n".rjust(4096)


def write_record(path: Path, first_page: bytes, lines: Sequence[PlainLine]) -> None:
    """Write a record that says this."""
    chained = written_lines(lines)
    path.write_bytes(front(first_page, chained) + b"".join(chained))


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
