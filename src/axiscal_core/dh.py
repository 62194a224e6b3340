"""A robot by Denavit-Hartenberg parameters, as axes and offsets of their frames.

    A_i = Rz(θ_i) Tz(d_i) Tx(a_i) Rx(α_i)

θ and d of link i move the links after it about and along the axis of joint i. a and α do so along and about its x axis.
All of them are twists of frames at the zero pose, so that a robot is a `Machine` as any other.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from axiscal_core.axes import Axis
from axiscal_core.errors import Offset
from axiscal_core.refusals import Array, InputError, one_of
from axiscal_core.units import Quantity, quantities

PARAMETERS = ("a", "alpha", "d", "theta")


def links(
    parameters: Sequence[Sequence[Quantity]], std: Mapping[str, Quantity], travel: Sequence[Quantity],
    tool: Sequence[Quantity],
) -> tuple[list[Axis], list[Offset], Array, Array]:  # fmt: skip
    """Return axes, errors, the tool point (3,) and the tool's turn (3, 3) where all joints stand at zero."""
    table = quantities(parameters, "Machine.from_dh", "parameters", (None, 4))
    if not isinstance(std, Mapping):
        raise InputError(
            "Machine.from_dh", "std", f"= {std!r} is no mapping", 'Give {"a": "0.1 mm", "alpha": "0.1 mrad"}'
        )
    for name in std:
        one_of("Machine.from_dh", "std", name, PARAMETERS)
    turn, at, frames = np.eye(3), np.zeros(3), []
    for a, alpha, d, theta in table:
        z = turn[:, 2]
        frames.append((at, z))
        turn = turn @ _about(2, theta)
        at = at + d * z + a * turn[:, 0]
        frames.append((at, turn[:, 0]))
        turn = turn @ _about(0, alpha)
    names = [f"J{i + 1}" for i in range(len(table))]
    axes = [
        Axis.turning(name, z.tolist(), travel, origin.tolist())
        for name, (origin, z) in zip(names, frames[::2], strict=True)
    ]
    point = at + turn @ quantities(tool, "Machine.from_dh", "tool", (3,))
    errors = []
    for i, (joint, ((_, z), (end, x))) in enumerate(
        zip(names, zip(frames[::2], frames[1::2], strict=True), strict=True)
    ):
        following = names[i + 1] if i + 1 < len(names) else "tool"
        if following == "tool":  # its twists are in the tool's own frame, about its point
            own, arm = turn.T @ x, turn.T @ np.cross(x, point - end)
        else:
            own, arm = x, np.zeros(3)
        twists = {
            "a": (following, own, np.zeros(3)), "alpha": (following, arm, own),
            "d": (joint, z, np.zeros(3)), "theta": (joint, np.zeros(3), z),
        }  # fmt: skip
        for name, size in std.items():
            frame, shift, spin = twists[name]
            errors.append(Offset(f"{name}{i + 1}", frame, [*shift, *spin], size))
    return axes, errors, point, turn


def _about(axis: int, angle: float) -> Array:
    """Return the turn about x (0) or z (2), (3, 3)."""
    c, s = np.cos(angle), np.sin(angle)
    i, j = {0: (1, 2), 2: (0, 1)}[axis]
    result = np.eye(3)
    result[i, i], result[i, j], result[j, i], result[j, j] = c, -s, s, c
    return result
