"""Each row is what the standards define, by formulas that share nothing with it."""

import numpy as np
import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.functionals.asked import AskedRow, asked_rows
from axiscal.estimation.functionals.functional import AxisLine, Functional
from axiscal.estimation.known_rows import refuse_unmade
from axiscal.exceptions import DescriptionError
from axiscal.machine import load_machine, machine_from_text
from axiscal.measurement.simulation import Simulator, VirtualMachine
from axiscal.numerics import Array
from tests.generators.texts import machine_text, setup_text

SETUPS = setup_text("laser", "interferometer", direction="x", moves=["X"], park={"Y": "200 mm", "Z": "150 mm"})
MILL = "three-axis-mill"


def _asked(wants: str) -> tuple[dict[str, AskedRow], VirtualMachine]:
    text = f'machine = "m"\n[target]\nreadings = 5\nwants = [{wants}]\n{SETUPS}'
    described = campaign_from_texts(text, "c.toml", load_machine(MILL).text, "m")
    rows = {each.want.row.name: each for each in asked_rows(described, ())}
    return rows, Simulator(described.machine, described.setups).drawn(3)


def _found(asked: AskedRow, machine: VirtualMachine) -> Array:
    functional = _map(asked)
    return functional.row(machine.deviation(functional.poses, functional.sides))


def _map(asked: AskedRow) -> Functional:
    assert asked.map is not None
    return asked.map


def _along(machine: VirtualMachine, line: AxisLine, side: float = 0.0) -> Array:
    sides = np.zeros_like(line.poses)
    sides[:, line.axis] = side
    return machine.deviation(line.poses, sides)


@pytest.mark.parametrize(("pair", "ways"), [("XY", (0, 1)), ("XZ", (0, 2)), ("YZ", (1, 2))])
def test_squareness_is_the_angle_between_the_paths(pair: str, ways: tuple[int, int]) -> None:
    """The main direction of each path in its plane, by singular values of where the tool really goes."""
    rows, machine = _asked(f'"squareness {pair}"')
    asked, main = rows[f"squareness {pair}"], []
    for line, way in zip(asked.lines, ways, strict=True):
        went = machine.model.frames(line.poses).tcp + _along(machine, line)
        plane = went[:, ways]
        direction = np.linalg.svd(plane - plane.mean(axis=0))[2][0]
        main.append(direction * np.sign(direction[ways.index(way)]))
    angle = np.arccos(main[0] @ main[1]) - np.pi / 2
    assert _found(asked, machine) == pytest.approx([angle], abs=5e-9)  # times the scale, in the second order
    assert abs(angle) > 1e-6


@pytest.mark.parametrize(("name", "about"), [("roll Y", 1), ("pitch Y", 0), ("yaw Y", 2), ("yaw Z", 1), ("pitch X", 1)])
def test_angles_are_rotations_less_their_mean(name: str, about: int) -> None:
    rows, machine = _asked(f'"{name}"')
    functional = _map(rows[name])
    turned = machine.does(functional.poses, functional.sides).rotation
    np.testing.assert_allclose(functional.row(turned), turned[:, about] - turned[:, about].mean(), atol=1e-15)


@pytest.mark.parametrize("name", ["positioning X", "pitch X", "backlash X"])
def test_the_rest_of_a_cell_is_one_number_for_all_places_in_it(name: str) -> None:
    """Of curves that are known, against the joint covariance of the rests at all places, halved for a reversal."""
    rows, _ = _asked(f'"{name}"')
    curve = 'EXX_reversal = { knots = 5, length = "150 mm", rest = "1 um", '
    mill = load_machine(MILL).text.replace("EXX_reversal = { ", curve)
    row, errors = _map(rows[name]), machine_from_text(mill)
    levers = errors.levers(row.poses, row.angular)
    expected = np.zeros(len(row.weights))
    for term, lever in zip(errors.terms, levers, strict=True):
        sides = row.sides[:, [term.axis]] / 2 if term.kind == "reversal" else 1.0
        effect, cells = np.einsum("kmc,mc->km", row.weights, sides * lever), term.cells(*term.at(row.poses))
        expected += term.rest**2 * np.einsum("km,mn,kn->k", effect, cells[:, None] == cells, effect)
    found = row.spectra(errors, np.zeros((errors.size, 1)))
    np.testing.assert_allclose(found[:, 0], expected, rtol=1e-9, atol=1e-9 * expected.max())


@pytest.mark.parametrize("row", ["positioning X", "backlash Y", "pitch Y", "squareness XY", "straightness Z in X"])
def test_a_wanted_row_that_no_error_makes_is_refused(row: str) -> None:
    """It would be reached unread, with U = 0."""
    machine = load_machine(MILL).text
    text = f'machine = "mill"\n[target]\nreadings = 3\nwants = ["{row}"]\n{SETUPS}'
    refuse_unmade(Case(campaign_from_texts(text, "campaign.toml", machine, "mill")))
    few = machine[: machine.index("[errors]")] + '[errors]\nEZZ = { std = "5 um" }\n'
    with pytest.raises(DescriptionError, match=f"campaign.toml: {row} is wanted, and no error of mill makes it"):
        refuse_unmade(Case(campaign_from_texts(text, "campaign.toml", few, "mill")))


def test_an_accuracy_along_a_direction_in_which_no_error_counts_is_refused() -> None:
    laser = setup_text("laser", "interferometer", direction="x", moves=["X"])
    text = f'machine = "m"\n[target]\nU = "30 um"\ndirections = ["z"]\n{laser}'
    refuse_unmade(Case(campaign_from_texts(text, "campaign.toml", load_machine(MILL).text, MILL)))
    with pytest.raises(DescriptionError, match="volume is wanted, and no error of one-axis makes it"):
        refuse_unmade(Case(campaign_from_texts(text, "campaign.toml", load_machine("one-axis").text, "one-axis")))


@pytest.mark.parametrize("wanted", ["", 'wants = ["straightness X in Y"]'])
def test_a_straightness_is_told_in_a_direction_along_which_no_axis_moves(wanted: str) -> None:
    """A lathe has no Y, and a bed alone has neither Y nor Z."""
    machine = machine_text("w-b-X-t", {"X": (0, 400)}, {"EXX EYX": "10 um"})
    dial = setup_text("dial", "straightedge", direction="y", moves=["X"], reach={"X": ["20 mm", "380 mm"]})
    described = campaign_from_texts(f'machine = "m"\n[target]\nreadings = 6\n{wanted}\n{dial}', "c.toml", machine, "m")
    straight = asked_rows(described, ())[0]
    assert straight.want.row.name == "straightness X in Y"
    truth = Simulator(described.machine, described.setups).drawn(3)
    across = _along(truth, straight.lines[0])[:, 1]
    at = straight.lines[0].poses[:, 0]
    residual = across - np.polyval(np.polyfit(at, across, 1), at)
    np.testing.assert_allclose(_found(straight, truth), residual, atol=1e-12)
