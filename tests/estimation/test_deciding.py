"""The reading that decides between two causes: against predictions written out, and on machines of a known cause."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from axiscal.estimation.deciding import Contest, _rivals, contest
from axiscal.inference.contradiction import SIZES, Explanation, Watched, watched
from axiscal.measurement.departures import Family, departures

from axiscal.estimation.estimate import estimated
from axiscal.inference.weighted_fit import Fitted
from axiscal.measurement.place import Place
from axiscal.measurement.reading import Reading
from axiscal.promise.problem import Inherited
from axiscal.record.events import Asked, Gap
from axiscal.simulation import VirtualMachine
from tests.generators.laser_axis import CASE, machine

Field = Callable[[float, float], float]
FIELDS: dict[str, Field] = {
    "drift": lambda x, t: 0.4e-6 * t / 60,
    "pitch": lambda x, t: 5e-6 * np.sin(2 * np.pi * x / 0.01),
    "step": lambda x, t: 15e-6 * (x > 0.43),
}
ZERO_MOVED = {"drift", "levelling", "jump"}
"""One cause to what comes after: how a zero has moved before no later reading tells."""
WAY = [(float(x), 1) for x in np.linspace(0.013, 0.987, 12)] + [(float(x), -1) for x in np.linspace(0.98, 0.02, 12)]


def one(drawn: VirtualMachine, field: Field, at: tuple[float, int], count: int, rng: np.random.Generator) -> Reading:
    """Return the next reading, a minute after the last one."""
    (x, side), time = at, 60.0 * count
    shown = drawn.read(CASE.description.setups[0], (x,), (side,), rng)
    return Reading("laser", (x,), (side,), shown + field(x, time), time=time)


def until_rivals(name: str, seed: int) -> tuple[list[Reading], Contest]:
    """Return readings of a machine with one cause up to where another competes with it."""
    readings, drawn, rng = list[Reading](), machine(seed), np.random.default_rng(seed)
    for at in WAY:
        readings.append(one(drawn, FIELDS[name], at, len(readings) + 1, rng))
        found = contest(estimated(CASE, readings))
        if found is not None:
            return readings, found
    raise AssertionError("no two causes competed")


@pytest.mark.parametrize(("name", "seed"), [("drift", 0), ("pitch", 0), ("step", 2)])
def test_predictions_are_those_of_joint_normals_written_out(name: str, seed: int) -> None:
    readings, found = until_rivals(name, seed)
    after = readings[-1].time or 0.0
    seconds = CASE.seconds_of(readings[-1], found.place)
    coming = Reading("laser", found.place.pose, found.place.approach, 0.0, time=after + seconds)
    together = [*readings, coming]
    plain = Fitted.of(CASE.observation, together).covariance()
    unit = float(np.sqrt(np.median(Fitted.of(CASE.observation, readings).noise)))
    values, told = np.array([each.value for each in readings]), []
    for rival in (found.first, found.second):
        (part,) = [
            each.columns
            for each in departures(CASE.observation, together, taken=len(readings))
            if (each.family, each.owner, each.place) == (rival.family, rival.owner, rival.place)
        ]
        whole = plain + (unit * SIZES[-1]) ** 2 * part @ part.T
        gain = np.linalg.solve(whole[:-1, :-1], whole[:-1, -1])
        told.append((gain @ values, whole[-1, -1] - gain @ whole[:-1, -1]))
    (first, wide), (second, broad) = told
    assert found.expected == pytest.approx((first, second), rel=1e-4, abs=1e-9)
    assert found.apart == pytest.approx(abs(first - second) / np.sqrt(wide + broad), rel=1e-4)


@pytest.mark.parametrize(("name", "seed"), [("drift", 1), ("drift", 3), ("pitch", 0), ("step", 0), ("step", 2)])
def test_the_right_cause_is_left_after_the_readings_that_decide(name: str, seed: int) -> None:
    readings, found = until_rivals(name, seed)
    drawn, rng, taken = machine(seed), np.random.default_rng((seed, 1)), 0
    going: Contest | None = found
    while going is not None and taken < 5:
        place = going.place
        readings.append(one(drawn, FIELDS[name], (place.pose[0], place.approach[0]), len(readings) + 1, rng))
        going, taken = contest(estimated(CASE, readings)), taken + 1
    best = watched(CASE.observation, readings).explanations[0].family
    assert best in ZERO_MOVED if name == "drift" else best == name
    assert taken <= 3


def test_what_an_earlier_campaign_knew_is_part_of_what_is_predicted() -> None:
    readings, found = until_rivals("drift", 0)
    covariance = CASE.errors.prior_covariance()
    knew = Inherited(CASE.errors.prior_root() @ np.random.default_rng(3).normal(size=CASE.errors.size), covariance)
    coming = Reading("laser", found.place.pose, found.place.approach, 0.0, time=readings[-1].time)
    together, observation = [*readings, coming], CASE.observation
    plain, less = (Fitted.of(observation, together, prior).values for prior in (None, (knew.mean, covariance)))
    moved = [replace(each, value=each.value + by) for each, by in zip(readings, plain - less, strict=False)]
    other = contest(estimated(replace(CASE, inherited=knew), moved))
    assert other is not None
    assert other.place == found.place
    by = float((plain - less)[-1])
    assert abs(by) > 1e-6
    assert other.expected == pytest.approx([each + by for each in found.expected], abs=1e-9)


def test_nothing_has_to_be_decided_of_readings_of_the_model() -> None:
    drawn, rng = machine(4), np.random.default_rng(4)
    readings = [one(drawn, lambda x, t: 0.0, at, n, rng) for n, at in enumerate(WAY, 1)]
    assert contest(estimated(CASE, readings)) is None
    assert contest(estimated(CASE, readings[:5])) is None


def test_no_reading_is_asked_for_where_none_could_be_taken() -> None:
    readings, found = until_rivals("drift", 0)
    gaps = [Gap(Asked(1, Place("laser", found.place.pose, found.place.approach)), "the cover is in the way")]
    other = contest(estimated(CASE, readings), gaps)
    assert other is not None
    assert other.place != found.place
    assert other.apart <= found.apart
    everywhere = [Gap(Asked(1, found.place), "the laser is gone", whole=True)]
    assert contest(estimated(CASE, readings), everywhere) is None


def explained(family: Family, owner: str, odds: float) -> Explanation:
    """Return an explanation with its odds."""
    return Explanation(family, owner, 0.0, odds, 0.0, 0.0)


@pytest.mark.parametrize(
    ("highest", "others", "second"),
    [
        (20.0, [explained("step", "EXX", 50.0)], 0),
        (19.9, [explained("step", "EXX", 50.0)], None),
        (40.0, [explained("step", "EXX", 10.0)], 0),
        (40.0, [explained("step", "EXX", 9.9)], None),
        (40.0, [], None),
        (40.0, [explained("jump", "laser", 90.0), explained("levelling", "laser", 80.0)], None),
        (40.0, [explained("jump", "laser", 90.0), explained("bump", "EXX", 30.0)], 1),
        (40.0, [explained("jump", "dial", 90.0), explained("bump", "EXX", 30.0)], 0),
    ],
    ids=["twenty to one", "less", "a tenth as likely", "less than that", "alone", "one cause", "after it", "another's"],
)
def test_a_rival_is_another_cause_that_is_a_tenth_as_likely_where_the_model_is_contradicted(
    highest: float, others: list[Explanation], second: int | None
) -> None:
    first = explained("drift", "laser", 100.0)
    found = _rivals(Watched((first, *others), highest / 2, highest))
    assert found == (None if second is None else (first, others[second]))


def test_a_bump_and_a_detail_of_one_curve_are_one_cause_and_of_two_curves_are_two() -> None:
    first = explained("bump", "EXX", 100.0)
    assert _rivals(Watched((first, explained("detail", "EXX", 90.0)), 40.0, 40.0)) is None
    assert _rivals(Watched((first, explained("step", "EXX", 90.0)), 40.0, 40.0)) is not None
    assert _rivals(Watched((first, explained("detail", "EYX", 90.0)), 40.0, 40.0)) is not None


@pytest.mark.parametrize(("count", "asked"), [(5, False), (6, True)])
def test_of_five_readings_everything_is_left_open(count: int, asked: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn, rng = machine(0), np.random.default_rng(0)
    readings = [one(drawn, FIELDS["step"], at, number, rng) for number, at in enumerate(WAY[:count])]
    looked = list[int]()

    def looks(observation: object, taken: list[Reading], prior: object) -> Watched:
        looked.append(len(taken))
        return Watched()

    monkeypatch.setattr("axiscal.estimation.deciding.watched", looks)
    assert contest(estimated(CASE, readings)) is None
    assert looked == ([count] if asked else [])
