"""`python -m tests.golden`: play the campaigns and compare with what they gave before, or keep it; see README.md."""

import argparse
import shutil
import sys
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.golden.comparing import Difference, differences
from tests.golden.given import names
from tests.golden.running import Texts, all_played

EXPECTED = Path(__file__).parent / "expected"
SHOWN = 5
"""Differences shown of one file."""


def main() -> int:
    """Return the exit status: 0 equal or kept, 1 different."""
    parser = argparse.ArgumentParser(prog="python -m tests.golden", description=__doc__)
    parser.add_argument("--renew", action="store_true", help="keep what the campaigns give now")
    parser.add_argument("--only", action="append", choices=names(), help="this campaign; repeatable")
    parser.add_argument("--out", type=Path, metavar="DIR", help="keep the folders in which they were played")
    chosen = parser.parse_args()
    begun = time.monotonic()
    with TemporaryDirectory() as folder:
        found, broken = all_played(chosen.only or names(), chosen.out or Path(folder))
    differing = compared(found, EXPECTED)
    _print("".join(f"{line}\n" for line in (*_listed(differing), *broken)), end="")
    if chosen.renew:
        for name, texts in found.items():
            _keep(texts, EXPECTED / name)
    _print(_summary(found, differing, time.monotonic() - begun, renewed=chosen.renew))
    return 1 if broken or (differing and not chosen.renew) else 0


def compared(found: Mapping[str, Texts], expected: Path) -> list[tuple[str, Difference]]:
    """Return where texts differ from those that are kept, with the campaign of each."""
    differing = []
    with TemporaryDirectory() as folder:
        for name, texts in found.items():
            _keep(texts, Path(folder, name))
            differing += [(name, each) for each in differences(expected / name, Path(folder, name))]
    return differing


def _keep(texts: Texts, folder: Path) -> None:
    """Write the texts of a campaign in the place of those that were there."""
    shutil.rmtree(folder, ignore_errors=True)
    for name, text in texts.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8", newline="")


def _listed(differing: Sequence[tuple[str, Difference]]) -> Iterator[str]:
    """Yield a line for each difference, the first ones of each file."""
    for (name, file), count in Counter((name, each.file) for name, each in differing).items():
        yield from [f"{name}/{each}" for campaign, each in differing if (campaign, each.file) == (name, file)][:SHOWN]
        if count > SHOWN:
            yield f"{name}/{file}: and {count - SHOWN} more"


def _summary(
    found: Mapping[str, Texts], differing: Sequence[tuple[str, Difference]], seconds: float, *, renewed: bool
) -> str:
    files = len({(name, each.file) for name, each in differing})
    size = sum(len(text.encode()) for texts in found.values() for text in texts.values())
    what = "renewed" if renewed else "compared"
    return (
        f"{len(found)} campaigns {what}, {sum(map(len, found.values()))} files of {size / 1e6:.2f} MB, "
        f"{len(differing) or 'no'} differences in {files} files, {seconds:.0f} s"
    )


def _print(text: str, end: str = "\n") -> None:
    sys.stdout.write(f"{text}{end}")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main())
