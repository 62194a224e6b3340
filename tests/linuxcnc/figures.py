"""What the tests of the realtime component hold as limits, with what they measured now, as a table in Markdown.

python -m tests.linuxcnc.figures
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from tests.figures import FILE

TESTS = ("tables/test_vcomp_core.py", "linuxcnc/test_volumetric_on_the_controller.py")


def table(notes: list[dict[str, object]]) -> str:
    """Return a row for each figure: the largest share of its limit over all tests and cases."""
    worst: dict[str, dict[str, object]] = {}
    for note in notes:
        what = str(note["what"])
        if what not in worst or _share(note) > _share(worst[what]):
            worst[what] = note
    rows = [
        f"| {what} | `{_test(note)}` | {note['limit']:.3g} {note['unit']} | {note['value']:.2g} {note['unit']} |"
        for what, note in worst.items()
    ]
    return "\n".join(["| what | test | limit | today |", "|---|---|---|---|", *rows])


def _test(note: dict[str, object]) -> str:
    return str(note["test"]).partition("[")[0].rpartition("::")[2]


def _share(note: dict[str, object]) -> float:
    return float(str(note["value"])) / float(str(note["limit"]))


def main() -> int:
    """Run the tests and print the table; returns their exit status."""
    folder = Path(__file__).resolve().parents[1]
    with tempfile.TemporaryDirectory() as made:
        file = Path(made) / "figures"
        words = [sys.executable, "-m", "pytest", "-q", *(str(folder / name) for name in TESTS)]
        done = subprocess.run(words, env=os.environ | {FILE: str(file)}, stdout=subprocess.PIPE, text=True, check=False)
        notes = [json.loads(line) for line in file.read_text().splitlines()] if file.exists() else []
    sys.stdout.write(f"{table(notes)}\n\n{done.stdout.strip().splitlines()[-1]}\n")
    return done.returncode


if __name__ == "__main__":
    sys.exit(main())
