"""Folding events: against a twin that tells the story anew without what was taken back."""

import json

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from axiscal.exceptions import RecordError
from axiscal.measurement.reading import Place, Reading
from axiscal.record.accepted import Accepted, Bumped, put_right
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
event = recorded | asked | skipped | noted | bumped | mounted | accepted | finished | continued


few, spots = st.sampled_from(["laser", "bar"]), st.sampled_from([(0.0, 1.0), (0.5, 1.0)])
here = st.builds(Place, few, spots, st.just((1, -1)))
often = (
    st.builds(Recorded, st.builds(Reading, few, spots, st.just((1, -1)), numbers, st.none() | st.just(1e-6))),
    st.builds(Asked, st.integers(1, 9), here),
    st.builds(Planned, st.lists(here, max_size=4, unique=True).map(tuple), st.text()),
    st.builds(Undone, st.sampled_from([0, 0, 0, 0, 1])),
)
seldom = (
    st.builds(Accepted, st.just("jump"), st.tuples(few), st.integers(1, 9), name=st.sampled_from(["before", "then"])),
    st.builds(Accepted, st.just("sign"), st.tuples(few), st.integers(0, 9), st.just(-1.0), last=st.integers(0, 9)),
    st.builds(Accepted, st.just("backlash"), st.tuples(few), st.integers(1, 9)),
    st.builds(Accepted, st.just("shifted"), st.tuples(few), factor=st.sampled_from([1.0, -1.0])),
    st.just(Accepted("swapped", ("laser", "bar"))),
    *(noted, bumped, continued, finished, st.just(CREATED)),
)
happening = st.one_of(*often, *often, *often, st.builds(Skipped, st.text()), *seldom)
"""What a small campaign may see; `Undone` says by how much its number is wrong."""
DONE = Recorded | Skipped | Accepted | Finished
Story = list[tuple[int, Event]]


def with_one_more(story: Story, number: int, event: Event) -> Story:
    """Return a story without what is taken back, and what was asked since; raises ValueError where that cannot be."""
    if isinstance(event, Undone):
        at = max((k for k, (_, each) in enumerate(story) if isinstance(each, DONE)), default=-1)
        if at < 0 or story[at][0] != event.event:
            raise ValueError("not the last")
        story = story[:at] + [each for each in story[at + 1 :] if not isinstance(each[1], Asked)]
    return [*story, (number, event)]


def told(story: Story) -> dict[str, object]:
    """Return what a story comes to in which nothing is taken back any more; raises ValueError where it cannot be."""
    readings, plan, highest, names = list[Reading](), list[Place](), 0, set[str]()
    asked, renew, because, goes_on = None, False, None, None
    for place_in_story, (_, each) in enumerate(story):
        if isinstance(each, Created) is (place_in_story > 0) or (
            because is not None and not isinstance(each, Noted | Bumped | Undone)
        ):
            raise ValueError("out of order")
        if not isinstance(each, Planned | Asked | Noted | Bumped):
            goes_on = each.grounds if isinstance(each, Continued) else None
        if isinstance(each, Planned):
            plan, renew = [*each.places], False
        elif isinstance(each, Asked):
            asked, plan = each, plan[plan[:1] == [each.place] :]
        elif isinstance(each, Accepted):
            if each.name in names or (each.mistake == "jump" and each.reading > highest + 1):
                raise ValueError("no such jump")
            readings, names, renew = put_right(readings, each), names | ({each.name} - {""}), True
        elif isinstance(each, Recorded | Skipped):
            number = asked.reading if asked else highest + 1
            if isinstance(each, Recorded):
                readings.append(each.reading.under(number))
                renew |= asked is None or asked.place != each.reading.place
            elif asked is None:
                raise ValueError("nobody asked")
            else:
                of = asked.place
                plan, renew = [p for p in plan if (p.setup, p.pose) != (of.setup, of.pose)], True
            highest, asked = max(highest, number), None
        elif isinstance(each, Finished):
            because, asked = each.because, None
        renew |= isinstance(each, Undone)
    whole = {"readings": tuple(readings), "plan": tuple(plan), "pending": asked, "free": highest + 1}
    return {**whole, "renew": renew, "finished": because, "continued": goes_on}


SPOTS = Place("laser", (0.0, 1.0), (1, -1)), Place("laser", (0.5, 1.0), (1, -1)), Place("bar", (0.0, 1.0), (1, -1))
TAKEN = Recorded(Reading("laser", (0.0, 1.0), (1, -1), 1e-6))
BEGUN: list[Event] = [Planned(SPOTS), Asked(1, SPOTS[0]), TAKEN, Asked(2, SPOTS[1])]


@example([*BEGUN, Undone(0)])
@example([*BEGUN, Skipped("the beam is lost"), Undone(0), Undone(0)])
@example([*BEGUN, TAKEN, Accepted("sign", ("laser",), 0, -1.0), Finished("done"), TAKEN, Undone(0), Undone(0)])
@given(st.lists(happening, max_size=30))
def test_a_story_is_folded_as_it_is_told_without_what_was_taken_back(drawn: list[Event]) -> None:
    """What cannot follow is refused."""
    story, state, number = Story(), State(), 1
    for each in [CREATED, *drawn]:
        event = each
        if isinstance(event, Asked | Planned) and state.pending is not None:
            continue  # whoever has asked plans and asks nothing until that is answered
        if isinstance(event, Asked) and state.plan:
            event = Asked(event.reading, state.plan[0])
        if isinstance(event, Undone):
            event = Undone(event.event + (state.undo[-1].number if state.undo else 0))
        try:
            longer = with_one_more(story, number, event)
            expected = told(longer)
        except ValueError:
            with pytest.raises(EventOrderError):
                fold([Stored(number, "", event)], state)
            continue
        state = fold([Stored(number, "", event)], state)
        story, number = longer, number + 1
        assert {name: getattr(state, name) for name in expected} == expected
        assert [step.number for step in state.undo] == [n for n, one in story if isinstance(one, DONE)]


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


def test_a_set_up_that_is_left_takes_its_readings_out_of_the_plan_and_taken_back_leaves_none_to_go_on_from() -> None:
    left = Skipped("the beam is lost", rest=True)
    state = fold(Stored(number, "", each) for number, each in enumerate((CREATED, *BEGUN, left), 1))
    assert (state.plan, state.skipped[0].whole, state.renew) == ((SPOTS[2],), True, True)
    assert fold([Stored(7, "", Undone(6))], state).plan == ()


def test_a_skip_is_written_as_before_there_was_leaving() -> None:
    assert encode(Skipped("blocked")) == ("skipped", '{"reason":"blocked"}')


PLACE = Place("laser", (0.0,), (1,))
PLAN = Planned((PLACE, Place("laser", (0.5,), (1,))), "7 rejected")


def test_a_plan_survives_the_record_and_one_of_before_rests_on_nothing() -> None:
    assert decode(*encode(PLAN)) == PLAN
    assert decode("planned", '{"places": []}') == Planned(())


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
