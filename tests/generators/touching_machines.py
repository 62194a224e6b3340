"""Random machines with balls near the ends of their travels, and a control that touches these.

The control goes by matrices of the tests' own. It refuses every move that leaves a travel, as LinuxCNC does.
"""

import re
from typing import Any

import numpy as np

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.exceptions import SourceError
from axiscal.numerics import Array
from axiscal_core.machine import Machine
from tests.generators.kinematics import first_met, tip

CHAINS = ("w-C'-A'-b-X-Y-Z-t", "w-C'-b-X-Y-Z-t", "w-C'-b-Y-X-Z-B-t", "w-C'-B'-X'-b-Y-Z-t", "w-b-X-Y-Z-C-A-t")
"""Tables that tilt and turn, a table that turns alone, a head beside it, a table that slides, a head alone."""


def texts(seed: int) -> tuple[str, str]:
    """Return a machine and a campaign: some of its balls can hardly be touched, or not at all."""
    rng = np.random.default_rng(seed)
    chain = CHAINS[seed % len(CHAINS)]
    ends = {letter: np.sort(rng.uniform((-400, 60), (-60, 400))) for letter in "XYZ"}
    lines = ['name = "any"', f'chain = "{chain}"', "[tool]", f'length = "{rng.uniform(40, 120):.1f} mm"']
    lines += [f'stylus = "{rng.choice([1, 3, 6, 8])} mm"']
    for letter, (low, high) in ends.items():
        lines += [f"[axes.{letter}]", f'travel = ["{low:.1f} mm", "{high:.1f} mm"]']
        lines += [f'overrun = "{rng.choice([0.5, 2, 10])} mm"']
    for letter in (each for each in "ABC" if each in chain):
        turn = ("0", "360") if letter == "C" else (f"{rng.uniform(-110, -20):.1f}", f"{rng.uniform(20, 110):.1f}")
        lines += [f"[axes.{letter}]", f'travel = ["{turn[0]} deg", "{turn[1]} deg"]']
        lines += [f"origin = {_written(rng.uniform(-60, 60, 3))}"]
    lines += ["[errors]", 'X0C = { std = "60 um" }', 'Y0C = { std = "60 um" }']
    low, high = 0.8 * np.array(list(ends.values())).T
    first, second = (_written(rng.uniform(low, high)) for _ in range(2))
    campaign = f"""machine = "machine.toml"
[target]
readings = 4
[[artefacts]]
name = "balls"
balls = {{ first = {first}, second = {second} }}
diameter = "{rng.choice([6, 25, 50])} mm"
[[setups]]
name = "touched"
instrument = "sphere"
artefact = "balls"
retract = "{rng.choice([30, 50, 80])} mm"
sides = "{rng.choice(["touched", "mean"])}"
settle = "0 s"
noise = "1 um"
"""
    return "\n".join(lines) + "\n", campaign


def _written(place: Array) -> str:
    return "[" + ", ".join(f'"{at:.1f} mm"' for at in place) + "]"


def described(seed: int) -> CampaignDescription:
    """Return one of them; raises DescriptionError where a ball cannot be touched in any pose."""
    machine, campaign = texts(seed)
    return campaign_from_texts(campaign, "campaign.toml", machine, "machine.toml")


class Control:
    """A LinuxCNC at the other end of the line, and balls on its table.

    balls : (n, 3) m, where they are; radius : m, of ball and stylus
    probe : "sound", "deaf" or "stuck"
    """

    def __init__(self, machine: Machine, balls: Array, radius: float) -> None:
        self._machine, self.balls, self._radius = machine, balls, radius
        self.probe, self.stopped, self.lines = "sound", False, list[str]()
        self._at = np.array([sum(axis.travel) / 2 for axis in machine.axes])
        self._at[[axis.name == "Z" for axis in machine.axes]] = machine.axis("Z").travel[1]

    def status(self) -> dict[str, Any]:
        """Return how it stands."""
        position = self._shown(self._at)
        axes = {axis.name: [self._scaled(axis.rotary, end) for end in axis.travel] for axis in self._machine.axes}
        ready = dict.fromkeys(("enabled", "homed", "idle", "feed_heeded"), True)
        none = dict.fromkeys(("estop", "spindle", "tip"), False) | {"whole": None, "checksum": None}
        plain = {"feed": 1.0, "offsets": [0.0], "rotation": 0.0, "compensated": []}
        seen = {"probe": self.probe == "stuck", "axes": axes}
        return ready | none | plain | seen | {"position": position, "joints": list(position.items())}

    def _scaled(self, rotary: bool, value: float) -> float:
        return float(np.degrees(value) if rotary else 1e3 * value)

    def _shown(self, pose: Array) -> dict[str, float]:
        return {a.name: self._scaled(a.rotary, at) for a, at in zip(self._machine.axes, pose, strict=True)}

    def watched(self, _: float) -> str:
        """Somebody presses the stylus."""
        return ""

    def line(self, code: str) -> dict[str, Any]:
        """Make a move; raises SourceError for one that leaves a travel."""
        self.lines.append(code)
        end = self._at.copy()
        for name, text in re.findall(r" ([A-Z])(-?[\d.]+)(?= |$)", code.partition(" F")[0].removeprefix("G53 G1")):
            at = np.radians(float(text)) if self._machine.axis(name).rotary else 1e-3 * float(text)
            end[self._machine.index(name)] = at
        for axis, value in zip(self._machine.axes, end.tolist(), strict=True):
            if not axis.travel[0] - 1e-9 <= value <= axis.travel[1] + 1e-9:
                raise SourceError(f"LinuxCNC: {axis.name} to {value} exceeds its limit", "Look at the machine")
        tripped = code.startswith("G38.3") and self._touched(end)
        self._at = self._at if tripped else end
        return {"tripped": tripped, "probed": self._shown(self._at), "probe": self.probe == "stuck"}

    def _touched(self, end: Array) -> bool:
        """Whether a ball is met; then that is where it stands."""
        balls, there = self.balls if self.probe == "sound" else (), tip(self._machine, end)
        share = first_met(tip(self._machine, self._at), there, balls, self._radius)
        self._at = self._at + (share or 0.0) * (end - self._at)
        return share is not None

    def stop(self) -> None:
        """Nothing goes on moving."""
        self.stopped = True

    def close(self) -> None:
        """Nobody asks any more."""
