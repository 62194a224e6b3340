"""A machine with rotary axes.

On a five-axis machine an error acts through a lever that turns with the axes: H(t) maps every control value of every
error to the deviation of the tool centre point. Here the table C turns once while the other axes stand still, and
nothing is measured yet.
"""

import numpy as np

import axiscal as ac


def main() -> dict[str, object]:
    """Return the standard deviation of the TCP as C turns, and what a tilt of the axis of C contributes."""
    machine = ac.load_machine("dmu60")
    before = ac.Normal(np.zeros(machine.size), machine.covariance())
    turn = np.radians(np.arange(0.0, 361.0, 3.0))
    poses = np.tile([0.1, 0.05, 0.2, 0.0, 0.0], (len(turn), 1))  # X, Y, Z in m; B, C in rad
    poses = poses[:, [("X", "Y", "Z", "B", "C").index(axis.name) for axis in machine.axes]]
    poses[:, machine.index("C")] = turn
    rows = machine.rows(poses, np.ones_like(poses)).displacement  # (m, 3, size)
    std = np.stack([before.through(rows[:, k]).std for k in range(3)]) * 1e6
    tilt = rows[:, :, machine.by_name["A0C"].columns][:, :, 0] * 30e-6 * 1e6  # for 30 urad
    return {
        "unknowns": machine.size,
        "x at C = 0, um": float(std[0, 0]),
        "z at C = 0, um": float(std[2, 0]),
        "a tilt of 30 urad moves the TCP in z by up to, um": float(np.abs(tilt[:, 2]).max()),
        "picture": {
            "x": "C, °",
            "y": "standard deviation of the TCP, µm",
            "lines": {name: (np.degrees(turn), std[k]) for k, name in enumerate("xyz")},
        },
    }


if __name__ == "__main__":
    print({name: value for name, value in main().items() if name != "picture"})
