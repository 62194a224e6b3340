"""A three-axis mill with lasers, squares, levels and a ball bar: every place read once, beside what was asked for.

    python benchmarks/bench_reach_mill.py

First a bar of 150 mm in xy, 12 places, both ways, nothing aligned; then the mill aligned, over all travel: lasers at 31
places of each axis, legs of squares at 16 over 300 mm, levels at 13, the bar in three planes every 3 deg, each place
from both sides. Last the proof on a chart of two coordinates against random poses.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.machine import load_machine
from axiscal.measurement.candidates import chart_candidates
from axiscal.measurement.reading import Places
from axiscal.planning.gains.covariance import Covariance
from axiscal_core.threads import one_thread
from benchmarks.rests_as_noise import left_with_rests_as_noise

_MIDDLE, _LENGTH = {"X": 300, "Y": 200, "Z": 200}, {"X": 600, "Y": 400, "Z": 400}
_LEGS = (("X", "y", "xy"), ("Y", "x", "xy"), ("Y", "z", "yz"), ("Z", "y", "yz"), ("Z", "x", "zx"), ("X", "z", "zx"))
_TURNS = (("X", "x"), ("X", "y"), ("Y", "x"), ("Y", "y"), ("Z", "x"), ("Z", "y"))
_ASKED = {
    "lasers": (10.3, 10.2),
    "lasers, squares": (4.69, 3.44),
    "bar, lasers": (6.48, 5.84),
    "bar, lasers, squares": (4.14, 2.60),
    "bar, lasers, squares, levels": (3.30, 1.83),
}


def _setup(name: str, instrument: str, keys: str) -> str:
    return f'[[setups]]\nname = "{name}"\ninstrument = "{instrument}"\napproach = "both"\n{keys}\n'


def bar(plane: str, step: int, height: int) -> str:
    """Return a ball bar in a plane about (300, 200, height) mm, its zero open by 1 um, its centre by 100 um."""
    own = 'unknowns = { zero = "1 um", station_x = "100 um", station_y = "100 um", station_z = "100 um" }\n'
    at = f'length = "150 mm"\nstation = ["300 mm", "200 mm", "{height} mm"]\nplane = "{plane}"\n'
    return _setup(f"bar {plane}", "ballbar", f'{at}raster = {{ arc = "{step} deg" }}\n{own}')


def _lasers() -> str:
    return "".join(_setup(f"laser {a}", "interferometer", f'direction = "{a.lower()}"\nmoves = ["{a}"]') for a in "XYZ")


def _squares() -> str:
    artefacts = "".join(f'[[artefacts]]\nname = "square {name}"\n' for name in ("xy", "yz", "zx"))
    return artefacts + "".join(
        _setup(
            f"leg {a} {d}", "straightedge", f'artefact = "square {name}"\ndirection = "{d}"\nmoves = ["{a}"]\n{_leg(a)}'
        )
        for a, d, name in _LEGS
    )


def _leg(axis: str) -> str:
    return f'reach = {{ {axis} = ["{_MIDDLE[axis] - 150} mm", "{_MIDDLE[axis] + 150} mm"] }}'


def _levels() -> str:
    return "".join(_setup(f"level {a} {d}", "level", f'direction = "{d}"\nmoves = ["{a}"]') for a, d in _TURNS)


def _case(setups: str, target: str, machine: str = "three-axis-mill") -> Case:
    text = f'machine = "{machine}"\nusual = "off"\n[target]\nreadings = 1\n{target}\n{setups}'
    return Case(campaign_from_texts(text, "campaign.toml", load_machine(machine).text, machine))


def everything(case: Case) -> Places:
    """Return every place of every set-up, each from both sides."""
    machine, parts = case.description.machine, list[Places]()
    for index, setup in enumerate(case.description.setups):
        if setup.chart is not None:
            parts.append(Places.of_setup(index, *chart_candidates(machine, setup, setup.chart, 10_000)))
            continue
        (axis,) = setup.moves
        count = {"interferometer": 31, "straightedge": 16, "level": 13}[setup.instrument]
        poses = np.tile(np.array(setup.park), (2 * count, 1))
        poses[:, axis] = np.tile(np.linspace(*setup.span(machine.axes[axis], axis), count), 2)
        approaches = np.zeros_like(poses)
        approaches[:, axis] = np.repeat([1.0, -1.0], count)
        parts.append(Places.of_setup(index, poses, approaches))
    return Places.joined(parts)


def figures(case: Case) -> tuple[int, float, float]:
    """Return the number of readings, the RMS after them and after endless ones, um."""
    state = Covariance.from_factor(case.observation, case.prior.factor, case.yardstick.root)
    places = everything(case)
    left = case.yardstick.rms_of(state.after_readings(places).value)
    return len(places), 1e6 * left, 1e6 * case.yardstick.unseen_rms


def _row(name: str, case: Case, asked: tuple[float, float]) -> None:
    count, left, endless = figures(case)
    noisy = left_with_rests_as_noise(case, everything(case))
    print(f"{name:32} {count:8} {left:7.3f} {endless:8.3f} {noisy:15.3f}   {asked[0]:6.2f} {asked[1]:6.2f}")


@one_thread()
def main() -> None:
    """Print the figures."""
    print(f"{'':32} readings    left  endless  rests as noise   asked for, um")
    _row("bar in xy, not aligned", _case(bar("xy", 30, -70), "aligned = false"), (14.564, 14.483))
    bars = "".join(bar(plane, 3, -70) for plane in ("xy", "yz", "zx"))
    parts = {"bar": bars, "lasers": _lasers(), "squares": _squares(), "levels": _levels()}
    for name, asked in _ASKED.items():
        setups = "".join(parts[part] for part in name.split(", "))
        _row(name, _case(setups, "aligned = true"), asked)


if __name__ == "__main__":
    main()
