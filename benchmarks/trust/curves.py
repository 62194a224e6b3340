"""Measured curves and maps as machines whose truth is known wherever it was measured.

Each case states its prior in round figures, not fitted to the curve but not blind either: a std, smoothness over a
part of the travel, the rest to be learnt.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from axiscal.measurement.reading import Reading
from axiscal.numerics import Array

DATA = Path(__file__).resolve().parents[3] / "shared" / "data"
"""The measured curves are not part of the project; without them this part of the page is left out."""

CAMPAIGN = """machine = "measured"
[target]
readings = 1
[[setups]]
name = "gauge"
instrument = "{instrument}"
direction = "{direction}"
noise = "{noise}"
unknowns = {{}}
{raster}
"""


@dataclass(frozen=True, eq=False)
class Measured:
    """A measured curve or map.

    machine, campaign : the two descriptions; places : (m, q) where the truth is known, m or rad; truth : (m,) m or rad
    readings : how many are taken
    """

    name: str
    machine: str
    campaign: str
    places: Array
    truth: Array
    readings: int
    unit: str = "um"

    @property
    def owner(self) -> str:
        """The machine that it is of: curves of one machine count once."""
        return self.name.partition(",")[0]

    def read(self, pose: tuple[float, ...]) -> float:
        """Return the truth at a place; between known places of a curve on the straight line, of a map the nearest."""
        if self.places.shape[1] == 1:
            return float(np.interp(pose[0], self.places[:, 0], self.truth))
        return float(self.truth[int(np.argmin(np.sum((self.places - np.array(pose)) ** 2, axis=1)))])


def _curve(
    name: str, error: str, instrument: str, axis: str, x: Array, y: Array, readings: int, noise: str
) -> Measured:
    unit, travel = ("deg", np.rad2deg(x)) if axis == "C" else ("mm", x * 1e3)
    origin = 'origin = ["0 mm", "0 mm", "0 mm"]\n' if axis == "C" else ""
    ends = f'["{travel[0]:.9g} {unit}", "{travel[-1]:.9g} {unit}"]'
    machine = f'chain = "w-b-{axis}-t"\n[tool]\nlength = "100 mm"\n[axes.{axis}]\ntravel = {ends}\n'
    machine += f"{origin}[errors]\n{error}\n"
    direction = "z" if error.startswith("EZ") else "y" if error.startswith("EY") else "x"
    campaign = CAMPAIGN.format(instrument=instrument, direction=direction, noise=noise, raster="")
    return Measured(name, machine, campaign, x[:, None], y, readings, "urad" if instrument in _ANGULAR else "um")


_KNOTS = 15
"""At most, along a side of a map."""
_ANGULAR = ("level", "autocollimator")


def _rows(path: Path) -> list[dict[str, str]]:
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


def lathe(column: str, name: str) -> Measured:
    """A lathe bed's slope, read by a level."""
    rows = _rows(DATA / "axis_dense" / "lathe_bed_2025-08-14.csv")
    x, y = (np.array([float(row[key]) for row in rows]) for key in ("position_mm", column))
    error = 'EAX = { std = "50 urad", length = "150 mm", rest = "estimate" }'
    return _curve(name, error, "level", "X", x * 1e-3, (y - y.mean()) * 1e-6, 14, "2 urad")


def mirror(number: str, name: str, skipped: int, factor: float, std: str, readings: int) -> Measured:
    """The slope of a long mirror, as the pitch of a slide of its length."""
    lines = (DATA / "axis_dense" / f"dabam-{number}.dat").read_text().splitlines()[skipped:]
    x, y = np.array([[float(word) for word in line.split()[:2]] for line in lines if line.strip()]).T
    length = 0.15 * float(np.ptp(x))
    error = f'EAX = {{ std = "{std}", length = "{length:.4g} mm", rest = "estimate" }}'
    return _curve(name, error, "autocollimator", "X", x * 1e-3, (y - y.mean()) * factor, readings, "0.1 urad")


def spindle() -> Measured:
    """One turn of a milling spindle: the mean of ten turns is the truth."""
    rows = [line.split(",") for line in (DATA / "rotary" / "spindle_runout_fixed_z.csv").read_text().splitlines()]
    time, value = np.array([[float(a), float(b)] for a, b in (r for r in rows if r[0][:1].isdigit())]).T
    angle = 2 * np.pi * 2.6395 / 60 * time % (2 * np.pi)
    edges = np.linspace(0, 2 * np.pi, 73)
    bins = np.digitize(angle, edges) - 1
    y = np.array([value[bins == i].mean() for i in range(72)])
    x = np.concatenate([[0.0], (edges[:-1] + edges[1:]) / 2, [2 * np.pi]])
    ends = (y[0] + y[-1]) / 2
    y = np.concatenate([[ends], y, [ends]]) - y.mean()
    error = 'EXC = { std = "5 um", knots = 25, length = "90 deg", rest = "estimate" }'
    return _curve("spindle, radial", error, "indicator", "C", x, y * 1e-6, 12, "0.3 um")


def _map(name: str, steps: tuple[float, float], grid: Array, readings: int) -> Measured:
    """Return a bed map (rows y, columns x, mm); nodes that were not probed are NaN."""
    ny, nx = grid.shape
    x, y = np.meshgrid(np.arange(nx) * steps[0], np.arange(ny) * steps[1])
    known = np.isfinite(grid.ravel())
    places, values = np.column_stack([x.ravel(), y.ravel()])[known] * 1e-3, grid.ravel()[known] * 1e-3
    return bed_map(name, places, values, readings, f'raster = {{ X = "{steps[0]:.9g} mm", Y = "{steps[1]:.9g} mm" }}\n')


def bed_map(name: str, places: Array, heights: Array, readings: int, raster: str = "") -> Measured:
    """Return a bed as two linear axes, one on the other.

    places : (m, 2) m, a grid or most of one; heights : (m,) m; raster : where readings may be taken
    """
    places = places - places.min(axis=0)
    size = places.max(axis=0) * 1e3
    nx, ny = (min(_KNOTS, len(np.unique(np.round(column, 9)))) for column in places.T)
    machine = (
        'chain = "w-b-X-Y-t"\n[axes.X]\ntravel = ["0 mm", "{0:.9g} mm"]\n[axes.Y]\ntravel = ["0 mm", "{1:.9g} mm"]\n'
    )
    lengths = 0.4 * size
    errors = (
        f'EZX = {{ std = "50 um", knots = {nx}, length = "{lengths[0]:.4g} mm", rest = "estimate" }}',
        f'EZY = {{ std = "50 um", knots = {ny}, length = "{lengths[1]:.4g} mm", rest = "estimate" }}',
        f'EAX = {{ std = "200 urad", knots = {nx}, length = "{lengths[0]:.4g} mm", rest = "estimate" }}',
    )
    text = machine.format(*size) + "[errors]\n" + "\n".join(errors) + "\n"
    reach = f"{raster}{_anywhere(size)}"
    campaign = CAMPAIGN.format(instrument="probe", direction="z", noise="5 um", raster=reach)
    return Measured(name, text, campaign, places, heights - heights.mean(), readings)


def _anywhere(size: Sequence[float] | Array) -> str:
    """Return the line of a set-up that can be read all over a plate.  size : mm"""
    return f'reach = {{ X = ["0 mm", "{size[0]:.9g} mm"], Y = ["0 mm", "{size[1]:.9g} mm"] }}'


def printer(index: int) -> Measured:
    """A Klipper bed mesh, 11 x 11."""
    mesh = json.loads((DATA / "plane" / "klipper" / "neptune4.json").read_text())[index]
    return _map(f"printer bed 11 x 11, map {index + 1}", (20.0, 20.0), np.array(mesh["points_mm"]), 25)


def height_map(file: str, name: str, readings: int) -> Measured:
    """A RepRapFirmware height map; a zero was not probed."""
    lines = (DATA / "plane" / "rrf" / file).read_text().splitlines()
    numbers = [float(word) for word in lines[2].split(",")]
    grid = np.array([[float(word) for word in line.split(",")] for line in lines[3:] if line.strip()])
    return _map(name, (numbers[5], numbers[6]), np.where(grid == 0, np.nan, grid), readings)


def plug_plate(noise: str) -> Measured:
    """Holes drilled by a mill and measured on a CMM: what is left along x after shift, scale and turn.

    noise : as stated; no hole is read twice, so that nothing tells it from what the holes scatter by
    """
    words = [line.split() for line in (DATA / "machine_xy" / "D2130A1").read_text().splitlines()]
    rows = np.array([[float(word) for word in line[:6]] for line in words if len(line) == 9 and _is_number(line[0])])
    x, y, dx, dy = rows[:, 2], rows[:, 3], rows[:, 4], rows[:, 5]
    zero, one = np.zeros_like(x), np.ones_like(x)
    table = np.vstack([np.column_stack([one, zero, x, -y]), np.column_stack([zero, one, y, x])])
    left = np.concatenate([dx, dy]) - table @ np.linalg.lstsq(table, np.concatenate([dx, dy]), rcond=None)[0]
    places = np.column_stack([x - x.min(), y - y.min()]) * 1e-3
    size = places.max(axis=0) * 1e3
    text = 'chain = "w-b-X-Y-t"\n' + "".join(
        f'[axes.{axis}]\ntravel = ["0 mm", "{extent:.9g} mm"]\n' for axis, extent in zip("XY", size, strict=True)
    )
    text += '[errors]\nEXX = { std = "10 um", length = "150 mm", rest = "estimate" }\n'
    text += 'EXY = { std = "10 um", length = "150 mm", rest = "estimate" }\n'
    campaign = CAMPAIGN.format(instrument="probe", direction="x", noise=noise, raster=_anywhere(size))
    return Measured(
        f"plug plate, x error, noise stated as {noise.replace('um', 'µm')}",
        text,
        campaign,
        places,
        left[: len(x)] * 1e-3,
        40,
    )


def _is_number(word: str) -> bool:
    return word.lstrip("-").replace(".", "", 1).isdigit()


@dataclass(frozen=True, eq=False)
class IsoTest:
    """The X slide: its ISO 230-2 test as readings, the dense passes as truth."""

    machine: str
    campaign: str
    readings: tuple[Reading, ...]
    passes: dict[int, tuple[Array, Array]]


def iso_test() -> IsoTest:
    """Return the positioning test of the X slide with the dense passes by direction (positions, deviations), m.

    A pass carries a constant lag of the moving sensor; it is left to the comparison to take one offset per pass off.
    """
    rows = _rows(DATA / "axis_iso230" / "ess_target_x.csv")
    signs = {"+": 1, "-": -1}
    readings = tuple(
        Reading("gauge", (float(r["target_mm"]) * 1e-3,), (signs[r["direction"]],), float(r["deviation_um"]) * 1e-6)
        for r in rows
    )
    dense = _rows(DATA / "axis_dense" / "ess_target_x_passes.csv")
    passes = {}
    for number in sorted({int(row["pass"]) for row in dense}):
        mine = [row for row in dense if int(row["pass"]) == number and abs(float(row["position_mm"])) <= 20]
        x, y = (np.array([float(row[key]) for row in mine]) for key in ("position_mm", "deviation_um"))
        passes[signs[mine[0]["direction"]] * number] = (x * 1e-3, y * 1e-6)
    machine = 'chain = "w-b-X-t"\n[axes.X]\ntravel = ["-20 mm", "20 mm"]\n[errors]\n'
    machine += 'EXX = { std = "30 um", knots = 17, length = "10 mm", rest = "estimate" }\n'
    machine += 'EXX_reversal = { std = "10 um", knots = 5, length = "20 mm" }\n'
    campaign = CAMPAIGN.format(instrument="interferometer", direction="x", noise="3 um", raster='approach = "both"')
    return IsoTest(machine, campaign, readings, passes)


CASES: tuple[Callable[[], Measured], ...] = (
    lambda: lathe("level_y_um_per_m", "lathe bed, pitch"),
    lambda: lathe("level_x_um_per_m", "lathe bed, roll"),
    lambda: mirror("030", "mirror of 480 mm, slope", 0, 1.0, "20 urad", 16),
    lambda: mirror("037", "mirror of 1000 mm, slope", 6, 1e-6, "1 urad", 24),
    spindle,
    lambda: printer(0),
    lambda: printer(4),
    lambda: height_map("predator2_13x13.csv", "delta printer bed", 30),
    lambda: height_map("caribou_8x7.csv", "printer bed 8 x 7", 20),
    lambda: plug_plate("3 um"),
    lambda: plug_plate("0.3 um"),
)
