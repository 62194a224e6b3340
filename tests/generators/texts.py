"""Descriptions of small machines as a person would write them, for tests that need one of their own."""

from __future__ import annotations

from collections.abc import Mapping

FOUR_READINGS = """\
machine = "one-axis"
[target]
readings = 4
[[setups]]
name = "laser"
instrument = "interferometer"
direction = "x"
approach = "both"
noise = "0.5 um"
"""
"""A campaign of four readings on the built-in machine of one axis."""

TWO_SPHERES = """\
machine = "dmu60"
[target]
readings = 5
part = { radius = "200 mm", z = ["-100 mm", "100 mm"], B = ["-30 deg", "100 deg"] }
[[artefacts]]
name = "two spheres"
balls = { low = ["200 mm", "0 mm", "-80 mm"], high = ["-100 mm", "170 mm", "120 mm"] }
[[setups]]
name = "spheres, touched"
instrument = "sphere"
artefact = "two spheres"
raster = { B = "15 deg", C = "15 deg" }
approach = "both"
"""
"""A campaign of five readings on the built-in machine of five axes, of three numbers each."""

Std = str | tuple[str, int, int]
"""Of an error: its std, or also the knots and the length, mm or deg, of its curve."""


def machine_text(
    chain: str,
    travels: Mapping[str, tuple[float, float]],
    errors: Mapping[str, Std],
    *,
    curve: tuple[int, int] = (5, 200),
    tool: float | None = None,
    name: str = "",
) -> str:
    """Return the text of machine.toml.

    travels : of each axis, mm or deg; errors : the std of each, of several if the key names several
    curve : knots and length, mm or deg, of the errors that vary along an axis; tool : mm
    """
    lines = [f'name = "{name}"'] if name else []
    lines.append(f'chain = "{chain}"')
    if tool is not None:
        lines += ["[tool]", f'length = "{tool:g} mm"']
    for axis, (low, high) in travels.items():
        unit = "deg" if axis in "ABC" else "mm"
        lines += [f"[axes.{axis}]", f'travel = ["{low:g} {unit}", "{high:g} {unit}"]']
    lines.append("[errors]")
    lines += [f"{error} = {{ {_prior(error, std, curve)} }}" for key, std in errors.items() for error in key.split()]
    return "\n".join(lines) + "\n"


def _prior(error: str, std: Std, curve: tuple[int, int]) -> str:
    size, *own = (std,) if isinstance(std, str) else std
    if error.endswith("_reversal") or error[1] == "0":  # one value each
        return f'std = "{size}"'
    knots, length = own or curve
    unit = "deg" if error[2] in "ABC" else "mm"
    return f'std = "{size}", knots = {knots}, length = "{length} {unit}"'
