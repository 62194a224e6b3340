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
from axiscal_core.refusals import Array, one, one_of, within
from axiscal_core.rigid import turned_about
from axiscal_core.units import METRES, RADIANS, Quantity, quantities, si

PARAMETERS = {"a": METRES, "alpha": RADIANS, "d": METRES, "theta": RADIANS}


def links(
    parameters: Sequence[Sequence[Quantity]], std: Mapping[str, Quantity], travel: Sequence[Quantity],
    tool: Sequence[Quantity],
) -> tuple[list[Axis], list[Offset], Array, Array]:  # fmt: skip
    """Return axes, errors, the tool point (3,) and the tool's turn (3, 3) where all joints stand at zero."""
    table = quantities(parameters, "Machine.from_dh", "parameters", (None, 4), [*PARAMETERS.values()])
    sizes = dict[str, float]()
    for name, size in one("Machine.from_dh", "std", std, Mapping, '{"a": "0.1 mm", "alpha": "0.1 mrad"}').items():
        of = PARAMETERS[one_of("Machine.from_dh", "std", name, [*PARAMETERS])]
        sizes[name] = within("Machine.from_dh", "std", si(size, "Machine.from_dh", "std", of), 0.0)
    turn, at, frames = np.eye(3), np.zeros(3), []
    by_theta, by_alpha = (turned_about(way, table[:, i]) for way, i in ((turn[2], 3), (turn[0], 1)))
    for (a, _, d, _), about_z, about_x in zip(table, by_theta, by_alpha, strict=True):
        start, z = at, turn[:, 2]
        turn = turn @ about_z
        at = start + d * z + a * turn[:, 0]
        frames.append((start, z, at, turn[:, 0]))
        turn = turn @ about_x
    names = [f"J{i + 1}" for i in range(len(table))]
    joints = [*zip(names, frames, strict=True)]
    axes = [Axis.turning(name, z.tolist(), travel, start.tolist()) for name, (start, z, _, _) in joints]
    point = at + turn @ quantities(tool, "Machine.from_dh", "tool", (3,), [METRES])
    errors = []
    for i, (joint, (_, z, end, x)) in enumerate(joints):
        following = names[i + 1] if i + 1 < len(names) else "tool"
        if following == "tool":  # its twists are in the tool's own frame, about its point
            own, arm = turn.T @ x, turn.T @ np.cross(x, point - end)
        else:
            own, arm = x, np.zeros(3)
        twists = {
            "a": (following, own, np.zeros(3)), "alpha": (following, arm, own),
            "d": (joint, z, np.zeros(3)), "theta": (joint, np.zeros(3), z),
        }  # fmt: skip
        for name, number in sizes.items():
            frame, shift, spin = twists[name]
            errors.append(Offset(f"{name}{i + 1}", frame, [*shift, *spin], number))
    return axes, errors, point, turn
