"""Events to and from the JSON text in which the record keeps them; floats survive to the last bit."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, fields
from typing import Any, TypeVar, get_args

from axiscal.document.quoting import shown
from axiscal.exceptions import RecordError
from axiscal.measurement.reading import Place, Reading
from axiscal.record import events
from axiscal.record.accepted import KNOWN, Accepted, Bumped
from axiscal.record.kept_result import NOT_SAID, KeptResult
from axiscal.record.signing import Hand

_T = TypeVar("_T")
_BESIDE = (*Hand._fields, "step")
"""What stands beside the fields of every kind."""
ABSURD = 1e9
"""m or rad: no number of a reading is as large; what deviates by less is judged by those who know the machine."""


class PayloadError(ValueError):
    """Text in a record that is not an event."""


def encode(event: events.Event, hand: Hand | None = None, step: str = "") -> tuple[str, str]:
    """Return kind and JSON text; raise ValueError if a number is not finite, RecordError for what is no text.

    hand : who writes it, where that is to be kept; step : the id of the step that it belongs to, "" for none
    """
    if isinstance(event, events.Newer):
        return event.kind, event.text
    said = _fields(event) | ({} if hand is None else hand._asdict()) | ({"step": step} if step else {})
    text = json.dumps(said, allow_nan=False, ensure_ascii=False, separators=(",", ":"), sort_keys=True)
    try:
        text.encode()
    except UnicodeEncodeError as error:  # bytes of an argument may become halves of characters, which no file can hold
        what = "{said} ends in a byte that is no UTF-8, or in half a character"
        remedy = "Type the text anew, or rename the file, on a terminal that writes UTF-8; nothing was kept"
        raise RecordError(what, remedy, said=shown(text[: error.end].rpartition('"')[2][-40:])) from None
    return type(event).__name__.lower(), text


def decode(kind: str, text: str) -> events.Event:
    """Return the event, `Newer` for one that this version does not know; raise PayloadError if this is none."""
    try:
        found = _is(dict, json.loads(text))
        beside = {name: _is(str, found.pop(name, "")) for name in _BESIDE}  # older records could not say it
        if kind in _READ and found.keys() <= _KEYS[kind]:
            return _READ[kind](found | beside)
        return events.Newer(kind, text, kind != "noted" if kind in _READ else not _OF_READINGS.isdisjoint(found))
    except (KeyError, TypeError, ValueError, OverflowError, RecursionError) as error:
        raise PayloadError(f"an entry of kind {kind!r} cannot be read: {error}") from error


def hand_of(text: str) -> Hand | None:
    """Return who wrote an event, by its JSON text; None where that does not say it."""
    found = json.loads(text)
    return Hand(*(found[name] for name in Hand._fields)) if found.keys() >= set(Hand._fields) else None


def _fields(event: events.Event) -> dict[str, object]:
    """Return what the record keeps of an event."""
    match event:
        case events.Planned():
            return {"places": [_place_fields(place) for place in event.places], "grounds": event.basis}
        case events.Continued(basis):
            return {"grounds": basis}
        case events.Asked():
            return {"reading": event.reading, **_place_fields(event.place)}
        case events.Recorded(reading):
            of_value = {"value": reading.value, "std": reading.std, "others": reading.others}
            circumstances = {"accepted": reading.accepted, "time": reading.time}
            numbered = {} if reading.number is None else {"reading": reading.number}
            return {**numbered, **_place_fields(reading.place), **of_value, **circumstances}
        case events.Skipped(reason, False):
            return {"reason": reason}  # as older versions wrote it
        case Accepted(last=0):
            return {name: value for name, value in asdict(event).items() if name != "last"}  # nor did they say this
    return {name: value for name, value in asdict(event).items() if name in _KEYS[type(event).__name__.lower()]}


def _place_fields(place: Place) -> dict[str, object]:
    drawn = {"check": True} if place.check else {}  # as older versions wrote it where it is none
    return {"setup": place.setup, "position": place.pose, "approach": place.approach, **drawn}


def _number(value: object, most: float = math.inf) -> float:
    """Return a finite number below a size; raises ValueError."""
    if not isinstance(value, int | float) or isinstance(value, bool) or not abs(value) < most:
        raise ValueError(f"{value!r} is not a finite number that can be read")
    return float(value)


def _is(kind: type[_T], value: object) -> _T:
    """Return a value of JSON that is of a kind; raises ValueError, also for text with half a character."""
    if not isinstance(value, kind) or (kind is int and isinstance(value, bool)):
        raise ValueError(f"{value!r} is no {kind.__name__}")
    if isinstance(value, str):
        value.encode()
    return value


_SIDES = frozenset((-1, 0, 1))
"""From where an axis comes; 0 where nobody said."""


def _place(fields: Mapping[str, Any]) -> Place:
    position = tuple(map(_number, fields["position"]))
    approach = tuple(fields["approach"])
    if len(position) != len(approach) or not all(type(side) is int and side in _SIDES for side in approach):
        raise ValueError(f"position {position} and approach {approach} do not belong together")
    return Place(_is(str, fields["setup"]), position, approach, _is(bool, fields.get("check", False)))


def _created(fields: Mapping[str, Any]) -> events.Created:
    versions = {_is(str, name): _is(str, value) for name, value in _is(dict, fields["versions"]).items()}
    machine, campaign = _is(str, fields["machine_text"]), _is(str, fields["campaign_text"])
    sources = _is(str, fields["machine_source"]), _is(str, fields["campaign_source"])
    names = "usual_doubts", "fine_knots", "whole_lengths"  # not in older ones
    doubts, knots, whole = (_is(bool, fields.get(name, False)) for name in names)
    prior = _is(str, fields.get("prior_text", ""))
    return events.Created(machine, campaign, *sources, versions, prior, doubts, knots, whole, fields["person"])


def _recorded(fields: Mapping[str, Any]) -> events.Recorded:
    std = None if fields["std"] is None else _number(fields["std"], ABSURD)
    if std is not None and std <= 0:
        raise ValueError(f"{std:g} is no standard deviation")
    accepted = _is(bool, fields.get("accepted", False))  # older records could not say it
    others = tuple(_number(value, ABSURD) for value in fields.get("others", ()))
    time = None if fields.get("time") is None else _number(fields["time"])
    number = None if fields.get("reading") is None else _is(int, fields["reading"])
    at, value = _place(fields), _number(fields["value"], ABSURD)
    of_value = value, std, None, accepted, others, time, number
    return events.Recorded(Reading(at.setup, at.pose, at.approach, *of_value, at.check, fields["person"]))


_LARGEST_FACTOR = 1e4
"""Ten times what units differ by that are taken for each other."""


def _accepted(fields: Mapping[str, Any]) -> Accepted:
    mistake, name = _is(str, fields["mistake"]), _is(str, fields["name"])
    setups, factor = tuple(_is(str, each) for each in fields["setups"]), _number(fields["factor"])
    count = max(len(setups), 1) if mistake == "stuck" else 1 + (mistake == "swapped")
    if mistake not in KNOWN or len(setups) != count or len(set(setups)) != len(setups):
        raise ValueError(f"{mistake!r} of {len(setups)} set-ups is no mistake that can be put right")
    if not 1 / _LARGEST_FACTOR < abs(factor) < _LARGEST_FACTOR or (mistake == "shifted" and abs(factor) != 1):
        raise ValueError(f"{factor:g} is no factor of a mistake")
    if bool(name) != (mistake == "jump"):
        raise ValueError("a jump names another set-up, and nothing else does")
    return Accepted(mistake, setups, _is(int, fields["reading"]), factor, name, _is(int, fields.get("last", 0)))


def _finished(fields: Mapping[str, Any]) -> events.Finished:
    said = _is(dict, fields.get("result", asdict(NOT_SAID)))  # older records could not say it
    rms, expanded = (None if said[name] is None else _number(said[name]) for name in ("rms", "expanded"))
    return events.Finished(_is(str, fields["because"]), KeptResult(rms, expanded, _is(str, said["agreement"])))


_READ: Mapping[str, Callable[[Mapping[str, Any]], events.Event]] = {
    "created": _created,
    "planned": lambda fields: events.Planned(
        tuple(_place(place) for place in fields["places"]),
        _is(str, fields.get("grounds", "")),  # plans of older records do not say what they rest on
    ),
    "asked": lambda fields: events.Asked(_is(int, fields["reading"]), _place(fields)),
    "recorded": _recorded,
    "skipped": lambda fields: events.Skipped(_is(str, fields["reason"]), _is(bool, fields.get("rest", False))),
    "noted": lambda fields: events.Noted(_is(str, fields["text"])),
    "warmed": lambda fields: events.Warmed(
        _is(str, fields["setup"]), _number(fields["temperature"]), _is(str, fields["text"])
    ),
    "bumped": lambda fields: Bumped(
        _is(str, fields["controller"]), _number(fields["moved"], ABSURD), _is(str, fields["day"])
    ),
    "continued": lambda fields: events.Continued(_is(str, fields["grounds"])),
    "mounted": lambda fields: events.Mounted(*(_is(str, fields[name]) for name in ("setup", "name", "branch"))),
    "accepted": _accepted,
    "undone": lambda fields: events.Undone(_is(int, fields["event"])),
    "lost": lambda fields: events.Lost(_is(str, fields["why"])),
    "signed": lambda fields: events.Signed(_is(str, fields["key"]), _is(str, fields["signature"])),
    "finished": _finished,
}
_AT = frozenset(("setup", "position", "approach", "check"))
_KEYS: Mapping[str, frozenset[str]] = {
    kind.__name__.lower(): frozenset(field.name for field in fields(kind)) for kind in get_args(events.Event)
} | {
    "created": frozenset(field.name for field in fields(events.Created)) - {"by"},
    "planned": frozenset(("places", "grounds")),
    "continued": frozenset(("grounds",)),
    "asked": _AT | {"reading"},
    "recorded": _AT | {"reading", "value", "std", "others", "accepted", "time"},
}
"""The fields that this version knows of each kind; one with others is a newer version's."""
_OF_READINGS = _AT | {"reading", "readings", "event", "events", "setups", "value", "values"}
"""An unknown kind with one of these fields says something of readings. A kind to come keeps to that."""
