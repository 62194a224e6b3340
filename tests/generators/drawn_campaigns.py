"""Campaigns that a seed draws, with readings of a truth that shares nothing with the error model."""

from pathlib import Path

import numpy as np

from tests.generators.texts import campaign_text, machine_text, setup_text

LETTERS = "XYZ"
Travels = dict[str, float]
"""Axes with the lengths of their travels, mm."""


def written(seed: int, folder: Path) -> tuple[Path, Path]:
    """Write what a seed draws; return the files of the campaign and of its readings."""
    rng = np.random.default_rng(seed)
    travels = {axis: float(rng.integers(2, 11)) * 100 for axis in LETTERS[: int(rng.integers(1, 4))]}
    more = int(rng.integers(0, 3))
    (folder / "machine.toml").write_text(_machine(rng, travels, more))
    named = {f"laser {axis}": (axis, axis) for axis in list(travels)[: int(rng.integers(1, 4))]}
    if more and len(travels) > 1:
        named |= {"dial along X": ("X", "Y"), "dial along Y": ("Y", "X")}
    parked = {axis: round(length * rng.uniform(0.2, 0.8)) for axis, length in travels.items()}
    setups = [_setup(name, *ways, parked) for name, ways in named.items()]
    count = int(rng.integers(4, 9))
    rows = [row for name, (axis, _) in named.items() for row in _readings(rng, name, axis, travels[axis], count)]
    header = f"setup,{','.join(f'{axis}_mm' for axis in travels)},approach,value_um"
    lines = [",".join([name, *_pose(axis, x, parked), side, f"{value:.3f}"]) for name, axis, x, side, value in rows]
    campaign, readings = folder / "campaign.toml", folder / "readings.csv"
    campaign.write_text(campaign_text("machine.toml", *setups, target={"readings": 99}, controls=["csv"]))
    readings.write_text("\n".join([header, *lines, ""]))
    return campaign, readings


def _machine(rng: np.random.Generator, travels: Travels, more: int) -> str:
    """Return a machine.  more : 0 positioning alone, 1 with straightness and squareness, 2 with angles as well"""
    errors = dict[str, str]()
    for axis in travels:
        across = [way for way in LETTERS if way != axis]
        errors |= {f"E{axis}{axis}": f"{rng.uniform(3, 20):.1f} um", f"E{axis}{axis}_reversal": "2 um"}
        errors |= {f"E{way}{axis}": f"{rng.uniform(2, 8):.1f} um" for way in across if more}
        errors |= {f"E{way}{axis}": f"{rng.uniform(5, 30):.1f} urad" for way in "ABC" if more == 2}
        if more == 0 and rng.random() < 0.5:
            break  # other axes are there, and nothing is described of them
    if more and len(travels) > 1:
        errors["C0Y"] = "40 urad"
    ends = {axis: (0.0, length) for axis, length in travels.items()}
    return machine_text(f"w-b-{'-'.join(travels)}-t", ends, errors, curve=(5, 150), tool=100.0)


def _setup(name: str, axis: str, way: str, parked: dict[str, int]) -> str:
    """Return a laser along its axis, or a dial on a straightedge across it."""
    park = {other: f"{at} mm" for other, at in parked.items() if other != axis}
    instrument = "interferometer" if axis == way else "straightedge"
    noise = "0.4 um" if axis == way else "1 um"
    return setup_text(name, instrument, direction=way.lower(), moves=[axis], park=park, noise=noise, approach="both")


def _readings(
    rng: np.random.Generator, name: str, axis: str, length: float, count: int
) -> list[tuple[str, str, float, str, float]]:
    """Return readings out and back: a slope, a wave, a backlash and noise."""
    places = np.linspace(0.05, 0.95, count) * length
    slope, wave, lag, turn = rng.normal(0, [15e-3, 4.0, 2.0, 3.0])
    found = list[tuple[str, str, float, str, float]]()
    for side, way in ((1, places), (-1, places[::-1])):
        true = slope * way + wave * np.sin(2 * np.pi * way / (0.4 * length) + turn) + side * lag / 2
        values = true + 0.4 * rng.standard_normal(count)
        found += [(name, axis, x, f"{axis}{'+' if side > 0 else '-'}", v) for x, v in zip(way, values, strict=True)]
    return found


def _pose(axis: str, x: float, parked: dict[str, int]) -> list[str]:
    return [f"{x:.3f}" if each == axis else f"{at}" for each, at in parked.items()]
