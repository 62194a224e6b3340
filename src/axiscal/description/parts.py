"""[target] part of campaign.toml read into `PartVolume`: where in the workpiece frame the work is done."""

from __future__ import annotations

from collections.abc import Mapping

from axiscal.accuracy.part import PartVolume, Span
from axiscal.document import Document, shown
from axiscal.exceptions import DescriptionError, InputError
from axiscal.machine import Axis, Machine
from axiscal.units import parse_quantity

_SHAPE = 'Write { radius = "200 mm", z = ["-100 mm", "100 mm"] } or { x = [...], y = [...], z = [...] }'


def read_part(given: Mapping[str, str | list[str]], machine: Machine, document: Document) -> PartVolume:
    """Return the part; raises DescriptionError or UnitError at the line that is wrong."""
    turns = {axis.name: axis.travel for axis in machine.axes if axis.rotary}
    spans: dict[str, Span] = {}
    radius = None
    for key, value in given.items():
        try:
            if key == "radius":
                radius = _radius(value)
            elif key in ("x", "y", "z"):
                spans[key] = _span(value)
            else:
                turns[key] = _turn(value, machine.axis(key))
        except InputError as failure:
            raise document.fault(failure, "target", "part", key) from None
    if "z" not in spans or (radius is None) != ({"x", "y"} <= set(spans)) or (radius is not None and len(spans) > 1):
        raise document.fault(DescriptionError("the part has no shape", _SHAPE), "target", "part")
    width = (-(radius or 0.0), radius or 0.0)
    return PartVolume((spans.get("x", width), spans.get("y", width), spans["z"]), radius, tuple(turns.values()))


def _radius(value: str | list[str]) -> float:
    radius = parse_quantity(value, "length") if isinstance(value, str) else 0.0
    if not radius > 0:
        raise DescriptionError(f"{shown(value)} is no radius", 'Give one such as "200 mm"')
    return radius


def _span(value: str | list[str]) -> Span:
    ends = [parse_quantity(text, "length") for text in value] if isinstance(value, list) else []
    if len(ends) != 2 or not ends[0] < ends[1]:
        raise DescriptionError(f"{shown(value)} has not two ends that increase", 'Give ["-100 mm", "100 mm"]')
    return ends[0], ends[1]


def _turn(value: str | list[str], axis: Axis) -> Span:
    if not axis.rotary:
        raise DescriptionError(f"{axis.name} follows the part", "Name x, y, z in the workpiece frame, or a rotary axis")
    ends = [parse_quantity(text, "angle") for text in value] if isinstance(value, list) else []
    low, high = axis.travel
    slack = 1e-9 * axis.length
    if len(ends) != 2 or not low - slack <= ends[0] < ends[1] <= high + slack:
        raise DescriptionError(f"{shown(value)} is no part of the travel of {axis.name}", f"It is {axis.travel_text}")
    return max(ends[0], low), min(ends[1], high)
