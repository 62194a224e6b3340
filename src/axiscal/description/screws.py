"""[screws] of campaign.toml: where a bed is levelled, and how far a turn of a screw lifts it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Annotated

from pydantic import Field

from axiscal.document import QuantityText, shown
from axiscal.document.toml_table import Table
from axiscal.document.validation import ReadAs
from axiscal.exceptions import DescriptionError
from axiscal.units import format_quantity, parse_quantity

PITCHES = {"M3": 0.5e-3, "M4": 0.7e-3, "M5": 0.8e-3, "M6": 1.0e-3}
"""Of ISO metric coarse threads (ISO 261), m a turn; those that Klipper knows."""
_MOST = 8
"""More screws than any bed has."""
_FLAT = 1e-6
"""m²: screws a few millimetres apart."""


@dataclass(frozen=True, slots=True)
class BedScrews:
    """pitch : m a turn; lifts : +1 where a clockwise turn lifts the bed, else −1; places : x, y, m, the first stays."""

    pitch: float
    lifts: int
    places: Mapping[str, tuple[float, float]]


def _thread(text: str) -> tuple[float, int]:
    """Return the pitch, m, and +1 where a clockwise turn lifts the bed; raises DescriptionError."""
    turn, _, thread = text.strip().upper().partition("-")
    if turn not in ("CW", "CCW") or thread not in PITCHES:
        remedy = 'Write "CW-M4" where turning clockwise lifts the bed, "CCW-M4" where it lowers it; M3, M4, M5, M6'
        raise DescriptionError("{text} is no thread of a bed screw", remedy, text=shown(text))
    return PITCHES[thread], 1 if turn == "CW" else -1


def _on_bed(given: list[str]) -> tuple[float, float]:
    if len(given) != 2:
        raise DescriptionError("{text} is no place on the bed", 'Write ["30 mm", "30 mm"]', text=shown(given))
    x, y = (parse_quantity(text, "length") for text in given)
    return x, y


Ground = Annotated[tuple[float, float], ReadAs(list[QuantityText], _on_bed)]
"""X and Y of a place on a bed, m."""


def _plane(places: Mapping[str, tuple[float, float]]) -> Mapping[str, tuple[float, float]]:
    """Return places that hold a plane; raises DescriptionError."""
    three = combinations(places.values(), 3)
    wide = any(abs((u - x) * (q - y) - (p - x) * (v - y)) > _FLAT for (x, y), (u, v), (p, q) in three)
    if not wide or len(places) > _MOST:
        raise DescriptionError("these screws hold no plane", "Name three or four that are not in a line")
    return places


class ScrewsTable(Table):
    """[screws]: thread and places of the screws under a bed."""

    thread: Annotated[tuple[float, int], ReadAs(str, _thread)] = Field(examples=['"CW-M4"'])
    places: Annotated[
        Mapping[str, tuple[float, float]],
        ReadAs(dict[str, Ground], _plane),
    ] = Field(examples=['{ "front left" = ["30 mm", "30 mm"], "front right" = […], back = […] }'])

    def screws(self) -> BedScrews:
        """Return them."""
        return BedScrews(*self.thread, self.places)


def screws_text(thread: str, places: Mapping[str, tuple[float, float]]) -> str:
    """Return the lines of campaign.toml.  places : m"""
    shown = ((name, [f'"{format_quantity(each, "mm", 6)}"' for each in place]) for name, place in places.items())
    at = (f'"{name}" = [{", ".join(each)}]' for name, each in shown)
    said = "\n[screws]                        # CHECK: under the bed; the first one stays\n"
    return f'{said}thread = "{thread}"\nplaces = {{ {", ".join(at)} }}\n'
