"""What readings that can be taken bring: every pose of a raster read once, on the built-in five-axis machine.

    python benchmarks/bench_reach.py

Prints for an R-test at one ball and for three spheres how many poses of the raster can be taken, the RMS that is left
over all travel and over the part, and what endless readings would leave.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.accuracy.yardstick import Yardstick
from axiscal.estimation.case import Case
from axiscal.machine import load_machine
from axiscal.measurement.candidates import arrivals_of
from axiscal.measurement.reading import Places
from axiscal.planning.gains.covariance import Covariance
from axiscal_core.threads import one_thread
from benchmarks.rests_as_noise import left_with_rests_as_noise

_TOOL = 'tool_length = "{tool}"\ntool_eccentricity = "0 um"\ntool_certificate = "assumed"\n'
_HEAD = f'machine = "dmu60"\nusual = "off"\n{_TOOL}[target]\nreadings = 1\n{{target}}\n[[artefacts]]\nname = "balls"\n'
_BALLS = (
    'balls.low = ["200 mm", "0 mm", "-80 mm"]\n'
    'balls.high = ["-100 mm", "170 mm", "120 mm"]\n'
    'balls.third = ["-100 mm", "-170 mm", "20 mm"]\n'
)
_SETUP = '[[setups]]\nname = "s"\ninstrument = "sphere"\nsides = "touched"\nartefact = "balls"\nnoise = "{noise}"\n'
_PART = 'part = { radius = "200 mm", z = ["-100 mm", "100 mm"], B = ["-30 deg", "100 deg"] }'
_WHOLE = "aligned = false"
_CASES: tuple[tuple[str, str, str, int, str, str], ...] = (
    ("one ball, 30 deg", "0.7 um", 'ball = "low"\n', 30, "0 um", _WHOLE),
    ("three balls, 30 deg", "1.5 um", "", 30, "0 um", _WHOLE),
    ("three balls, 30 deg, tool open by 20 um", "1.5 um", "", 30, "20 um", _WHOLE),
    ("three balls, 15 deg", "1.5 um", "", 15, "0 um", _WHOLE),
    ("three balls, 15 deg, part not aligned", "1.5 um", "", 15, "0 um", f"{_PART}\naligned = false"),
    ("three balls, 15 deg, part", "1.5 um", "", 15, "0 um", _PART),
)

_ASKED = (16.729, 11.332, 15.292, 10.430, 4.13, 2.54)
"""um, as counted elsewhere."""
_CLOSED = 1e-6
"""rad: a turn that ends where it began."""


def described(noise: str, ball: str, step: int, tool: str, target: str) -> Case:
    """Return the case of one line."""
    raster = f'raster = {{ B = "{step} deg", C = "{step} deg" }}\n'
    text = _HEAD.format(tool=tool, target=target) + _BALLS + _SETUP.format(noise=noise) + ball + raster
    return Case(campaign_from_texts(text, "campaign.toml", load_machine("dmu60").text, "dmu60"))


def figures(case: Case) -> tuple[int, float, float, float]:
    """Return how many poses can be taken, and the RMS before, after reading each once, and after endless readings, um.

    Readings come from below, as far as there is room to; the others of the raster are those of no travel.
    """
    state = Covariance.from_factor(case.observation, case.prior.factor, case.yardstick.root)
    after = state.after_readings(case.lattice)
    yardstick: Yardstick = case.yardstick
    return (
        len(case.lattice),
        1e6 * yardstick.measure(case.prior).rms,
        1e6 * yardstick.rms_of(after.value),
        1e6 * yardstick.unseen_rms,
    )


def every_pose(case: Case) -> Places:
    """Return every pose of a raster that can be taken, a full turn once, with or without room to come to it."""
    (setup,) = case.description.setups
    chart, machine = setup.chart, case.description.machine
    assert chart is not None
    values = [each.values for each in chart.coordinates]
    grid = np.stack([each.ravel() for each in np.meshgrid(*values, indexing="ij")], axis=1)
    turned = machine.axes[0].travel[1] - _CLOSED
    grid = grid[(grid[:, -2] < turned) & chart.feasible(chart.poses(grid))]
    come = arrivals_of(machine, setup, chart, grid, np.ones_like(grid))
    return Places.of_setup(0, chart.poses(grid), np.nan_to_num(come))


def _as_counted_elsewhere() -> None:
    print("\nevery pose of the raster, room to come to it or not; rests as noise; of the part without reversals")
    for (name, noise, ball, step, tool, target), asked in zip(_CASES, _ASKED, strict=True):
        case = described(noise, ball, step, tool, target)
        places = every_pose(case)
        left = left_with_rests_as_noise(case, places, "reversal" if target != _WHOLE else "")
        twice = float(np.sqrt(left**2 + 1e12 * case.yardstick.moments.rest))
        print(
            f"{name:42} {len(places):5} {left:7.3f}   asked for {asked:6.3f}   rests of the volume twice {twice:6.3f}"
        )


@one_thread()
def main() -> None:
    """Print the figures."""
    print(f"{'':42} poses  before   after   endless, um")
    for name, noise, ball, step, tool, target in _CASES:
        count, before, left, endless = figures(described(noise, ball, step, tool, target))
        print(f"{name:42} {count:5} {before:7.2f} {left:7.3f} {endless:9.3f}")
    _as_counted_elsewhere()


if __name__ == "__main__":
    main()
