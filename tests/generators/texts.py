"""Descriptions of small machines as a person would write them, for tests that need one of their own."""

import json
from collections.abc import Mapping

Said = str | bool | float | list["Said"] | Mapping[str, "Said"]
"""What a key of a description may be."""


def campaign_text(machine: str, *blocks: str, target: Mapping[str, Said] | None = None, **first: Said) -> str:
    """Return the text of campaign.toml.

    blocks : artefacts and set-ups, each as text; target : none if it only evaluates; first : further keys at the top
    """
    goal = "" if target is None else f"[target]\n{_keys(target)}"
    return _keys({"machine": machine, **first}) + goal + "".join(blocks)


def setup_text(name: str, instrument: str, **said: Said) -> str:
    """Return a set-up of campaign.toml."""
    return "[[setups]]\n" + _keys({"name": name, "instrument": instrument, **said})


def artefact_text(name: str, **said: Said) -> str:
    """Return an artefact of campaign.toml."""
    return "[[artefacts]]\n" + _keys({"name": name, **said})


def _keys(said: Mapping[str, Said]) -> str:
    return "".join(f"{key} = {_toml(value)}\n" for key, value in said.items())


def _toml(value: Said) -> str:
    if isinstance(value, Mapping):
        return f"{{ {', '.join(f'{key} = {_toml(each)}' for key, each in value.items())} }}" if value else "{}"
    if isinstance(value, list):
        return f"[{', '.join(map(_toml, value))}]"
    return json.dumps(value, ensure_ascii=False)


Std = str | tuple[str, int, int]
"""Of an error: its std, or also knots and length, mm or deg, of its curve, or all that TOML says of it."""


def machine_text(
    chain: str,
    travels: Mapping[str, tuple[float, float]],
    errors: Mapping[str, Std],
    *,
    curve: tuple[int, int] = (5, 200),
    tool: float | None = None,
    name: str = "",
    origins: Mapping[str, tuple[float, float, float]] | None = None,
) -> str:
    """Return the text of machine.toml.

    travels : of each axis, mm or deg; errors : the std of each, of several if the key names several
    curve : knots and length, mm or deg, of the errors that vary along an axis; tool : mm
    origins : where rotary axes lie, mm
    """
    lines = [f'name = "{name}"'] if name else []
    lines.append(f'chain = "{chain}"')
    if tool is not None:
        lines += ["[tool]", f'length = "{tool:g} mm"']
    for axis, (low, high) in travels.items():
        unit = "deg" if axis in "ABC" else "mm"
        lines += [f"[axes.{axis}]", f'travel = ["{low:g} {unit}", "{high:g} {unit}"]']
        if origins and axis in origins:
            lines.append(f"origin = {_toml([f'{at:g} mm' for at in origins[axis]])}")
    lines.append("[errors]")
    lines += [f"{error} = {{ {_prior(error, std, curve)} }}" for key, std in errors.items() for error in key.split()]
    return "\n".join(lines) + "\n"


def _prior(error: str, std: Std, curve: tuple[int, int]) -> str:
    if isinstance(std, str) and "=" in std:
        return std
    size, *own = (std,) if isinstance(std, str) else std
    if error.endswith("_reversal") or error[1] == "0":  # one value each
        return f'std = "{size}"'
    knots, length = own or curve
    unit = "deg" if error[2] in "ABC" else "mm"
    return f'std = "{size}", knots = {knots}, length = "{length} {unit}"'


FOUR_READINGS = campaign_text(
    "one-axis",
    setup_text("laser", "interferometer", direction="x", approach="both", noise="0.5 um"),
    target={"readings": 4},
)
"""A campaign of four readings on the built-in machine of one axis."""

TWO_SPHERES = campaign_text(
    "dmu60",
    artefact_text("two spheres", balls={"low": ["200 mm", "0 mm", "-80 mm"], "high": ["-100 mm", "170 mm", "120 mm"]}),
    setup_text(
        "spheres, touched",
        "sphere",
        artefact="two spheres",
        raster={"B": "15 deg", "C": "15 deg"},
        approach="both",
    ),
    target={
        "readings": 5,
        "part": {"radius": "200 mm", "z": ["-100 mm", "100 mm"], "B": ["-30 deg", "100 deg"]},
    },
)
"""A campaign of five readings on the built-in machine of five axes, of three numbers each."""
