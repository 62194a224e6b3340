"""Plans that their readings can vouch for: the rank-one algebra against plain matrices, and what it brings."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from axiscal.accuracy.criterion import joint_root
from axiscal.accuracy.damage import KAPPA, Harm, needed
from axiscal.description.campaign import campaign_from_texts
from axiscal.design.gains.candidate_rows import Pool
from axiscal.design.gains.running_gains import Scores
from axiscal.design.plan import guarded as guarded_module
from axiscal.design.plan.defended import DefendedScores
from axiscal.design.plan.guarded import enough_readings, vouched_along, vouched_for, worst_slip
from axiscal.design.plan.order import in_order, seconds_each
from axiscal.design.plan.plain_designs import evenly_spaced, space_filling
from axiscal.design.plan.plan import Plan, make_plan
from axiscal.design.plan.task import Limits, Task
from axiscal.design.plan.watch import Watch, doubting, retimed, watch, way_shares
from axiscal.estimation.case import Case
from axiscal.estimation.effect_map import EffectMap
from axiscal.machine import load_machine
from axiscal.measurement.departures import IN_PLANS, Departure, departures
from axiscal.measurement.place import Places
from axiscal.measurement.reading import Reading
from axiscal.numerics.ties import ALIKE, first_best
from axiscal.planning.next_readings import posed
from tests.design.test_out_and_back import CAMPAIGN, one_axis
from tests.design.test_three_values import mixed
from tests.generators.designs import in_one_round, levered


@cache
def plan(readings: int, guard: bool) -> Plan:
    """Return a plan of the built-in axis."""
    return make_plan(one_axis()[1], Limits(readings=readings), bounded=False, guard=guard)


def watched_in(task: Task) -> Watch:
    """Return what is watched for, with the times of twelve candidates read in their order."""
    order = in_order(task, task.lattice.within(slice(None, None, len(task.lattice) // 12)))
    return watch(task.observation, task.yardstick, task.lattice, order, np.cumsum(seconds_each(task, order)))


def begun(task: Task, seed: int, count: int = 12, doubted: int = 0) -> DefendedScores:
    """Return the scores after so many candidates at random, of which the first may be bad, so many."""
    watched = doubting(watched_in(task), doubted)
    scores = DefendedScores(Pool(task.observation, task.lattice), task.state, watched, task.yardstick)
    for index in np.random.default_rng(seed).integers(0, len(task.lattice), count).tolist():
        scores.enter(index)
    return scores


def readings_of(task: Task, scores: DefendedScores) -> list[Reading]:
    """Return the readings of the plan with the times that the search counts with."""
    shares = way_shares(task.observation, scores.places, scores.watched.times)
    rows = zip(scores.places.poses.tolist(), scores.places.approaches.tolist(), shares.tolist(), strict=True)
    return [Reading("laser", tuple(p), tuple(int(s) for s in sides), 0.0, time=share) for p, sides, share in rows]


def test_rank_one_updates_are_the_plain_matrices_with_a_zero_open_by_a_millimetre() -> None:
    text = CAMPAIGN.format(approach="both") + 'drift = "0"\n'
    case = Case(campaign_from_texts(text, "campaign.toml", load_machine("one-axis").text, "one-axis"))
    task = posed(case, case.knowledge)
    scores = begun(task, 0)
    scores.leave(4)
    scores.enter(900, 4)
    effects, first = EffectMap.of(case, readings_of(task, scores)), 0
    for each in scores.watched.departures:
        part = slice(first, first := first + each.columns.shape[1])
        columns = scores.watched.columns(scores.places)[:, part]
        span = np.ptp(columns) if each.family in ("drift", "levelling", "excursion") else 1.0
        (direct,) = effects.each([replace(each, columns=columns)])
        assert scores.standing.own[part] / span**2 == pytest.approx(np.diag(direct.information), rel=1e-9)
        assert np.mean(scores.standing.wrong[part]) / span**2 == pytest.approx(direct.wrong, rel=1e-9)


@pytest.mark.parametrize("doubted", [0, 12, 13])
def test_gains_losses_and_exchanges_are_differences_of_the_objective(doubted: int) -> None:
    scores = begun(one_axis()[1], 1, doubted=doubted)
    scores.follow()
    before, gains, losses = scores.objective, scores.gains, scores.losses()
    entered, left = scores.fork(), scores.fork()
    entered.enter(77)
    assert before - entered.objective == pytest.approx(gains[77], rel=1e-6)
    others, own = scores.without(3)
    left.leave(3)
    assert left.objective - before == pytest.approx(losses[3], rel=1e-6) == pytest.approx(own, rel=1e-6)
    without = left.objective
    left.enter(500, 3)
    assert without - left.objective == pytest.approx(others[500], rel=1e-6)


@pytest.mark.parametrize("task", [mixed(150), levered(150), one_axis()[1]], ids=["three values", "one value", "axis"])
def test_what_a_bad_reading_does_is_what_the_plain_matrices_say_after_readings_come_and_go(task: Task) -> None:
    scores = begun(task, 5, 9, doubted=9)
    for slot, candidate in ((4, 90), (0, 17), (8, 120), (4, 33)):
        scores.leave(slot)
        scores.enter(candidate, slot)
    state = task.state.opened(scores.places)
    rows, variances, owner = state.rows(scores.places)
    effects = EffectMap(task.yardstick, rows @ state.factor, np.sqrt(variances), state.weighted)
    for slot in range(9):
        column = (owner == slot).astype(float)[:, None]
        (direct,) = effects.each([Departure("bad", "it", column, float(slot))])
        assert scores.standing.own[slot] == pytest.approx(direct.information[0, 0], rel=1e-6)
        assert scores.standing.wrong[slot] == pytest.approx(direct.wrong, rel=1e-6, abs=1e-18)


def test_a_slip_of_one_number_does_what_its_reading_holds() -> None:
    """D² = need L/(κ² − 1): what J rises by without the reading; of columns and of plain matrices."""
    task = one_axis()[1]
    scores, plain = begun(task, 6, 14, doubted=14), Scores(Pool(task.observation, task.lattice), task.state)
    plain.enter_all(scores.places)
    shown = zip(scores.standing.own[:14], scores.standing.wrong[:14], strict=True)
    harms = [Harm(np.array([[own]]), wrong, most=math.inf) for own, wrong in shown]
    damages = [math.sqrt(needed(1) / (KAPPA**2 - 1) * loss) for loss in plain.losses()]
    assert [each.damage for each in harms] == pytest.approx(damages, rel=1e-6)


@pytest.mark.parametrize("doubted", [0, 12])
@pytest.mark.parametrize("squarings", [2, 4])
@pytest.mark.parametrize("task", [mixed(150), levered(150)], ids=["three values", "one value"])
def test_ruling_out_from_below_finds_the_candidate_that_looking_at_all_finds(
    task: Task, squarings: int, doubted: int
) -> None:
    watched = doubting(watched_in(task), doubted)
    scores = DefendedScores(Pool(task.observation, task.lattice), task.state, watched, task.yardstick, squarings)
    scores.enter_all(task.lattice.within(slice(0, None, 13)))
    allowed = np.random.default_rng(squarings).random(len(scores.pool)) < 0.8
    for slot in range(len(scores.members)):
        gains, own = scores.without(slot)
        best = first_best(np.where(allowed, gains, -np.inf), ALIKE)
        found = scores.replacement(slot, allowed)
        assert found.candidate == best
        assert found.gain == pytest.approx(gains[best], rel=1e-9, abs=1e-12 * scores.objective)
        assert found.own == pytest.approx(own, rel=1e-12)
        for better in (0.0, 0.02):
            needed = scores.replacement(slot, allowed, better)
            if gains[best] > own * (1 + better + 1e-6):
                assert needed.candidate == found.candidate
                assert needed.gain == pytest.approx(found.gain, rel=1e-12, abs=0.0)  # of other products: to rounding
            else:
                assert not needed.gain > own * (1 + better + 1e-6)
    assert scores.replacement(0, np.zeros(len(scores.pool), dtype=bool)).gain == -np.inf


def test_a_machine_with_levers_and_rests_keeps_its_damages() -> None:
    task = levered(300)
    scores = begun(task, 2, 9)
    fresh = DefendedScores(scores.pool, task.state, scores.watched, task.yardstick)
    for index in reversed(range(len(scores.places))):
        fresh.enter(scores.places.at(index))
    assert scores.standing.wrong == pytest.approx(fresh.standing.wrong, rel=1e-6)
    assert scores.standing.own == pytest.approx(fresh.standing.own, rel=1e-6)
    assert scores.objective == pytest.approx(fresh.objective, rel=1e-9)


@pytest.mark.long
def test_a_plan_is_timed_by_its_own_way() -> None:
    task = one_axis()[1]
    order = in_order(task, plan(20, True).places)
    ends = np.cumsum(seconds_each(task, order))
    watched = retimed(watched_in(task), order, ends)
    shares = way_shares(task.observation, order, watched.times)
    assert shares == pytest.approx((ends - ends[0]) / (ends[-1] - ends[0]))


def test_where_several_axes_move_a_place_is_read_when_the_nearest_of_the_plan_is() -> None:
    task = levered(300)
    order = in_order(task, task.lattice.within(slice(None, None, 23)))
    ends = np.cumsum(seconds_each(task, order))
    watched = watch(task.observation, task.yardstick, task.lattice, order, ends)
    assert {each.owner for each in watched.departures if each.family == "drift"} == {"x", "z"}
    shares = way_shares(task.observation, order, watched.times)
    for setup, mine in order.by_setup():
        assert shares[mine] == pytest.approx((ends[mine] - ends[mine[0]]) / (ends[mine[-1]] - ends[mine[0]])), setup
    beside = order.moved(order.poses + 1e-3 * np.array([1.0, -0.1, 0.1]))
    assert way_shares(task.observation, beside, watched.times) == pytest.approx(shares)


@pytest.mark.long
@pytest.mark.parametrize(("readings", "most"), [(20, 0.98e-6), (24, 0.70e-6)])
def test_guarded_plans_vouch_for_nearly_what_they_promise(readings: int, most: float) -> None:
    task, made = one_axis()[1], plan(readings, True)
    found = vouched_for(task, made.places).u_def
    assert len(made.readings) == readings
    assert found <= most
    assert found < 0.7 * vouched_for(task, plan(readings, False).places).u_def
    assert found < 0.7 * vouched_for(task, evenly_spaced(task, [(0, readings)])).u_def
    assert made.accuracy.rms < 1.2 * plan(readings, False).accuracy.rms


@pytest.mark.long
@pytest.mark.parametrize("readings", [14, 20, 32])
def test_one_bad_reading_of_a_guarded_plan_does_little_more_than_is_vouched_for(
    readings: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    task, places = one_axis()[1], plan(readings, True).places
    monkeypatch.setattr(guarded_module._Guarding, "contradicted", lambda self, found: found)
    before = make_plan(task, Limits(readings=readings), bounded=False, guard=True).places
    slips = []
    for each in (before, places):
        whole = task.state.after_readings(each).value
        rise = max(task.state.after_readings(each.without(slot)).value for slot in range(readings)) - whole
        slips.append(math.sqrt(needed(1) / (KAPPA**2 - 1) * rise))
        assert worst_slip(task, each) == pytest.approx(slips[-1], rel=1e-6)
    assert slips[1] < 0.8 * slips[0]
    assert slips[1] < 1.25 * vouched_for(task, places).u_def <= 1.25**2 * vouched_for(task, before).u_def


@pytest.mark.long
def test_what_an_accuracy_asks_for_is_kept_by_readings_that_contradict_a_bad_one() -> None:
    task, target = one_axis()[1], 0.9e-6
    made = make_plan(task, Limits(rms=target), bounded=False, guard=True)
    assert made.met
    assert vouched_for(task, made.places).u_def <= target


def test_a_guarded_plan_is_read_in_two_rounds_for_what_comes_and_goes() -> None:
    task = one_axis()[1]
    two = in_order(task, plan(24, True).places)
    found = [vouched_along(task, each, np.cumsum(seconds_each(task, each))) for each in (two, in_one_round(two))]
    in_two, in_one = ({each.family: each.damage for each in of.departures} for of in found)
    assert in_two["excursion"] < 0.1 * in_one["excursion"]
    assert in_two["growth"] < 0.25 * in_one["growth"]
    assert max(in_two["excursion"], in_two["growth"]) < 0.6e-6


def test_a_budget_is_kept_by_the_way_in_two_rounds() -> None:
    task = one_axis()[1]
    seconds = plan(20, False).seconds
    made = make_plan(task, Limits(budget=seconds), bounded=False, guard=True)
    assert made.seconds <= seconds
    assert np.sum(np.diff(np.sign(np.diff(in_order(task, made.places).poses[:, 0]))) != 0) == 3


@pytest.mark.long
def test_a_guarded_plan_takes_hardly_more_time() -> None:
    assert plan(20, True).seconds < 1.02 * plan(20, False).seconds


@pytest.mark.long
def test_it_is_said_how_many_readings_could_vouch_for_their_promise() -> None:
    task, few = one_axis()[1], plan(14, True).places
    found = enough_readings(task, few, 1.25)
    assert found is not None
    assert 14 < found.readings <= 24
    assert found.vouched < 0.8 * vouched_for(task, few).u_def
    assert enough_readings(task, few, 0.9) is None  # nothing vouches for less than it promises


def test_a_plan_of_two_readings_is_that_of_its_model() -> None:
    plain, same = (plan(2, guard).places for guard in (False, True))
    assert same.same_as(plain)


def test_an_accuracy_is_met_by_what_the_readings_can_vouch_for() -> None:
    task, target = one_axis()[1], 0.7e-6
    plain, made = (make_plan(task, Limits(rms=target), bounded=False, guard=guard) for guard in (False, True))
    assert plain.met
    assert made.met
    assert vouched_for(task, plain.places).u_def > 2 * target
    assert vouched_for(task, made.places).u_def <= target
    assert len(plain.places) < len(made.places) <= 1.5 * len(plain.places) + 8


def test_an_accuracy_that_cannot_be_vouched_for_is_planned_as_its_model_has_it() -> None:
    task = one_axis()[1]
    limits = Limits(readings=11, rms=1e-6)  # ten readings promise it, some twenty could vouch for it
    plain, same = (make_plan(task, limits, bounded=False, guard=guard) for guard in (False, True))
    assert plain.met
    assert same.places.same_as(plain.places)


def test_an_accuracy_that_cannot_be_vouched_for_within_the_time_is_planned_as_its_model_has_it() -> None:
    """The time is that of the readings that promise it: one more takes longer, however they are exchanged."""
    task = one_axis()[1]
    limits = Limits(rms=1e-6, budget=make_plan(task, Limits(rms=1e-6), bounded=False).seconds)
    plain, made = (make_plan(task, limits, bounded=False, guard=guard) for guard in (False, True))
    assert made.met
    assert made.places.same_as(plain.places)


@pytest.mark.parametrize("doubted", [0, 9])
@pytest.mark.parametrize("three", [(0,), (1,), (0, 1)])
def test_readings_of_three_numbers_are_guarded_by_the_same_algebra(three: tuple[int, ...], doubted: int) -> None:
    task = mixed(150, three)
    scores = begun(task, 3, 9, doubted)
    scores.follow()
    before, gains, losses = scores.objective, scores.gains, scores.losses()
    for index in (3, 140):
        entered = scores.fork()
        entered.enter(index)
        assert before - entered.objective == pytest.approx(gains[index], rel=1e-6, abs=1e-9 * before)
    for slot in (0, 5, 8):
        left, (others, own) = scores.fork(), scores.without(slot)
        left.leave(slot)
        assert left.objective - before == pytest.approx(losses[slot], rel=1e-6) == pytest.approx(own, rel=1e-6)
        without = left.objective
        left.enter(77, slot)
        assert without - left.objective == pytest.approx(others[77], rel=1e-6, abs=1e-9 * before)


def test_columns_of_three_numbers_are_those_of_the_departures() -> None:
    task = mixed(80, (0, 1))
    watched = watched_in(task)
    places = task.lattice.within(np.arange(40, 60))
    seen, setups = watched.columns(places), task.observation.setups
    rows = zip(places.setups.tolist(), places.poses.tolist(), places.approaches.tolist(), strict=True)
    readings = [Reading(setups[s].name, tuple(p), tuple(int(x) for x in c), 0.0, others=(0.0, 0.0)) for s, p, c in rows]
    found = {(e.family, e.owner, e.place): e.columns for e in departures(task.observation, readings, IN_PLANS)}
    assert seen.shape == (60, watched.count)
    first = 0
    for each in watched.departures:
        part = slice(first, first := first + each.columns.shape[1])
        if each.function is None:  # a drift: of one number of one set-up; a growth: of all its numbers
            owners = np.repeat(places.setups, 3)
            names, number = np.array([setups[setup].name for setup in owners]), np.arange(60) % 3
            grown = each.family == "growth"
            mine = owners == each.setup if grown else (names == each.owner) & (number == each.place)
            assert np.all(seen[~mine, part] == 0)
            continue
        assert seen[:, part] == pytest.approx(found[each.family, each.owner, each.place], abs=1e-12)


def test_the_criterion_of_the_paper_plans_for_its_model_alone() -> None:
    task = one_axis()[1]
    joint = replace(task, root=joint_root(task.observation.errors))
    plain, same = (make_plan(joint, Limits(readings=9), bounded=False, guard=guard) for guard in (False, True))
    assert same.places.same_as(plain.places)


@pytest.mark.long
@settings(max_examples=4, deadline=None, derandomize=True)
@given(readings=st.integers(4, 18), noise=st.sampled_from([0.1e-6, 0.5e-6, 3e-6]))
def test_no_guarded_plan_vouches_for_much_less_than_the_plain_ones(readings: int, noise: float) -> None:
    task = with_noise(noise)
    plain, made = (make_plan(task, Limits(readings=readings), bounded=False, guard=guard) for guard in (False, True))
    counts = [(0, readings)]
    simple = (plain.places, evenly_spaced(task, counts), space_filling(task, counts))
    assert len(made.places) == readings
    least = min(vouched_for(task, each).u_def for each in simple)
    assert vouched_for(task, made.places).u_def <= 1.25 * least * (1 + ALIKE)  # so that none is believed alone


def with_noise(noise: float) -> Task:
    """Return the built-in axis with another laser and a coarser lattice."""
    task = one_axis()[1]
    (setup,) = task.observation.setups
    observation = replace(task.observation, setups=(replace(setup, noise=noise),))
    return replace(task, observation=observation, lattice=task.lattice.within(slice(None, None, 8)))


def test_plain_readings_that_promise_too_little_are_not_looked_at_in_full(monkeypatch: pytest.MonkeyPatch) -> None:
    """One of two is here; what is not would have vouched for less."""
    guarding, looked = guarded_module._Guarding, dict[bool, list[bool]]()
    could_be = guarding._could_be

    def asked(self: guarded_module._Guarding, places: Places, best: guarded_module._Tried) -> bool:
        found = could_be(self, places, best)
        looked.setdefault(found, []).append(self._tried(places).vouched > best.vouched)
        return found

    monkeypatch.setattr(guarded_module, "_MANY", 0)
    monkeypatch.setattr(guarding, "_could_be", asked)
    make_plan(mixed(150), Limits(readings=8), bounded=False, guard=True, patience=0.0)
    assert looked.keys() == {True, False}
    assert all(looked[False])
