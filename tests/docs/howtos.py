"""The how-tos of the documentation, followed word for word: their files written, their commands given, their pictures.

python -m tests.docs.howtos         # makes the pictures anew
"""

from __future__ import annotations

import os
import re
import shlex
from pathlib import Path
from tempfile import TemporaryDirectory

from axiscal.campaign.campaign import Campaign
from axiscal.cli.app import run
from axiscal.compensation.export_options import ExportOptions
from axiscal.compensation.registry import export
from axiscal.description.campaign import read_campaign
from axiscal.estimation.estimation import Estimation
from axiscal.measurement.candidates import spread
from axiscal.measurement.place import Place
from axiscal.report.arrow_pictures import volume_panels
from axiscal.report.drawing.paper import alone, paper_svg
from axiscal.report.gallery import groups
from axiscal.report.room_page import View, in_machine
from axiscal.report.summarising import Extras, summarise
from axiscal.report.volume_error import volume_error

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGES = [*sorted((DOCS / "howto").glob("*.md")), DOCS / "tour.md"]
_BLOCK = re.compile(r'^```(\w+)(?: title="([^"]+)")?\n(.*?)^```', re.MULTILINE | re.DOTALL)
_SHOWN = 60


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
    before = Path.cwd()
    os.chdir(folder)
    try:
        return [(words, run(words[1:])) for words in commands(page)]
    finally:
        os.chdir(before)


def draw(page: Path, folder: Path) -> None:
    """Draw where the set-ups of a page can be read: from above, or from the front where no Y moves."""
    for name, text in files(page).items():
        (folder / name).write_text(text, encoding="utf-8")
    campaign = read_campaign(folder / "campaign.toml", target_needed=False, asking=False)
    lattice = spread(campaign.machine, campaign.setups, _SHOWN)
    rows = zip(lattice.setups.tolist(), lattice.poses.tolist(), lattice.approaches.astype(int).tolist(), strict=True)
    places = [Place(campaign.setups[setup].name, tuple(pose), tuple(side)) for setup, pose, side in rows]
    moved = {campaign.machine.axes[axis].letter for setup in campaign.setups for axis in setup.moves}
    view = View(0, 2, "from the front") if moved == {"Z"} else View(0, 1, "from above")
    figure = in_machine(campaign, places, view)
    figure["data"] = [trace for trace in figure["data"] if trace.get("name")]
    _keep(f"{page.stem}.svg", paper_svg(figure, 520))


def draw_tour(folder: Path) -> None:
    """Draw the error of the volume and a curve as the report of the tour has them.  folder : where it was followed"""
    with Campaign.open(folder / "rehearsal" / "campaign.axiscal", write=False) as campaign:
        known = campaign.concluded()
        summary = summarise(campaign, known, Extras())
    _keep_volume("volume.svg", known, "linuxcnc")
    curve = next(curve for curve in summary.curves if curve.name == "EXX")
    figure = groups([curve])[0].rows[0][0].figure
    _keep("curve.svg", paper_svg(figure, 700))


def draw_demo(folder: Path) -> None:
    """Draw the error of the volume as the report of the demo has it.  folder : where its results go"""
    run(["demo", "--out", str(folder)])
    with Campaign.open(folder / "campaign.axiscal", write=False) as campaign:
        _keep_volume("demo.svg", campaign.concluded(), "linuxcnc-volumetric")


def _keep_volume(name: str, known: Estimation, controller: str) -> None:
    """Write the panels of the volume beside each other: as found, as left by tables, how well known."""
    tables = export(known.estimate(), controller, ExportOptions())
    panels = volume_panels(volume_error(known, controller, tables.control))
    beside = "".join(
        f'<g transform="translate({300 * k} 0)">{panel.svg}<text x="10" y="14" font-size="13">{panel.name}</text></g>'
        for k, panel in enumerate(panels)
    )
    whole = alone(f'<svg viewBox="0 0 900 320" width="900" height="320">{beside}</svg>')
    _keep(name, whole)


def _keep(name: str, svg: str) -> None:
    """Write a picture with a ground of its own: pages are light or dark."""
    text = svg.replace("<svg ", '<svg style="background:#fff" ', 1)
    (DOCS / "pictures" / name).write_text(text + "\n", encoding="utf-8")


def main() -> None:
    """Make the pictures of all pages anew."""
    for page in PAGES:
        with TemporaryDirectory() as folder:
            if page.stem == "tour":
                follow(page, Path(folder))
                draw_tour(Path(folder))
            else:
                draw(page, Path(folder))
    with TemporaryDirectory() as folder:
        draw_demo(Path(folder))


if __name__ == "__main__":
    main()
