"""A campaign in Python: the same keys as campaign.toml, without a file on disk."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any


@dataclass(frozen=True, slots=True)
class SetupKeys:
    """A set-up before it stands on a machine: the keys of a [[setups]] table of campaign.toml."""

    keys: Mapping[str, Any] = field(default_factory=lambda: MappingProxyType({}))

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
    lines = [f"machine = {_toml(machine)}", f"scales = {_toml(scales)}", "[target]", *_pairs(target)]
    for each in setups:
        lines += ["[[setups]]", *_pairs(each.keys)]
    return "\n".join(lines) + "\n"


def _pairs(keys: Mapping[str, Any]) -> list[str]:
    return [f"{key} = {_toml(value)}" for key, value in keys.items()]


def _toml(value: Any) -> str:
    """Return a value as TOML has it; strings as in JSON, which TOML's basic strings contain."""
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_toml(str(key))} = {_toml(each)}" for key, each in value.items()) + " }"
    if isinstance(value, Sequence) and not isinstance(value, str):
        return "[" + ", ".join(_toml(each) for each in value) + "]"
    return json.dumps(value, ensure_ascii=True)
