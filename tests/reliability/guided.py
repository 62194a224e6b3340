"""`make fuzz-coverage`: every reader on files that atheris changes, which keeps those by which other lines run.

Each kind has a process of its own, since libFuzzer never returns; it needs atheris, which `.venv-fuzz` has.
"""

from __future__ import annotations

import argparse
import contextlib
import re
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

_RUNS = re.compile(r"Done (\d+) runs")
_COVERED = re.compile(r"cov: (\d+)")


def guided(name: str, seconds: int, folder: Path) -> None:
    """Change good files of a kind for so long; ends the process, with a failure where a reader raised no error of ours.

    folder : for what is found
    """
    import atheris

    with atheris.instrument_imports(include=["axiscal"]):
        from axiscal.exceptions import AxiscalError
        from tests.reliability.bad_files import KINDS, place
    kind = next(kind for kind in KINDS if kind.name == name)
    (folder / "machine.toml").write_bytes(KINDS[0].good)
    seeds = folder / "seeds"
    seeds.mkdir()
    (seeds / "good").write_bytes(kind.good)
    path = place(kind, folder)

    def read(content: bytes) -> None:
        path.write_bytes(content)
        with contextlib.suppress(AxiscalError):
            kind.read(path)

    words = [f"-max_total_time={seconds}", "-timeout=2", "-max_len=20000", "-seed=1", f"-artifact_prefix={folder}/"]
    atheris.Setup([sys.argv[0], *words, str(seeds)], read)
    atheris.Fuzz()


def main(words: Sequence[str]) -> int:
    """Fuzz every reader and print how often; return 1 if one failed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=int, default=30, help="for each kind of file")
    parser.add_argument("--kind", help="only this kind of files")
    parser.add_argument("--in", dest="folder", type=Path, help=argparse.SUPPRESS)
    args = parser.parse_args(words)
    if args.folder is not None:
        guided(args.kind, args.seconds, args.folder)
    from tests.reliability.bad_files import KINDS

    wrong = [not _apart(kind.name, args.seconds) for kind in KINDS if args.kind in (None, kind.name)]
    return int(any(wrong))


def _apart(name: str, seconds: int) -> bool:
    """Fuzz one kind in a process of its own, say what came of it, and return whether nothing failed."""
    with tempfile.TemporaryDirectory() as folder:
        call = ["-m", "tests.reliability.guided", "--kind", name, "--seconds", str(seconds), "--in", folder]
        run = subprocess.run([sys.executable, *call], capture_output=True, text=True, errors="replace", check=False)
    runs, covered = _RUNS.findall(run.stderr), _COVERED.findall(run.stderr)
    if run.returncode != 0 or not runs:
        sys.stdout.write(f"{name}: FAILS\n{run.stderr[-3000:]}\n")
    else:
        sys.stdout.write(f"{name}: {int(runs[-1]):,} files, no failure, {covered[-1]} edges\n")
    sys.stdout.flush()
    return run.returncode == 0 and bool(runs)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
