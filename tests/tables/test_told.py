"""Tables hold what was read: rows that readings tell, as far as they were read, and the figures of the answer."""

import re
from functools import cache

import numpy as np

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation
from axiscal.exceptions import TableError
from axiscal.machine import load_machine
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.offer import Export
from axiscal.tables.registry import export
from tests.generators.texts import artefact_text, campaign_text, machine_text, setup_text

LEGS = {
    axis: setup_text(
        f"leg along {axis}",
        "straightedge",
        artefact="square",
        direction=way,
        moves=[axis],
        reach={axis: [low, high]},
        approach="both",
    )
    for axis, way, low, high in (("X", "y", "150 mm", "450 mm"), ("Y", "x", "100 mm", "300 mm"))
}
SQUARE = campaign_text(
    "m",
    artefact_text("square", turned="1 mrad"),
    *LEGS.values(),
    target={"wants": ["squareness XY 20 urad"], "readings": 20},
)
ROTOR = machine_text("w-C'-b-t", {"C": (0, 360)}, {"ECC": ("0.6 deg", 13, 90)}, name="m")
ENCODER = campaign_text(
    "m",
    setup_text("encoder", "autocollimator", direction="z", moves=["C"], noise="0.01 deg", approach="both"),
    target={"readings": 30},
)
MILL = load_machine("three-axis-mill").text


@cache
def _known(campaign: str, machine: str = MILL) -> Estimation:
    """Return what ten readings of each set-up make known, evenly from end to end, from either side in turn."""
    described, rng = campaign_from_texts(campaign, "c.toml", machine, "m"), np.random.default_rng(3)
    truth, readings = Simulator(described.machine, described.setups).drawn(3), list[Reading]()
    for setup in described.setups:
        (axis,) = setup.moves
        for number, at in enumerate(np.linspace(*setup.span(described.machine.axes[axis], axis), 10).tolist()):
            pose, sides = list(setup.park), [0] * len(setup.park)
            pose[axis], sides[axis] = at, (1, -1)[number % 2]
            place = tuple(pose), tuple(sides)
            readings.append(Reading(setup.name, *place, truth.read_all(setup, *place, rng)[0]))
    return concluded(Case(described), readings)


def _files(known: Estimation) -> Export:
    return export(known.estimate(), "csv", ExportOptions(active=False))


def test_a_square_is_no_reason_to_move_an_axis_along_itself() -> None:
    found = _files(_known(SQUARE))
    assert {(table.axis, table.over) for table in found.tables} == {("X", "Y"), ("Y", "X")}
    (said,) = re.findall(r"a table would take less than 10 % away from \((.*)\)", found.readme)
    assert {"X", "Y", "Z", "Z over X"} <= set(re.split(", | and ", said))
    assert found.effect.after < found.effect.before


def test_beyond_what_was_read_a_table_stays_as_it_is_there() -> None:
    known = _known(SQUARE)
    ends = {"X": (0.15, 0.45), "Y": (0.1, 0.3)}
    for table in _files(known).tables:
        read = sorted(
            reading.pose["XYZ".index(table.over)] for reading in known.readings if table.over in reading.setup
        )
        np.testing.assert_allclose([read[0], read[-1]], ends[table.over], atol=0.02)
        for beyond in (table.positions < read[0] - 0.03, table.positions > read[-1] + 0.03):
            assert np.ptp(table.forward[beyond]) < 0.02 * np.ptp(table.forward)


def test_an_angle_that_moves_no_tool_point_is_judged_by_its_row() -> None:
    found = _files(_known(ENCODER, ROTOR))
    assert [table.axis for table in found.tables] == ["C"]
    assert max(found.effect) == 0.0
    assert found.worth
    assert "stays where it is" in found.readme


NOISY = campaign_text(
    "one-axis",
    setup_text("laser", "interferometer", direction="x", noise="9 um", type_b={"scale": "0.1 um/m"}),
    target={"readings": 6},
    usual="off",
    sure="exactly",
)


def test_a_table_that_is_known_to_its_own_size_is_written_and_takes_away_what_it_says() -> None:
    """Thirty errors over a metre, drawn by numpy from a squared exponential, read at six places."""
    at, rng = np.linspace(0.0, 1.0, 101), np.random.default_rng(6)
    root = np.linalg.cholesky(1e-10 * np.exp(-0.5 * ((at[:, None] - at) / 0.2) ** 2) + 1e-16 * np.eye(101))
    described = campaign_from_texts(NOISY, "c.toml", load_machine("one-axis").text, "one-axis")
    found, left, written = [], [], 0
    for _ in range(30):
        error = root @ rng.standard_normal(101)
        places = range(10, 100, 16)
        shown = [Reading("laser", (float(at[k]),), (1,), float(error[k] + rng.normal(0, 9e-6))) for k in places]
        try:
            tables = _files(concluded(Case(described), shown)).tables
        except TableError:
            continue
        written += 1
        (table,) = tables
        rest = error - table.deviation(at, 1)
        found.append(np.std(error))
        left.append(np.std(rest))
    assert written >= 20
    assert np.sqrt(np.mean(np.square(left))) < 0.9 * np.sqrt(np.mean(np.square(found)))
