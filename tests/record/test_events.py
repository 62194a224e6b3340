"""Folding events: against a naive twin that replays every prefix, and against orders that cannot have happened."""

from __future__ import annotations

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.exceptions import RecordError
from axiscal.measurement.reading import Place, Reading
from axiscal.record.accepted import Accepted, Bumped
from axiscal.record.events import (
    Asked,
    Continued,
    Created,
    Event,
    EventOrderError,
    Finished,
    KeptResult,
    Mounted,
    Noted,
    Planned,
    Recorded,
    Skipped,
    State,
    Stored,
    Undone,
    fold,
)
from axiscal.record.payload import PayloadError, decode, encode

CREATED = Created("m", "c", "m.toml", "c.toml", {"axiscal": "0.1.0"})
finite = st.floats(allow_nan=False, allow_infinity=False)
numbers = st.floats(-1e8, 1e8)
readings = st.builds(
    Reading, st.text(), st.tuples(finite, finite), st.tuples(*[st.sampled_from([-1, 0, 1])] * 2), numbers, st.none()
)
recorded = st.builds(Recorded, readings)
asked = st.builds(Asked, st.integers(1, 99), st.builds(Place, st.text(), st.just((0.0, 1.0)), st.just((1, -1))))
skipped, noted = st.builds(Skipped, st.text(), st.booleans()), st.builds(Noted, st.text())
bumped = st.builds(Bumped, st.text(), numbers, st.text())
mounted = st.builds(Mounted, st.text(), st.text(), st.text())
factors = st.sampled_from([-1.0, 1000.0, 1e-3, 25.4, 1 / 25.4]) | st.floats(1e-3, 1e3)
accepted = (
    st.builds(Accepted, st.just("jump"), st.tuples(st.text()), st.integers(1, 99), name=st.text(min_size=1))
    | st.builds(Accepted, st.sampled_from(["sign", "unit"]), st.tuples(st.text()), factor=factors)
    | st.builds(Accepted, st.just("shifted"), st.tuples(st.text()), factor=st.sampled_from([1.0, -1.0]))
    | st.builds(Accepted, st.just("backlash"), st.tuples(st.text()), st.integers(1, 99))
    | st.builds(Accepted, st.just("stuck"), st.lists(st.text(), min_size=1, unique=True).map(tuple), st.integers(1, 99))
    | st.builds(Accepted, st.just("swapped"), st.lists(st.text(), min_size=2, max_size=2, unique=True).map(tuple))
)
continued = st.builds(Continued, st.text())
sizes = st.none() | st.floats(0.0, 1.0)
finished = st.builds(Finished, st.text(), st.builds(KeptResult, sizes, sizes, st.text()))
others = recorded | asked | skipped | noted | bumped | mounted | accepted | finished | st.just(Undone(0))
event = others | continued


def stored(events: list[Event]) -> list[Stored]:
    return [Stored(number, "", each) for number, each in enumerate(events, start=1)]


def possible(drawn: list[Event]) -> list[Event]:
    """Keep of the drawn events those that can happen, each `Undone` naming what can be taken back."""
    events: list[Event] = [CREATED]
    for each in drawn:
        state = fold(stored(events))
        if isinstance(each, Undone):
            if state.undo:
                events.append(Undone(state.undo[-1].number))
        elif isinstance(each, Accepted):
            events += [each] if _can_be(state, each) else []
        elif state.finished is None and not (isinstance(each, Skipped) and state.pending is None):
            events.append(each)
    return events


def _can_be(state: State, each: Accepted) -> bool:
    mine = [[reading.number for reading in state.readings if reading.setup == name] for name in each.setups]
    if state.finished is not None:
        return False
    if each.mistake == "jump":
        return each.reading in mine[0][1:] and each.name not in {one.name for one in state.mounted}
    if each.mistake == "backlash":
        return each.reading in mine[0]
    return all(mine) and len({len(numbers) for numbers in mine}) == 1


few = st.sampled_from(["laser", "bar"])
wrongs = st.one_of(
    st.builds(Accepted, st.just("jump"), st.tuples(few), st.integers(1, 9), name=st.just("before")),
    st.builds(Accepted, st.just("sign"), st.tuples(few), st.integers(0, 9), st.just(-1.0), last=st.integers(0, 9)),
    st.builds(Accepted, st.just("backlash"), st.tuples(few), st.integers(1, 9)),
    st.builds(Accepted, st.just("unit"), st.tuples(few), factor=st.sampled_from([1000.0, 1 / 25.4])),
    st.builds(Accepted, st.just("shifted"), st.tuples(few), factor=st.sampled_from([1.0, -1.0])),
    st.just(Accepted("swapped", ("laser", "bar"))),
)
of_few = st.builds(
    Recorded,
    st.builds(Reading, few, st.just((0.0, 1.0)), st.just((1, -1)), numbers, st.none() | st.just(1e-6)),
)


@given(st.lists(of_few | asked | wrongs | st.just(Undone(0)) | st.builds(Finished, st.text()), max_size=30))
def test_what_was_accepted_leaves_what_was_written(drawn: list[Event]) -> None:
    events = possible(drawn)
    state = fold(stored(events))
    if isinstance(events[-1], Accepted):
        assert state.accepted[-1] == events[-1]
    if not any(isinstance(each, Undone) for each in events):
        without = fold(stored([each for each in events if not isinstance(each, Accepted)]))
        assert state.written == without.readings
        assert state.free == without.free
        assert state.pending == without.pending


RESTORED = {"readings", "written", "mounted", "skipped", "pending", "finished", "undo"}


@given(st.lists(event | of_few | wrongs, max_size=25))
def test_taking_back_one_after_the_other_restores_what_was_before_each(drawn: list[Event]) -> None:
    events = back = possible(drawn)
    names = RESTORED - {"mounted" for each in events if isinstance(each, Mounted)}  # a mounting is not taken back
    while undo := fold(stored(back)).undo:
        back = [*back, Undone(undo[-1].number)]
        before, now = fold(stored(events[: undo[-1].number - 1])), fold(stored(back))
        assert {name for name in names if getattr(now, name) != getattr(before, name)} == set()
    assert fold(stored(back)).readings == ()


@given(st.lists(event, max_size=25))
def test_that_it_goes_on_is_said_of_these_readings_alone(drawn: list[Event]) -> None:
    events = possible(drawn)
    since = [each for each in events if not isinstance(each, Planned | Asked | Noted | Bumped)]
    last = since[-1]
    assert fold(stored(events)).continued == (last.grounds if isinstance(last, Continued) else None)


@given(event)
def test_an_event_survives_the_record(each: Event) -> None:
    kind, text = encode(each)
    assert decode(kind, text) == each
    again = json.dumps(json.loads(text), sort_keys=True, ensure_ascii=False, separators=(",", ":"))
    assert text == again  # one text for what is the same, as chains need it


@given(
    st.sampled_from(["created", "asked", "recorded", "skipped", "accepted", "undone", "finished"]),
    st.text() | st.binary(),
)
def test_any_text_is_an_event_or_refused(kind: str, text: str | bytes) -> None:
    with pytest.raises(PayloadError):
        decode(kind, "{" + str(text))


def test_deep_nesting_is_refused() -> None:
    with pytest.raises(PayloadError):
        decode("asked", "[" * 100_000)


QUESTION = Asked(1, Place("laser", (0.0,), (1,)))
VALUE = Recorded(Reading("laser", (0.0,), (1,), 1e-6))


@pytest.mark.parametrize(
    "events",
    [
        [CREATED, VALUE, Accepted("jump", ("laser",), 1, name="before")],
        [CREATED, VALUE, Accepted("jump", ("laser",), 7, name="before")],
        [CREATED, VALUE, Accepted("jump", ("bar",), 1, name="before")],
        [CREATED, VALUE, Accepted("sign", ("bar",), factor=-1.0)],
        [CREATED, VALUE, Accepted("swapped", ("laser", "bar"))],
        [
            CREATED,
            VALUE,
            Recorded(Reading("bar", (0.0,), (1,), 1e-6, None, None, False, (1e-6, 2e-6))),
            Accepted("swapped", ("laser", "bar")),
        ],
        [CREATED, VALUE, Finished("done"), Accepted("sign", ("laser",), factor=-1.0)],
        [VALUE],
        [CREATED, CREATED],
        [CREATED, Skipped("nobody asked")],
        [CREATED, Undone(1)],
        [CREATED, VALUE, Undone(1)],
        [CREATED, VALUE, Undone(2), Undone(2)],
        [CREATED, QUESTION, Undone(2)],
        [CREATED, Finished("done"), VALUE],
        [CREATED, Finished("done"), QUESTION],
        [CREATED, Finished("done"), Finished("again")],
    ],
)
def test_an_impossible_order_is_refused(events: list[Event]) -> None:
    with pytest.raises(EventOrderError):
        fold(stored(events))


def test_a_set_up_that_is_left_takes_its_readings_out_of_the_plan_and_taken_back_leaves_none_to_go_on_from() -> None:
    other = Place("bar", (0.0,), (1,))
    events: list[Event] = [
        CREATED,
        Planned((PLACE, PLAN.places[1], other)),
        QUESTION,
        Skipped("the beam is lost", rest=True),
    ]
    state = fold(stored(events))
    assert (state.plan, state.skipped[0].whole, state.renew) == ((other,), True, True)
    assert decode(*encode(events[-1])) == events[-1]
    assert fold(stored([*events, Undone(4)])).plan == ()


def test_a_skip_is_written_as_before_there_was_leaving() -> None:
    assert encode(Skipped("blocked")) == ("skipped", '{"reason":"blocked"}')


PLACE = Place("laser", (0.0,), (1,))
PLAN = Planned((PLACE, Place("laser", (0.5,), (1,))), "7 rejected")


def test_a_plan_survives_the_record_and_one_of_before_rests_on_nothing() -> None:
    assert decode(*encode(PLAN)) == PLAN
    assert decode("planned", '{"places": []}') == Planned(())


@pytest.mark.parametrize(
    ("events", "renew"),
    [
        ([PLAN, QUESTION, VALUE], False),
        ([PLAN, VALUE], True),
        ([PLAN, QUESTION, Recorded(Reading("laser", (0.1,), (1,), 1e-6))], True),
        ([PLAN, QUESTION, Recorded(Reading("laser", (0.0,), (-1,), 1e-6))], True),
        ([PLAN, QUESTION, Recorded(Reading("ruler", (0.0,), (1,), 1e-6))], True),
        ([PLAN, QUESTION, Skipped("blocked")], True),
        ([PLAN, QUESTION, VALUE, Undone(4)], True),
        ([PLAN, QUESTION, VALUE, Accepted("sign", ("laser",), factor=-1.0)], True),
        ([PLAN, VALUE, PLAN], False),
    ],
)
def test_what_was_not_planned_asks_for_the_plan_to_be_renewed(events: list[Event], renew: bool) -> None:
    state = fold(stored([CREATED, *events]))
    assert state.renew == renew
    assert state.plan_basis == "7 rejected"


def test_half_a_character_is_neither_written_nor_read() -> None:
    for each in (Noted("half \ud800"), Skipped("\udce9", True), Finished("\udfff")):
        with pytest.raises(RecordError, match="half a character"):
            encode(each)
    with pytest.raises(RecordError, match=f'^"{"b" * 36}and'):  # of a long text what stands before it
        encode(Noted("a" * 60 + "b" * 36 + "and\ud800"))
    with pytest.raises(PayloadError, match="cannot be read"):
        decode("noted", r'{"text":"half \ud800"}')
    whole = Noted("whole \U0001f600 \x1b")
    assert decode(*encode(whole)) == whole
