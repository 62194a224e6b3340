"""`make audit`: what axiscal consists of, as a CycloneDX document, and whether it is what was pinned; no network.

Each package of the locked requirements is looked for where this runs: its version must be the pinned one, and every
pin must have hashes. Known weaknesses of packages are in databases on the network, which this does not ask.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
_PIN = re.compile(r"^([A-Za-z0-9._-]+)==([^\s\\;]+)", re.MULTILINE)
_HASH = re.compile(r"--hash=sha256:([0-9a-f]{64})")


@dataclass(frozen=True, slots=True)
class Pin:
    """A package, its version, and the SHA-256 of the files that it may come from."""

    name: str
    version: str
    hashes: tuple[str, ...]


def pins(text: str) -> list[Pin]:
    """Return what a file of locked requirements pins."""
    found = list(_PIN.finditer(text))
    ends = [*(each.start() for each in found[1:]), len(text)]
    return [
        Pin(each[1], each[2], tuple(_HASH.findall(text, each.end(), end)))
        for each, end in zip(found, ends, strict=True)
    ]


def faults(pinned: Sequence[Pin]) -> list[str]:
    """Return what is not as it was pinned."""
    found = []
    for pin in pinned:
        if not pin.hashes:
            found.append(f"{pin.name} {pin.version} is pinned without a hash")
        installed = _installed(pin.name)
        if installed not in (None, pin.version):
            found.append(f"{pin.name} {pin.version} is pinned and {installed} is installed")
    return found


def bill(pinned: Sequence[Pin], version: str) -> dict[str, object]:
    """Return the software bill of materials, CycloneDX 1.5."""
    components = [
        {
            "type": "library",
            "name": pin.name,
            "version": pin.version,
            "purl": f"pkg:pypi/{pin.name}@{pin.version}",
            "licenses": [{"license": {"name": _license(pin.name)}}],
            "hashes": [{"alg": "SHA-256", "content": each} for each in pin.hashes],
        }
        for pin in pinned
    ]
    itself = {"type": "application", "name": "axiscal", "version": version}
    document = {"bomFormat": "CycloneDX", "specVersion": "1.5", "version": 1}
    return {**document, "metadata": {"component": itself}, "components": components}


def _installed(name: str) -> str | None:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return None


def _license(name: str) -> str:
    try:
        about = metadata.metadata(name)
    except metadata.PackageNotFoundError:
        return "not installed here"
    trove = [each.rpartition(" :: ")[2] for each in about.get_all("Classifier") or [] if each.startswith("License")]
    stated = [each for key in ("License-Expression", "License") for each in about.get_all(key) or []]
    return (stated[0] if stated else ", ".join(trove) or "not stated").splitlines()[0][:80]


def main(words: Sequence[str]) -> int:
    """Write the bill and print what is wrong; return 1 if anything is."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--lock", type=Path, default=ROOT / "requirements" / "run.txt")
    parser.add_argument("--out", type=Path, default=Path("build") / "sbom.json")
    chosen = parser.parse_args(words)
    pinned = pins(chosen.lock.read_text(encoding="utf-8"))
    chosen.out.parent.mkdir(parents=True, exist_ok=True)
    document = bill(pinned, _installed("axiscal") or "not installed")
    chosen.out.write_text(json.dumps(document, indent=2) + "\n", encoding="utf-8")
    wrong = faults(pinned)
    lines = [f"{len(pinned)} packages, written to {chosen.out}", *wrong]
    sys.stdout.write("\n".join(lines) + f"\n{len(wrong)} not as pinned\n")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
