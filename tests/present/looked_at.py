"""Pictures that a person has looked at, each as figures by kind of element: `python -m tests.present.looked_at`.

It writes `looked_at.json` anew. Look at the pictures that differ before it is kept.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from axiscal.description.campaign import CampaignDescription, read_campaign
from axiscal.machine import builtin_names, load_machine, machine_from_text
from axiscal.measurement.candidates import spread
from axiscal.measurement.reading import Place
from axiscal.present.found_and_left import found_and_left_drawing
from axiscal.present.schematic import machine_schematic, plan_picture
from axiscal_core.machine import Machine
from tests.docs.howtos import DOCS, written
from tests.present.test_found_and_left import _volume

FILE = Path(__file__).with_suffix(".json")
_ELEMENT = re.compile(r"<(path|circle|rect|text|polyline|polygon)\b([^>]*)>")
_PLACE = re.compile(r'\b(?:d|points|x|y|cx|cy|r|width|height)="([^"]*)"')
Figures = Mapping[str, list[float]]
Placed = tuple[str, CampaignDescription, list[Place]]
ROOT = DOCS.parent
BENCHES = sorted((ROOT / "src" / "axiscal" / "present" / "demo").rglob("*.machine.toml"))
CHAINS = [
    "w-b-X-Y-Z-C-A-t",
    "w-b-Y-X-Z-B-t",
    "w-X'-Y'-b-Z-B-t",
    "w-X'-Y'-Z'-b-t",
    "w-Y'-b-Z-X-t",
    "w-C'-b-Z-X-t",
    "w-b-X-Z-t",
    "w-Z'-B'-X'-b-Y-t",
    "w-A'-X'-Y'-b-Z-t",
    "w-b-Z-Y-X-t",
    "w-b-X-Y-t",
    "w-C'-b-X-Z-t",
    "w-b-C-t",
]


def _of_chain(chain: str) -> Machine:
    """Return a machine of a chain, its rotary axes aside from where the others are at nought."""
    axes = [link.rstrip("'") for link in chain.split("-")[1:-1] if link != "b"]
    travels = [f'[axes.{a}]\ntravel = ["-20 deg", "100 deg"]\norigin = ["10 mm", "-20 mm", "-90 mm"]' if a in "ABC"
               else f'[axes.{a}]\ntravel = ["-100 mm", "500 mm"]' for a in axes]  # fmt: skip
    tool = '[tool]\nlength = "110 mm"\n'
    return machine_from_text(f'name = "{chain}"\nchain = "{chain}"\n{tool}' + "\n".join(travels) + _error(axes[0]))


def _error(axis: str) -> str:
    """Return one error of an axis: a machine without any is refused."""
    along, std = (axis, "10 urad") if axis in "ABC" else (axis, "10 um")
    return f'\n[errors]\nE{along}{axis} = {{ std = "{std}" }}\n'


MACHINES: list[Machine] = [
    *(load_machine(name) for name in builtin_names()),
    *(load_machine(path) for path in BENCHES),
    *(_of_chain(chain) for chain in CHAINS),
]


def _campaigns(folder: Path) -> list[tuple[str, CampaignDescription]]:
    found = []
    for page in sorted(set((DOCS / "howto").glob("*.md")) - {DOCS / "howto" / "a-port-of-your-own.md"}):
        own = folder / page.stem
        own.mkdir()
        found.append((page.stem, read_campaign(written(page, own), target_needed=False, asking=False)))
    paths = [*ROOT.glob("examples/*.campaign.toml"), *(ROOT / "src").rglob("*.campaign.toml")]
    found += [(path.stem, read_campaign(path, target_needed=False, asking=False)) for path in sorted(paths)]
    return found


def _places(campaign: CampaignDescription, each: int = 10) -> list[Place]:
    lattice = spread(campaign.machine, campaign.setups, each * len(campaign.setups))
    rows = zip(lattice.setups.tolist(), lattice.poses.tolist(), lattice.approaches.astype(int).tolist(), strict=True)
    return [Place(campaign.setups[setup].name, tuple(pose), tuple(side)) for setup, pose, side in rows]


def placed_campaigns(folder: Path) -> list[Placed]:
    """Return every campaign of the how-tos, the examples and the demos, with places of readings."""
    return [(name, of, _places(of)) for name, of in _campaigns(folder)]


def figures(picture: str) -> Figures:
    """Return count, sum of all coordinates and of their squares over 100, pixels, by kind and colour of element."""
    found: dict[str, list[float]] = {}
    for kind, words in _ELEMENT.findall(picture):
        colour = re.search(r'(?:fill|stroke|class)="(?!none)([^"]*)"', words)
        places = [float(each) for text in _PLACE.findall(words) for each in re.findall(r"-?\d*\.?\d+", text)]
        own = found.setdefault(f"{kind} {colour[1] if colour else ''}", [0, 0.0, 0.0])
        own[:] = own[0] + 1, own[1] + sum(places), own[2] + float(np.square(places).sum()) / 100
    return {kind: [round(each, 1) for each in own] for kind, own in found.items()}


def pictures(campaigns: list[Placed]) -> dict[str, Figures]:
    """Return all of them: machines alone, plans of campaigns, and bent volumes."""
    found = {f"{n} {each.chain}": machine_schematic(each).svg(400.0, 300.0) for n, each in enumerate(MACHINES)}
    found |= {name: plan_picture(of.machine.name, of, places) for name, of, places in campaigns}
    machines = {name: load_machine(name) for name in builtin_names()}
    found |= {f"bent {n}": found_and_left_drawing(_volume(each), each, 1110.0).body for n, each in machines.items()}
    return {name: figures(picture) for name, picture in found.items()}


if __name__ == "__main__":
    with TemporaryDirectory() as made:
        shown = pictures(placed_campaigns(Path(made)))
    lines = (f"{json.dumps(name)}: {json.dumps(each)}" for name, each in shown.items())
    FILE.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")
