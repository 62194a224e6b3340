"""How long a person waits for the program to start: the fastest of ten starts, as a shell would see it."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

PROGRAM = Path(sys.executable).parent / "axiscal"


def seconds(*arguments: str) -> float:
    """Return the wall time of one run of the program."""
    start = time.perf_counter()
    subprocess.run([str(PROGRAM), *arguments], check=True, capture_output=True)
    return time.perf_counter() - start


if __name__ == "__main__":
    for arguments in (["--version"], ["--help"]):
        print(f"axiscal {' '.join(arguments)}: {min(seconds(*arguments) for _ in range(10)):.3f} s")
