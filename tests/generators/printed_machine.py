"""A machine as its machine.toml says it, read by tests' own eyes: nothing of the program's reading is used."""

import math
import re
import tomllib
from dataclasses import dataclass
from typing import Any

UNITS = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "rad": 1.0, "mrad": 1e-3, "urad": 1e-6, "deg": math.pi / 180}


def number(text: str) -> float:
    """Return a quantity in m or rad."""
    found = re.fullmatch(r"\s*([-+0-9.eE]+)\s*([a-zµ]+)\s*", text)
    assert found, text
    return float(found[1]) * UNITS[found[2].replace("µ", "u")]


@dataclass(frozen=True)
class PrintedAxis:
    """An axis.  travel, overrun : m or rad; origin : m; counting : "reversed" or None"""

    name: str
    rotary: bool
    travel: tuple[float, float]
    overrun: float
    origin: tuple[float, float, float]
    counting: str | None


@dataclass(frozen=True)
class PrintedNose:
    """radius, stylus, reach, head : m"""

    radius: float
    stylus: float
    reach: float
    head: tuple[float, ...]


@dataclass(frozen=True)
class PrintedMachine:
    """axes : from the workpiece to the tool; tool_length : m; nose : what is round it"""

    axes: tuple[PrintedAxis, ...]
    tool_length: float
    nose: PrintedNose

    def index(self, name: str) -> int:
        """Return the place of an axis in a pose."""
        return [axis.name for axis in self.axes].index(name)

    def axis(self, name: str) -> PrintedAxis:
        """Return an axis by its name."""
        return self.axes[self.index(name)]


def printed_machine(text: str) -> PrintedMachine:
    """Return the machine of a machine.toml."""
    tables = tomllib.loads(text)
    links = [link.rstrip("'") for link in tables["chain"].strip("[]").replace(" ", "-").split("-")]
    names = [link for link in links if link not in ("w", "b", "t", "") and not link.startswith("(")]
    tool = tables.get("tool", {})
    axes = tuple(_axis(name, tables["axes"][name]) for name in names)
    return PrintedMachine(
        axes,
        number(tool.get("length", "0 mm")),
        PrintedNose(
            number(tool.get("radius", "40 mm")),
            number(tool.get("stylus", "0 mm")),
            number(tool.get("reach", "50 mm")),
            tuple(map(number, tool.get("head", ()))),
        ),
    )


def _axis(name: str, table: dict[str, Any]) -> PrintedAxis:
    rotary = name[0] in "ABC"
    low, high = (number(end) for end in table["travel"])
    usual = min(math.radians(1.0) if rotary else 1e-3, 0.01 * (high - low))
    overrun = number(table["overrun"]) if "overrun" in table else usual
    x, y, z = (number(part) for part in table.get("origin", ["0 mm"] * 3))
    return PrintedAxis(name, rotary, (low, high), overrun, (x, y, z), table.get("direction"))
