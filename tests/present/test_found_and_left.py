"""The bent volume: what is drawn is what the estimate says, enlarged to scale, on one scale in both panels."""

import itertools
import math
import re
from xml.etree import ElementTree

import numpy as np
import pytest

from axiscal.estimation.estimate import concluded
from axiscal.machine import builtin_names, load_machine
from axiscal.numerics import Array
from axiscal.present.drawing.scene import flat
from axiscal.present.found_and_left import found_and_left_drawing, magnification
from axiscal.present.result import VolumeFigures
from axiscal.present.schematic import upright
from axiscal.present.volume_error import volume_error
from axiscal.tables.surface import Control
from axiscal_core.machine import Machine
from tests.generators.campaigns import drawn, mixed
from tests.generators.kinematics import tip
from tests.present.drawn_words import boxes_of, held_inside


def _volume(machine: Machine, size: float = 20.0, seed: int = 0) -> VolumeFigures:
    """Return a volume with errors by chance, um, over the linear travels of a machine, three places along each."""
    free = [k for k, axis in enumerate(machine.axes) if not axis.rotary][:3]
    lines = [np.linspace(*machine.axes[k].travel, 3) for k in free]
    poses = np.zeros((3 ** len(free), len(machine.axes)))
    poses[:, free] = np.stack([each.ravel() for each in np.meshgrid(*lines, indexing="ij")], axis=1)
    rng = np.random.default_rng(seed)
    return VolumeFigures(
        axes=[machine.axes[k].name for k in free],
        counts=[3] * len(free),
        parked="",
        tcp_mm=[(1e3 * np.array(tip(machine, pose))).tolist() for pose in poses],
        found_um=(size * rng.standard_normal((len(poses), 3))).tolist(),
        half_um=(size / 20 * np.abs(rng.standard_normal((len(poses), 3)))).tolist(),
        left_um=(size / 10 * rng.standard_normal((len(poses), 3))).tolist(),
        controller="linuxcnc",
    )


def test_found_is_the_deviation_that_is_expected_without_a_shift_of_the_part() -> None:
    case = mixed()
    known = concluded(case, drawn(case))
    idle: Control = lambda poses, approaches: np.zeros_like(poses)  # noqa: E731
    volume = volume_error(known, "none", idle)
    assert math.prod(volume.counts) == len(volume.tcp_mm) == len(volume.found_um)
    np.testing.assert_allclose(np.sum(volume.found_um, axis=0), 0, atol=1e-3)
    np.testing.assert_allclose(volume.left_um, volume.found_um, atol=1e-9)
    assert np.min(volume.half_um) > 0


@pytest.mark.parametrize("name", builtin_names())
@pytest.mark.parametrize("size", [0.3, 11.0, 270.0])
def test_the_largest_is_about_a_tenth_of_the_shortest_side(name: str, size: float) -> None:
    volume = _volume(load_machine(name), size)
    times = magnification(volume)
    leading = 10 ** (math.log10(times) % 1)
    assert min(abs(leading - step) for step in (1, 2, 5, 10)) < 1e-9
    ends = [np.linalg.norm(each, axis=1) for each in (volume.found_um, volume.left_um, volume.half_um)]
    largest = 1e-3 * max((ends[0] + ends[2]).max(), (ends[1] + ends[2]).max())
    sides = np.ptp(np.array(volume.tcp_mm), axis=0)
    shortest = min(side for side in sides.tolist() if side > 0)
    assert 1 / 17 < times * largest / shortest < 1 / 6


@pytest.mark.parametrize("name", builtin_names())
@pytest.mark.parametrize("width", [1110.0, 700.0, 360.0])
def test_deviations_are_drawn_to_scale_and_both_panels_on_one(name: str, width: float) -> None:
    machine, volume = load_machine(name), _volume(load_machine(name))
    drawing, times = found_and_left_drawing(volume, machine, width), magnification(volume)
    body = ElementTree.fromstring(f"<g>{drawing.body}</g>")
    shape = (*volume.counts, *(1,) * (3 - len(volume.counts)), 3)
    tcp, found, left = (np.array(x).reshape(shape) for x in (volume.tcp_mm, volume.found_um, volume.left_um))
    panels = body.findall("svg")
    assert len(panels) == 2
    scales = []
    for panel, values, colour in zip(panels, (found, left), ("beam", "read"), strict=True):
        lines = {
            kind: [_ends(p.get("d", "")) for p in panel.iter("path") if _is(p, kind, colour)]
            for kind in ("nominal", "bent")
        }
        grids = {"nominal": tcp, "bent": tcp + times * 1e-3 * values}
        pixels = {kind: np.array(ends).reshape(-1, 2) for kind, ends in lines.items()}
        seen = {
            kind: np.array([flat(e @ upright(machine).T) for e in _edges(grid)]).reshape(-1, 2)
            for kind, grid in grids.items()
        }
        whole, metres = np.vstack([pixels["nominal"], pixels["bent"]]), np.vstack([seen["nominal"], seen["bent"]])
        away = metres - metres.mean(axis=0)
        scale = float(np.sum(away * (whole - whole.mean(axis=0))) / np.sum(away**2))
        np.testing.assert_allclose(whole - whole.mean(axis=0), scale * away, atol=0.15)
        scales.append(scale)
    assert scales[0] == pytest.approx(scales[1], rel=2e-3)
    bar = next(p for p in body.findall("path") if (p.get("d") or "").count("v") == 2)
    pixels_of_bar = float(re.findall(r"h([\d.]+)", bar.get("d", ""))[0])
    said = next(t.text or "" for t in body.findall("text") if re.fullmatch(r"[\d.e+-]+ µm", t.text or ""))
    assert pixels_of_bar == pytest.approx(float(said.split()[0]) * 1e-3 * times * scales[0], rel=0.02, abs=0.1)


def _is(path: ElementTree.Element, kind: str, colour: str) -> bool:
    stroke, width = path.get("stroke"), path.get("stroke-width")
    if kind == "nominal":
        return stroke == "var(--soft)" and path.get("stroke-dasharray") == "4 4"
    return stroke == f"var(--{colour})" and width == "1.9"


def _ends(d: str) -> list[list[float]]:
    points = [[float(number) for number in pair.split()] for pair in d[1:].split("L")]
    return [points[0], points[-1]]


def _edges(grid: Array) -> list[Array]:
    """Return both ends of every edge of a grid, in the order of its directions."""
    found = []
    for along in range(3):
        if grid.shape[along] > 1:
            others = [k for k in range(3) if k != along]
            for i, j in itertools.product(*({0, grid.shape[k] - 1} for k in others)):
                at: list[int | list[int]] = [0, 0, 0]
                at[others[0]], at[others[1]], at[along] = i, j, [0, -1]
                found.append(grid[tuple(at)])
    return found


@pytest.mark.parametrize("name", builtin_names())
@pytest.mark.parametrize("width", [1400.0, 1110.0, 768.0, 360.0])
def test_words_are_inside_and_none_lies_over_another(name: str, width: float) -> None:
    machine = load_machine(name)
    volume = _volume(machine).model_copy(update={"controller": "linuxcnc-volumetric"})
    drawing = found_and_left_drawing(volume, machine, width)
    covered = boxes_of(ElementTree.fromstring(f"<svg>{drawing.body}</svg>"))
    held_inside(covered, width, drawing.height)
    assert "found" in {words for words, _ in covered}
