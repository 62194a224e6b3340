"""Programs that are rewritten, run by LinuxCNC's own interpreter on a machine with play that the test makes itself."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import KDTree

from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.machine import load_machine
from axiscal.machine.description import machine_from_text
from axiscal.measurement.readers.text_file import TextFile
from axiscal.numerics import Array
from axiscal.programs.part_program import read_program
from axiscal.tables.rewriting import Rewritten, Sent, rewrite
from axiscal.tables.round_trip import drawn_and_known
from axiscal_core.normal import Normal
from tests.programs.readers import canonical_calls, interpreter

ORIGIN = (0.25, 0.2, 0.15)
PLAY = 6e-6
PART = """%
(a plate)
G21 G90 G17 G40 G49 G80 G94 G54
T1 M6
S8000 M3
G0 Z5
G0 X0 Y0
X-60 Y-40
G1 Z-1 F100
G1 X60 Y-40 F600 ; along
X60 Y40
X-60
Y-40
G2 X-20 Y0 I40 J0
g3 x20 y0 r20
G91 G1 X-10 Y-10
G90 G3 X10 Y-10 Z-3 I0 J20 (a helix)
G1 X80 Y60 Z-20
G0 Z30 M9
G28 G91 Z0
G90
M30
%
"""


def known(seed: int = 1) -> Estimate:
    """Return a mill that is known, each of whose axes lags by its play."""
    drawn = drawn_and_known(load_machine("three-axis-mill"), seed)
    mean = drawn.belief.mean.copy()
    for function in drawn.model.curves:
        if function.kind == "reversal":
            mean[function.columns] = -PLAY * drawn.machine.axes[function.axis].sign
    return replace(drawn, belief=Normal(mean, drawn.belief.factor))


def written(text: str, estimate: Estimate, chord: float = 0.2e-6) -> Rewritten:
    return rewrite(TextFile("part.ngc", tuple(text.splitlines())), "mm", estimate, ORIGIN, chord)


def traced(text: str, folder: Path) -> tuple[Array, Array]:
    """Return where LinuxCNC's interpreter goes, every 0.2 mm, (n, 3) m, and where it does so at a feed, (n,)."""
    at, path, feeds = np.zeros(3), list[Array](), list[bool]()
    for call in canonical_calls(text, folder):
        name, _, rest = call.partition("(")
        numbers = [float(each) for each in re.findall(r"-?\d+\.\d+|-?\d+", rest)]
        if name in ("STRAIGHT_FEED", "STRAIGHT_TRAVERSE"):
            way = [at, np.array(numbers[:3])]
            steps = np.linspace(0, 1, 2 + int(np.linalg.norm(way[1] - way[0]) / 0.2))[1:, None]
            points = way[0] + steps * (way[1] - way[0])
        elif name == "ARC_FEED":  # ends and centre in the plane XY, turns, the height at the end
            end, centre, turns = np.array([*numbers[:2], numbers[5]]), np.array(numbers[2:4]), numbers[4]
            first, last = (np.arctan2(*(p[:2] - centre)[::-1]) for p in (at, end))
            turn = (last - first) % (2 * np.pi) or 2 * np.pi
            turn = turn if turns > 0 else turn - 2 * np.pi if turn < 2 * np.pi else -turn
            shares = np.linspace(0, 1, 2 + int(abs(turn) * np.linalg.norm(at[:2] - centre) / 0.2))[1:, None]
            angle, radius = first + turn * shares, np.linalg.norm(at[:2] - centre)
            points = np.hstack(
                [centre + radius * np.hstack([np.cos(angle), np.sin(angle)]), at[2] + shares * (end - at)[2]]
            )
        else:
            continue
        path.append(points)
        feeds += [name != "STRAIGHT_TRAVERSE"] * len(points)
        at = points[-1]
    return np.concatenate(path) / 1000, np.array(feeds)


def cuts(estimate: Estimate, commands: Array) -> Array:
    """Return where the tool is, (n, 3) m: each axis stays behind by its play until that is taken up."""
    machine, columns = estimate.machine, [[a.name for a in estimate.machine.axes].index(x) for x in "XYZ"]
    ways, side, before = np.zeros_like(commands), np.zeros(3), commands[0]
    for row, command in enumerate(commands):
        side = np.clip(side + 2 * (command - before) / PLAY, -1.0, 1.0)
        ways[row], before = side, command
    poses, sides = np.zeros((len(commands) + 1, len(machine.axes))), np.zeros((len(commands) + 1, len(machine.axes)))
    poses[:, columns] = np.vstack([commands, np.zeros(3)]) + ORIGIN
    sides[:-1, columns] = ways
    deviation = estimate.deviation(poses, sides)
    found: Array = commands + deviation[:-1] - deviation[-1]  # the program's zero was found with this machine
    return found


def off(tool: Array, way: Array) -> float:
    """Return the RMS distance of places of the tool from a way that is given every 0.2 mm, m."""
    tree, total = KDTree(way), list[float]()
    for place, near in zip(tool, np.asarray(tree.query(tool)[1]).tolist(), strict=True):
        legs = [(way[k], way[k + 1]) for k in (near - 1, near) if 0 <= k < len(way) - 1]
        total.append(min(_distance(place, *leg) for leg in legs))
    return float(np.sqrt(np.mean(np.square(total))))


def _distance(place: Array, first: Array, last: Array) -> float:
    way = last - first
    share = np.clip((place - first) @ way / max(float(way @ way), 1e-30), 0.0, 1.0)
    return float(np.linalg.norm(place - first - share * way))


@pytest.mark.skipif(interpreter() is None, reason="Debian package linuxcnc-uspace is not installed")
@pytest.mark.parametrize("seed", [1, 2])
def test_a_rewritten_program_leaves_a_twentieth_of_the_deviation(tmp_path: Path, seed: int) -> None:
    estimate = known(seed)
    lines = PART.replace("G28 G91 Z0\n", "").replace("T1 M6\n", "")
    way, feeds = traced(lines, tmp_path)
    sent, fed = traced("\n".join(written(lines, estimate).lines) + "\n", tmp_path)
    before = off(cuts(estimate, way)[feeds], way)
    after = off(cuts(estimate, sent)[fed], way)
    assert before > 4e-6
    assert after < 0.05 * before


def test_what_moves_nothing_stays_and_arcs_become_lines() -> None:
    done = written(PART, known(), 0.5e-6)
    text = "\n".join(done.lines)
    for line in ("(a plate)", "T1 M6", "S8000 M3", "F600 ; along", "(a helix)", "G91 G28 Z0", "M30"):
        assert line in done.lines
    assert not [line for line in done.lines if line.startswith(("G2 ", "G3 "))]
    assert text.splitlines().count("G90") == 2  # at the begin, and after G28 in G91
    assert done.motions == 10
    assert done.pieces < 1200


def test_a_coarser_chord_cuts_less_and_nothing_is_added_at_the_program_s_zero() -> None:
    fine, coarse = (written(PART, known(), chord) for chord in (0.2e-6, 5e-6))
    assert coarse.pieces < fine.pieces
    assert "G0 X0.0000 Y0.0000 Z0.0000" in written("G21\nG0 X0 Y0 Z0\n", known()).lines


def test_a_quill_beside_z_takes_nothing_from_what_z_is_sent() -> None:
    text = load_machine("three-axis-mill").text
    quill = text.replace("b-Z-t", "b-Z-W-t").replace("[errors]", '[axes.W]\ntravel = ["0 mm", "100 mm"]\n[errors]', 1)
    sent = [Sent(drawn_and_known(machine_from_text(each)), ORIGIN) for each in (text, quill)]
    added = [each.added(np.array([[0.1, 0.1, 0.1]]), np.zeros((1, 3))) for each in sent]
    assert np.allclose(added[0], added[1], rtol=0, atol=1e-9)


def test_a_machine_of_other_letters_is_refused() -> None:
    other = load_machine("one-axis").text.replace("X", "U").replace("EUU", "EXU")
    with pytest.raises(TableError, match="no axis"):
        Sent(drawn_and_known(machine_from_text(other)), ORIGIN)


def test_inches_and_other_planes_are_the_same_ways() -> None:
    mm = "G21 G90 G18\nG0 X10 Y10 Z30\nG2 X30 Z50 I20 K0 F100\n"
    inch = "G20 G90 G18\nG0 X.3937008 Y.3937008 Z1.1811024\nG2 X1.1811024 Z1.9685039 I.7874016 K0 F4\n"
    ends = [read_program(TextFile("p", tuple(text.splitlines())))[2].motion for text in (mm, inch)]
    assert np.allclose([m.end for m in ends if m], ends[0].end if ends[0] else (), atol=1e-7)
    assert all(m and m.turn == pytest.approx(-3 * np.pi / 2, abs=1e-5) for m in ends)
