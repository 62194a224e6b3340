"""One bad reading: it is found, named, and moves nothing; one that somebody vouches for is believed."""

from dataclasses import replace

import numpy as np

from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded, estimated
from axiscal.estimation.estimation import Estimation
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator
from axiscal_core.terms import Term
from tests.generators.campaigns import built_in
from tests.generators.texts import campaign_text, setup_text

LASER = setup_text("laser", "interferometer", direction="x", approach="both")
CASE = Case(built_in(campaign_text("one-axis", LASER, target={"readings": 40})))


def _readings(seed: int, count: int = 30) -> list[Reading]:
    """Return readings of a machine that is drawn."""
    description, rng = CASE.description, np.random.default_rng(seed)
    machine = Simulator(description.machine, description.setups).drawn(seed)
    setup = description.setups[0]

    def taken(position: float, sign: int) -> Reading:
        value = machine.read_all(setup, (position,), (sign,), rng)[0]
        return Reading("laser", (position,), (sign,), value)

    return [taken((i + 0.5) / count, 1 if i % 2 else -1) for i in range(count)]


def _calibrated(readings: list[Reading]) -> Estimation:
    return estimated(CASE, readings)


def _estimated(readings: list[Reading]) -> Estimation:
    return concluded(CASE, readings)


def test_one_gross_error_in_thirty_readings_moves_no_curve_by_half_its_sigma() -> None:
    """It is found in each of four campaigns. In one of them a second reading may go: 1 of 100 is bad beforehand."""
    held = list[bool]()
    for seed in range(4):
        clean = _readings(seed)
        bad = int(np.random.default_rng(seed).integers(2, 28))
        wrong = [replace(r, value=r.value + 50e-6 * (i == bad)) for i, r in enumerate(clean)]
        before, after = _estimated(clean), _estimated(wrong)
        found = [d.reading for d in after.outliers]
        assert bad in found
        held.append(found == [bad] and all(_moves_little(before, after, each) for each in before.case.errors.curves))
    assert sum(held) >= 3


def _moves_little(before: Estimation, after: Estimation, function: Term) -> bool:
    rows, size = (
        function.spline.rows(np.linspace(function.spline.knots[0], function.spline.knots[-1], 101)),
        before.case.errors.size,
    )
    std = np.sqrt(np.sum((rows @ after.knowledge.belief.factor[function.columns]) ** 2, axis=1) + function.rest**2)
    moved = rows @ (after.knowledge.belief.mean[:size] - before.knowledge.belief.mean[:size])[function.columns]
    return bool(np.all(np.abs(moved) <= 0.5 * std))


def test_readings_that_agree_with_their_neighbour_are_a_fact_and_not_bad() -> None:
    """A bump of the curve that two of thirty readings see: no reading is wrong, so none is set aside."""
    bumped = [replace(r, value=r.value + 30e-6 * (i in (14, 15))) for i, r in enumerate(_readings(2))]
    assert not _estimated(bumped).outliers
    lonely = [replace(r, value=r.value + 30e-6 * (i == 14)) for i, r in enumerate(_readings(2))]
    assert [doubt.reading for doubt in _estimated(lonely).outliers] == [14]


def test_a_reading_in_mm_is_not_believed_and_others_do_not_make_it_so() -> None:
    readings = [replace(each, time=60.0 * number) for number, each in enumerate(_readings(1, 6))]
    readings[2] = replace(readings[2], value=2.5e-3)
    at = np.linspace(0, 1, 21)
    for count in (3, 6):
        clean = _calibrated([r for i, r in enumerate(readings[:count]) if i != 2]).estimate().curve("EXX", at)
        others = [replace(each, value=-9e-3) if i == 2 else each for i, each in enumerate(readings[:count])]
        for estimate in (_calibrated, _estimated):
            found, other = estimate(readings[:count]), estimate(others)
            for each in (found, other):
                assert [(d.reading, d.implausible) for d in each.outliers] == [(2, True)]
            np.testing.assert_array_equal(found.printed.belief.mean, other.printed.belief.mean)
            curve = found.estimate().curve("EXX", at)
            assert np.all(np.abs(curve.mean - clean.mean) < 0.5 * clean.std)
