"""Machines of every kind of chain, and every campaign of the documents, as they are drawn."""

from pathlib import Path

from axiscal.description.campaign import CampaignDescription, read_campaign
from axiscal.machine import builtin_names, load_machine, machine_from_text
from axiscal.measurement.candidates import spread
from axiscal.measurement.reading import Place
from axiscal_core.machine import Machine
from tests.docs.howtos import DOCS, written

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
