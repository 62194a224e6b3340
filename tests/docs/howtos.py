"""The how-tos of the documentation, followed word for word: their files written, their commands given, their pictures.

python -m tests.docs.howtos         # makes the pictures anew
"""

import re
import shlex
import subprocess
import sys
from contextlib import chdir
from pathlib import Path
from tempfile import TemporaryDirectory

from axiscal.campaign.campaign import Campaign
from axiscal.cli.app import run
from axiscal.description.campaign import read_campaign
from axiscal.measurement.candidates import spread
from axiscal.measurement.reading import Place
from axiscal.present.found_and_left import found_and_left_drawing
from axiscal.present.schematic import plan_picture
from axiscal.present.volume_error import volume_error
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.registry import export

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGES = sorted(set((DOCS / "howto").glob("*.md")) - {DOCS / "howto" / "a-port-of-your-own.md"})
_BLOCK = re.compile(r'^```(\w+)(?: title="([^"]+)")?\n(.*?)^```', re.MULTILINE | re.DOTALL)
_SHOWN = 12


def files(page: Path) -> dict[str, str]:
    """Return the files that a page asks for, by name."""
    return {name: text for _, name, text in _BLOCK.findall(page.read_text(encoding="utf-8")) if name}


def commands(page: Path) -> list[list[str]]:
    """Return the commands that a page gives to be followed, in order."""
    blocks = [text for kind, _, text in _BLOCK.findall(page.read_text(encoding="utf-8")) if kind == "sh"]
    return [shlex.split(line, comments=True) for text in blocks for line in text.splitlines() if line.strip()]


def follow(page: Path, folder: Path) -> list[tuple[list[str], int]]:
    """Write the files of a page into a folder, give its commands there, and return each with its exit status."""
    for name, text in files(page).items():
        (folder / name).write_text(text, encoding="utf-8")
    with chdir(folder):
        return [(words, _given(words)) for words in commands(page)]


def _given(words: list[str]) -> int:
    """Give a command of axiscal, or run an example, and return its exit status."""
    if words[0] != "python":
        return run(words[1:])
    return subprocess.run([sys.executable, DOCS.parent / words[1], *words[2:]], check=False).returncode


def written(page: Path, folder: Path) -> Path:
    """Write the files of a page into a folder, those that its `init` makes as well, and return its campaign."""
    own = files(page)
    for name, text in own.items():
        (folder / name).write_text(text, encoding="utf-8")
    if "campaign.toml" not in own:
        init = next(words for words in commands(page) if words[1] == "init")
        with chdir(folder):
            assert run(init[1:]) == 0
    (described,) = folder.rglob("campaign.toml")
    return described


def draw(page: Path, folder: Path) -> None:
    """Draw the first set-up of a page on its machine, with places where it can be read."""
    campaign = read_campaign(written(page, folder), target_needed=False, asking=False)
    setup = campaign.setups[0]
    lattice = spread(campaign.machine, (setup,), _SHOWN)
    rows = zip(lattice.poses.tolist(), lattice.approaches.astype(int).tolist(), strict=True)
    places = [Place(setup.name, tuple(pose), tuple(side)) for pose, side in rows]
    _keep(f"{page.stem}.svg", plan_picture(campaign.machine.name, campaign, places))


def draw_demo(folder: Path) -> None:
    """Draw the error of the volume as the report of the demo has it.  folder : where its results go"""
    run(["demo", "--out", str(folder)])
    controller = "linuxcnc-volumetric"
    with Campaign.open(folder / "campaign.axiscal", write=False) as campaign:
        known = campaign.estimate(ended=True)
        volume = volume_error(known, controller, export(known.estimate(), controller, ExportOptions()).control)
        drawing = found_and_left_drawing(volume, campaign.description.machine, 1110.0)
        _keep("demo.svg", drawing.on_screen("The error of the volume, found and left"))


def _keep(name: str, svg: str) -> None:
    """Write a picture."""
    (DOCS / "pictures" / name).write_text(svg.rstrip() + "\n", encoding="utf-8")


def main() -> None:
    """Make the pictures of all pages anew."""
    for page in PAGES:
        with TemporaryDirectory() as folder:
            draw(page, Path(folder))
    with TemporaryDirectory() as folder:
        draw_demo(Path(folder))


if __name__ == "__main__":
    main()
