"""Check a campaign record (*.axiscal) and the results made of it, without axiscal.

    python tools/check_record.py RECORD --key PUBLIC [--key PUBLIC] [--head CHAIN] [--manifest DIR/manifest.json]

It reads bytes, hashes, the chain over all events, how many there are at least, and every signature. PUBLIC is a public
key in hex, or a file with a key and a name in each line; CHAIN is the end that somebody has seen: it shows whether the
record was set back since. Needs Python 3.11 and the package cryptography.
Exit status: 0 if all of it is signed by these keys and as it was written, else 1, and each fault in a line.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import re
import sys
import zlib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

from cryptography.exceptions import InvalidSignature
from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PublicKey

BLOCK = 4096
HEADS = {
    "7b5accdb80a4adc94a0a792ee6083d19e65549ece675b4221b0f7d9665466b0d": 3 * BLOCK,
    "b20106745e56ca5cf5a47cfa3970f37a6ac2fe6cbf4853adb497f1fdea4b3ecf": 3 * BLOCK,
    "61e6d6ae8f73d591804c309dbeff503931e53eac7b64f94f0a884ccf71b26765": BLOCK,
}
"""Where the lines of form 2, 3 and 4 begin, by SHA-256 of the first block, of form 4 without its counts."""
COUNT = re.compile(rb"(axiscal record 4 of at least (\d{12}) events) ([0-9a-f]{8}) {6}(?=\n)")
MARK = re.compile(rb"(mark \d+ (\d+) \d+ [0-9a-f]{64} )([0-9a-f]{8})")
OLD = re.compile(rb"([0-9a-f]{64}) (\S+) (\S+) (.*) [.,]([0-9a-f]{8})")
LINE = re.compile(
    rb'([0-9a-f]{64}) \{"a":"([0-9a-f]{64})","b":"([0-9a-f]{32})","e":\[\d+,\d+\],"n":(\d+),"t":"([^"]*)",'
    rb'"w":"[0-9a-f]*","k":"([^"]*)","p":(.*)\}'
)
BY = ("person", "computer", "key")
MOST = 20
"""Faults that are printed."""


class Entry(NamedTuple):
    """An event: the chain of contents behind it, time of writing, kind, what happened."""

    chain: str
    at: str
    kind: str
    what: Mapping[str, Any]


@dataclass
class Found:
    """What was found: sentences, and faults among them; entries : the events that can be read."""

    said: list[str] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)
    entries: list[Entry] = field(default_factory=list)


def checked(content: bytes, keys: Sequence[str], seen: Sequence[str] = ()) -> Found:
    """Return what is found in the bytes of a record.  keys : public ones, hex;  seen : chains that it must hold"""
    found = Found()
    counts = [count for at in (0, 512) if (count := COUNT.match(content, at))]
    heads = (hashlib.sha256(content[begin:BLOCK]).hexdigest() for begin in (0, 1024))
    start = max(HEADS.get(each, 0) for each in heads)
    if not start:
        found.faults.append("its head is not that of a record of form 2, 3 or 4")
    old = start != BLOCK and not counts
    found.faults += _read(content[start or BLOCK :], found.entries, old)
    counts = counts or [mark for at in (BLOCK, 2 * BLOCK) if (mark := MARK.match(content, at))]
    least = [int(count[2]) for count in counts if b"%08x" % zlib.crc32(count[1]) == count[3]]
    if not least or max(least) > len(found.entries):
        found.faults.append(
            f"its counts do not say that it ends at event {len(found.entries)}: it was cut off or changed"
        )
    if not found.entries:
        return found
    found.faults += _of_signatures(found, keys)
    for head in seen:
        if head not in {entry.chain for entry in found.entries}:
            found.faults.append(f"it does not hold {head[:16]}: it was set back, or changed, since that was seen")
    hands = Counter((entry.what.get("person"), entry.what.get("computer")) for entry in found.entries)
    found.said += [f"{count} events by {person} on {computer}" for (person, computer), count in hands.items()]
    found.said.append(f"it ends at event {len(found.entries)}: {found.entries[-1].chain}")
    return found


def _written(line: bytes, number: int, before: str) -> tuple[str, str, str, str] | None:
    """Return "" where a line follows the hash `before`, its time, kind and text; None where its hash is not its own."""
    found = LINE.fullmatch(line)
    if found is None or hashlib.sha256(line[65:]).hexdigest().encode() != found[1]:
        return None
    _, behind, _, counted, at, kind, text = (part.decode() for part in found.groups())
    return "" if (behind, int(counted)) == (before, number) else "another", at, kind, text


def _read(content: bytes, entries: list[Entry], old: bool) -> Iterator[str]:
    """Add the events of lines to a list; yield faults of hashes, sums and chain."""
    chain, before = 64 * "0", 64 * "0"
    for line in content.split(b"\n")[:-1]:
        number, parts = len(entries) + 1, OLD.fullmatch(line)
        if old and (parts is None or zlib.crc32(line[:-8]) != int(parts[5], 16)):
            yield f"the line of event {number} is not as it was written: its sum is another"
        try:
            found = tuple(part.decode() for part in parts.groups()[:4]) if parts else _written(line, number, before)
            if found is None and not old:
                continue  # nobody has finished writing it
            named, at, kind, text = found or ("", "", "", "")
            what = json.loads(text)
            if not isinstance(what, dict):
                raise ValueError("no object")
        except (ValueError, RecursionError):
            yield f"event {number} cannot be read; what follows is not looked at"
            return
        chain, before = hashlib.sha256(f"{chain} {kind} {text}".encode()).hexdigest(), line[:64].decode()
        if named not in ("", chain):
            yield f"event {number} does not follow from the events before it: its chain is another"
            chain = named if old else chain
        entries.append(Entry(chain, at, kind, what))


def _of_signatures(found: Found, keys: Sequence[str]) -> Iterator[str]:
    """Yield faults of signatures, and what none is of."""
    lines, good = hashlib.sha256(), 0
    for number, entry in enumerate(found.entries, 1):
        if entry.kind == "signed":
            signed = {"at": entry.at, "before": lines.hexdigest()}
            fault = _fault(signed, entry.what, keys)
            if fault:
                yield f"the signature at event {number} {fault}; it stands for events {good + 1} to {number - 1}"
            else:
                found.said.append(f"events {good + 1} to {number - 1} signed by {entry.what['person']}, {entry.at}")
                good = number
        lines.update(f"{entry.at} {entry.chain}\n".encode())
    if good < len(found.entries):
        yield f"events {good + 1} to {len(found.entries)} are not signed by a key that was given"


def _fault(document: Mapping[str, Any], by: Mapping[str, Any], keys: Sequence[str]) -> str:
    """Return what is wrong with a signature, "" if nothing is."""
    text = json.dumps(
        {**document, **{name: by.get(name) for name in BY}}, ensure_ascii=False, separators=(",", ":"), sort_keys=True
    )
    if by.get("key") not in keys:
        return "is of a key that was not given"
    try:
        public = Ed25519PublicKey.from_public_bytes(bytes.fromhex(by["key"]))
        public.verify(bytes.fromhex(by["signature"]), f"axiscal-signature/1\n{text}".encode())
    except (InvalidSignature, KeyError, TypeError, ValueError):
        return "is not of what it stands for: that was changed, or swapped, or some of it is missing"
    return ""


def checked_manifest(path: Path, entries: Sequence[Entry]) -> Found:
    """Return what is found of a set of results: its files, the event it was made of."""
    found = Found()
    document = json.loads(path.read_bytes())
    for name, digest in document["files"].items():
        file = path.parent / name
        if not file.is_file() or hashlib.sha256(file.read_bytes()).hexdigest() != digest:
            found.faults.append(f"{name} is missing, or not what {path.name} names")
    event, chain = document["record"]["event"], document["record"]["hash"]
    if not 0 < event <= len(entries) or entries[event - 1].chain != chain:
        found.faults.append(f"the results are not of this record: it has no event {event} with {chain[:16]}")
    found.said.append(f"{len(document['files'])} files of event {event}")
    if "signed" in document:
        found.said.append(
            f"{path.name} has a signature of its own, a kind that is no longer verified: the record's counts"
        )
    return found


def main(words: Sequence[str]) -> int:
    """Print what is found; return 1 where something is wrong."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("record", type=Path)
    for name in ("--key", "--head"):
        parser.add_argument(name, action="append", default=[])
    parser.add_argument("--manifest", type=Path)
    args = parser.parse_args(words)
    given = [Path(key).read_text().splitlines() if Path(key).is_file() else [key] for key in args.key]
    keys = [line.split()[0].lower() for lines in given for line in lines if line.strip()]
    found = checked(args.record.read_bytes(), keys, args.head)
    if args.manifest:
        results = checked_manifest(args.manifest, found.entries)
        found.said, found.faults = found.said + results.said, found.faults + results.faults
    print("\n".join([*found.said, *(f"FAULT: {fault}" for fault in found.faults[:MOST])]))
    print(f"{len(found.faults)} faults" if found.faults else "All of it is signed, and as it was written.")
    return 1 if found.faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
