"""Figures are of the whole volume, in whatever order its places come; of an axis alone `aligned` says nothing."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest

from axiscal.answers.answer_of_campaign import answered
from axiscal.estimation.accuracy.expanded import expanded, expanded_floor
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator
from axiscal.numerics import Array
from axiscal.planning.unseen import uniform_parts
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.registry import export
from tests.generators.campaigns import on
from tests.generators.texts import machine_text, setup_text

LASER = setup_text("laser", "interferometer", direction="x", moves=["X"], approach="both", unknowns={"zero": "1 mm"})
EDGE = setup_text("edge", "indicator", direction="y", moves=["X"], approach="both", unknowns={"zero": "1 mm"})
ACROSS = setup_text("across", "indicator", direction="x", moves=["Y"], approach="both", unknowns={"zero": "1 mm"})
DIAL = setup_text("dial", "indicator", direction="x", moves=["C"], approach="both", unknowns={"zero": "1 mm"})
ENCODER = setup_text("encoder", "autocollimator", direction="z", moves=["C"], approach="both")
CURVE = 'std = "10 um", length = "150 mm"'


def _case(chain: str, travels: dict[str, tuple[float, float]], errors: dict[str, str], *setups: str) -> Case:
    machine = machine_text(chain, travels, errors, name="m")
    return Case(on(machine, *setups, target={"U": "5 um"}))


def _straight() -> Case:
    return _case("w-b-X-t", {"X": (0, 600)}, {"EXX": CURVE, "EXX_reversal": "3 um", "EYX": CURVE}, LASER, EDGE)


def _rotary() -> Case:
    turned = {"ECC": 'std = "20 urad", length = "60 deg"', "EXC": 'std = "10 um", length = "60 deg"'}
    return _case("w-C'-b-t", {"C": (0, 360)}, turned, DIAL, ENCODER)


def _two() -> Case:
    errors = dict.fromkeys(("EXX", "EYX", "EXY"), CURVE)
    return _case("w-b-Y-X-t", {"X": (0, 600), "Y": (0, 300)}, errors, LASER, EDGE, ACROSS)


ALONE = (_straight, _rotary)


def _readings(case: Case, count: int = 20) -> Sequence[Reading]:
    """Return readings of a virtual machine at places drawn from all that are allowed."""
    rng, setups = np.random.default_rng(3), case.description.setups
    machine, lattice = Simulator(case.description.machine, setups).drawn(3), case.lattice
    found = list[Reading]()
    for at in rng.choice(len(lattice), count, replace=False).tolist():
        setup, pose = setups[lattice.setups[at]], tuple(lattice.poses[at].tolist())
        sides = tuple(int(side) for side in lattice.approaches[at])
        value, *others = machine.read_all(setup, pose, sides, rng)
        found.append(Reading(setup.name, pose, sides, value, others=tuple(others)))
    return found


def _figures(case: Case) -> Array:
    """Return every figure that is printed of the volume and of rows, with tables and without, (n,)."""
    known = concluded(case, _readings(case))
    own, tables = known.case.yardstick, export(known.estimate(), "csv", ExportOptions())
    found = [*known.accuracy, *uniform_parts(own), *tables.effect, tables.known.rms, tables.certain, tables.expected]
    for each in (expanded(own, known.printed.belief), expanded_floor(own)):
        found += [each.space, *each.axes, each.worst]
    for row, shown in answered(known, {"csv": tables.control}):
        found += [row.known, row.floor or 0.0, shown.found, shown.largest, row.before, *shown.left.values()]
    return np.array(found)


def _apart(case: Case) -> Case:
    """Return the case whose part is not aligned."""
    target = replace(case.description.target, aligned=False)
    return Case(replace(case.description, target=target))


def _shuffled(monkeypatch: pytest.MonkeyPatch) -> None:
    in_order = Case._sample

    def sample(case: Case) -> Array | None:
        found = in_order(case)
        return found if found is None else np.random.default_rng(1).permutation(found)

    monkeypatch.setattr(Case, "_sample", sample)


@pytest.mark.parametrize("made", [*ALONE, _two])
def test_no_figure_moves_where_places_are_shuffled(made: Callable[[], Case], monkeypatch: pytest.MonkeyPatch) -> None:
    before = _figures(made())
    _shuffled(monkeypatch)
    np.testing.assert_allclose(_figures(made()), before, rtol=1e-3, atol=1e-12)


@pytest.mark.parametrize("made", ALONE)
def test_an_axis_alone_lies_askew_to_nothing(made: Callable[[], Case]) -> None:
    case = made()
    assert case.description.target.aligned
    np.testing.assert_array_equal(_figures(_apart(case)), _figures(case))
