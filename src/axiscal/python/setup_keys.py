"""A campaign in Python: the same keys as campaign.toml, without a file on disk.

Quantities as a person may give them in Python: a number in SI units, or a text with its unit.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from axiscal.document.quoting import toml_value
from axiscal.units import Dimension, parse_quantity

Quantity = float | int | str
"""A number in m, rad or s, or text such as "12 um"."""


def si(value: Quantity, dimension: Dimension) -> float:
    """Return a quantity in SI units; raises UnitError for text that is none."""
    return parse_quantity(value, dimension) if isinstance(value, str) else float(value)


@dataclass(frozen=True, slots=True)
class SetupKeys:
    """A set-up before it stands on a machine: the keys of a [[setups]] table of campaign.toml."""

    keys: Mapping[str, Any] = field(default_factory=dict)

    def __repr__(self) -> str:
        return f"<set-up {self.keys['name']}: {self.keys['instrument']}>"


def setup(
    instrument: str,
    direction: str | Sequence[float] | None = None,
    *,
    moves: Sequence[str] | None = None,
    name: str | None = None,
    **keys: Any,
) -> SetupKeys:
    """Return a set-up with the instrument's usual noise, unknowns and times.

    direction : "x", "-y" or a vector, for instruments that read along or about one; moves : axes, default all
    keys : of campaign.toml, quantities as text: noise="0.3 um", approach="both", park={"Y": "250 mm"}
    """
    usual = " ".join([instrument, *([direction] if isinstance(direction, str) else []), *(moves or ())])
    stated = {"name": name or usual, "instrument": instrument, "direction": direction, "moves": moves, **keys}
    return SetupKeys(MappingProxyType({key: value for key, value in stated.items() if value is not None}))


def campaign_text(machine: str, setups: Sequence[SetupKeys], target: Mapping[str, Any], scales: str) -> str:
    """Return the campaign.toml that says the same.  machine : what stands there as its name"""
    lines = [f"machine = {toml_value(machine)}", f"scales = {toml_value(scales)}", "[target]", *_pairs(target)]
    for each in setups:
        lines += ["[[setups]]", *_pairs(each.keys)]
    return "\n".join(lines) + "\n"


def _pairs(keys: Mapping[str, Any]) -> list[str]:
    return [f"{key} = {toml_value(value)}" for key, value in keys.items()]
