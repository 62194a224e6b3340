"""A campaign in Python: the same keys as campaign.toml, without a file on disk."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from axiscal.document.toml_text import toml_value


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
