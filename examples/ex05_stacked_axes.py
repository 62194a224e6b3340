"""Stacked axes.

The paper's sample machine: three axes on top of each other, one dial that reads the sum of their height errors. Only
the sum of the three constants can ever be seen; J counts the other two combinations for ever.
"""

import numpy as np

import axiscal_core as ac

AXES, MM = [ac.Axis.linear(name, "x", ("0 mm", "10 mm")) for name in "XUP"], 1e-3  # what the paper calls 1
MACHINE = ac.Machine(AXES, [ac.Error(f"EZ{axis.name}", "1 mm", knots=7) for axis in AXES])


def case(noise: str = "0.01 mm") -> ac.Case:
    """Return the machine and its dial, which the paper takes to be as they are stated."""
    dial = ac.Laser("dial", "XUP", along="z", noise=noise, unknowns={"zero": 0.0}, approach="+")
    return ac.Case(MACHINE, [dial], usual="off", sure="exactly", aligned=False)


def chosen(count: int) -> ac.Places:
    """Return so many readings, each the best there is after those before it (B&H eq. 27, 37)."""
    found = ac.Places("dial", np.zeros((0, 3)))
    for _ in range(count):
        found += case().next(found, criterion="joint")
    return found


def left(places: ac.Places) -> tuple[list[float], list[float]]:
    """Return J (B&H eq. 36) and the RMS of the height after none, one and so on of the readings."""
    each = [case().evaluate(places.at(range(i)), criterion="joint") for i in range(len(places) + 1)]
    return [known.J for known in each], [known.rms for known in each]


def main() -> dict[str, object]:
    """Return what 22 readings do to J and to the height."""
    readings, (J, height), exact = np.arange(23.0), left(chosen(22)), case("1 nm")
    lines = {"one joint": (readings, np.sqrt(J) / (30 * MM**3) ** 0.5), "the height": (readings, np.array(height) / MM)}
    return {
        "J before": J[0] / MM**3,
        "J after the first reading": J[1] / MM**3,
        "J that no reading takes away": exact.evaluate(exact.lattice(200), criterion="joint").J / MM**3,
        "height known to, before": height[0] / MM,
        "picture": {"x": "readings", "y": "standard deviation, RMS", "log": True, "lines": lines},
    }


if __name__ == "__main__":
    print({name: value for name, value in main().items() if name != "picture"})
