"""The bent volume: what is drawn is what the estimate says, enlarged to scale, on one scale in both panels."""

from __future__ import annotations

import itertools
import re
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest

from axiscal.estimation.estimate import concluded
from axiscal.machine import builtin_names, load_machine
from axiscal.numerics import Array
from axiscal.present.drawing.scene import flat
from axiscal.present.found_and_left import found_and_left_drawing, magnification
from axiscal.present.schematic import DrawnMachine
from axiscal.present.volume_error import MACHINES, BentVolume, bent_volume
from axiscal_core.machine import Machine
from tests.generators.campaigns import drawn, mixed
from tests.generators.kinematics import tip
from tests.present.drawn_words import boxes_of, held_inside


def _volume(machine: Machine, size: float = 2e-5, seed: int = 0) -> BentVolume:
    """Return a volume with errors by chance over the linear travels of a machine, three places along each."""
    free = [k for k, axis in enumerate(machine.axes) if not axis.rotary][:3]
    lines = [np.linspace(*machine.axes[k].travel, 3) for k in free]
    shape = (*(3,) * len(free), *(1,) * (3 - len(free)), 3)
    poses = np.zeros((3 ** len(free), len(machine.axes)))
    poses[:, free] = np.stack([each.ravel() for each in np.meshgrid(*lines, indexing="ij")], axis=1)
    tcp = np.array([tip(machine, pose) for pose in poses]).reshape(shape)
    rng = np.random.default_rng(seed)
    found, left = (scale * rng.standard_normal(shape) for scale in (size, size / 10))
    return BentVolume(machine, tcp, found, left, size / 20 * rng.standard_normal((MACHINES, *shape)), True, "linuxcnc")


def test_found_is_the_deviation_that_is_expected_without_a_motion_of_the_part() -> None:
    case = mixed()
    known = concluded(case, drawn(case))
    bent, estimate = bent_volume(known), known.estimate()
    tcp, found = bent.tcp.reshape(-1, 3), bent.found.reshape(-1, 3)
    np.testing.assert_allclose(found.sum(axis=0), 0, atol=1e-12)
    if bent.aligned:
        np.testing.assert_allclose(np.cross(tcp - tcp.mean(axis=0), found).sum(axis=0), 0, atol=1e-12)
    assert bent.left is None
    spread = np.linalg.norm(bent.allowed, axis=-1).max()
    assert 0 < spread < 1e-2
    assert estimate.machine is bent.machine


@pytest.mark.parametrize("name", builtin_names())
@pytest.mark.parametrize("width", [1110.0, 700.0, 360.0])
def test_deviations_are_drawn_to_scale_and_both_panels_on_one(name: str, width: float) -> None:
    volume = _volume(load_machine(name))
    body, times = ElementTree.fromstring(f"<g>{found_and_left_drawing(volume, width).body}</g>"), magnification(volume)
    home = np.array([0.0 if axis.rotary else sum(axis.travel) / 2 for axis in volume.machine.axes])
    room = DrawnMachine(volume.machine, home)
    panels = body.findall("svg")
    assert len(panels) == 2
    scales = []
    for panel, values, colour in zip(panels, (volume.found, volume.left), ("beam", "read"), strict=True):
        assert values is not None
        lines = {
            kind: [_ends(p.get("d", "")) for p in panel.iter("path") if _is(p, kind, colour)]
            for kind in ("nominal", "bent")
        }
        grids = {"nominal": volume.tcp, "bent": volume.tcp + times * values}
        pixels = {kind: np.array(ends).reshape(-1, 2) for kind, ends in lines.items()}
        seen = {
            kind: np.array([flat(room.on_table(e, turned=False)) for e in _edges(grid)]).reshape(-1, 2)
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
    assert pixels_of_bar == pytest.approx(float(said.split()[0]) * 1e-6 * times * scales[0], rel=0.02, abs=0.1)


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
    volume = replace(_volume(load_machine(name)), controller="linuxcnc-volumetric")
    drawing = found_and_left_drawing(volume, width)
    covered = boxes_of(ElementTree.fromstring(f"<svg>{drawing.body}</svg>"))
    held_inside(covered, width, drawing.height)
    assert "found" in {words for words, _ in covered}
