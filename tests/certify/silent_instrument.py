"""An instrument behind `exec:` that reads nothing wherever it is asked to; where it was goes to a file, argument 1."""

from __future__ import annotations

import json
import sys
from pathlib import Path

THREE = ("sphere", "rtest", "tracker")
"""Instruments whose readings have three values."""


def main() -> None:
    """Answer until nothing is asked any more."""
    with Path(sys.argv[1]).open("w", encoding="utf-8") as asked:
        for line in sys.stdin:
            asked.write(line)
            asked.flush()
            request = json.loads(line)
            unit = "urad" if request["instrument"] in ("level", "autocollimator") else "um"
            sys.stdout.write(json.dumps({"value": [0.0] * 3 if request["instrument"] in THREE else 0.0, "unit": unit}))
            sys.stdout.write("\n")
            sys.stdout.flush()


if __name__ == "__main__":
    main()
