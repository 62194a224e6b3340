"""Events to and from the JSON text in which the record keeps them; floats survive to the last bit.

The fields of an event are those of its class, except where a table here says how they are written.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, fields
from datetime import datetime
from functools import cache
from typing import Annotated, Any, Literal, get_args

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError, with_config

from axiscal.document.quoting import shown
from axiscal.exceptions import NewerError, RecordError
from axiscal.measurement.reading import Place, Reading
from axiscal.record import events
from axiscal.record.accepted import ABSURD, Size
from axiscal.record.lines import EventText

_BESIDE = ("person", "computer", "step")
"""What stands beside the fields of every kind."""


class PayloadError(ValueError):
    """Text in a record that is not an event."""


def encode(event: events.Event, **by: str) -> tuple[str, str]:
    """Return kind and JSON text; raise ValueError if a number is not finite, RecordError for what is no text.

    by : person, computer and step, as far as they are to be kept
    """
    said = _fields(event) | by
    text = json.dumps(said, allow_nan=False, ensure_ascii=False, separators=(",", ":"), sort_keys=True)
    try:
        text.encode()
    except UnicodeEncodeError as error:  # bytes of an argument may become halves of characters, which no file can hold
        what = "{said} ends in a byte that is no UTF-8, or in half a character"
        remedy = "Type the text anew, or rename the file, on a terminal that writes UTF-8; nothing was kept"
        raise RecordError(what, remedy, said=shown(text[: error.end].rpartition('"')[2][-40:])) from None
    return type(event).__name__.lower(), text


def decode(kind: str, text: str) -> events.Event:
    """Return the event; raise PayloadError if this is none, NewerError for one that this version does not know."""
    try:
        found = json.loads(text)
        beside = {name: found.pop(name, "") for name in _BESIDE}  # older records could not say it
        if not all(isinstance(each, str) for each in beside.values()):
            raise ValueError(f"{beside} are no texts")
        if kind not in _KINDS:
            raise _newer(kind)
        known, needed, reader = _reader(kind)
        if not found.keys() <= known:
            raise _newer(kind)
        if not needed <= found.keys():
            raise ValueError(f"it lacks {', '.join(sorted(needed - found.keys()))}")
        read = reader.validate_json(text)
        event: events.Event = _READ[type(read)](read) if type(read) in _READ else read
        return event
    except ValidationError as error:
        wrong = error.errors(include_url=False)[0]
        where = ".".join(map(str, wrong["loc"]))
        raise PayloadError(f"an entry of kind {kind!r} cannot be read: {where}: {wrong['msg']}") from error
    except (AttributeError, TypeError, ValueError, RecursionError) as error:
        raise PayloadError(f"an entry of kind {kind!r} cannot be read: {error}") from error


def _newer(kind: str) -> NewerError:
    what = "A newer version of axiscal has written an entry here: {kind}"
    return NewerError(what, "Install that version to go on; nothing was changed", kind=shown(kind))


def stored(number: int, row: EventText) -> events.Stored:
    """Return an event of a record; raises PayloadError, also for one without the time at which it was written."""
    event = decode(row.kind, row.payload)
    try:
        timeless = datetime.fromisoformat(row.at).tzinfo is None
    except ValueError:
        timeless = True
    if timeless:
        raise PayloadError(f"{row.at[:40]!r} is no time")
    return events.Stored(number, row.at, event)


def _fields(event: events.Event) -> dict[str, object]:
    """Return what the record keeps of an event."""
    match event:
        case events.Planned():
            return {"places": [_place_fields(place) for place in event.places], "grounds": event.grounds}
        case events.Asked():
            return {"reading": event.reading, **_place_fields(event.place)}
        case events.Recorded(reading):
            of_value = {"value": reading.value, "std": reading.std, "others": reading.others}
            circumstances = {"accepted": reading.accepted, "time": reading.time}
            numbered = {} if reading.number is None else {"reading": reading.number}
            return {**numbered, **_place_fields(reading.place), **of_value, **circumstances}
    return {name: value for name, value in asdict(event).items() if value or name not in _QUIET}


_QUIET = "rest", "last"
"""Written only where they say something, as older versions did not know them."""


def _place_fields(place: Place) -> dict[str, object]:
    drawn = {"check": True} if place.check else {}  # as older versions wrote it where it is none
    return {"setup": place.setup, "position": place.pose, "approach": place.approach, **drawn}


class _Strict(BaseModel):
    model_config = ConfigDict(strict=True, allow_inf_nan=False)


class _At(_Strict):
    setup: str
    position: tuple[float, ...]
    approach: tuple[Literal[-1, 0, 1], ...]  # from where an axis comes; 0 where nobody said
    check: bool = False

    def place(self) -> Place:
        """Return it as the campaign has it; raises ValueError."""
        if len(self.position) != len(self.approach):
            raise ValueError(f"position {self.position} and approach {self.approach} do not belong together")
        return Place(self.setup, self.position, self.approach, check=self.check)


class _Asked(_At):
    reading: int


class _Planned(_Strict):
    places: tuple[_At, ...]
    grounds: str = ""  # plans of older records do not say what they rest on


class _Recorded(_At):
    value: Size
    std: Annotated[float, Field(gt=0, lt=ABSURD)] | None
    others: tuple[Size, ...] = ()
    accepted: bool = False  # this and what follows were not in older records
    time: float | None = None
    reading: int | None = None


def _reading(said: _Recorded) -> Reading:
    at, of_value = said.place(), (said.value, said.std, None, said.accepted, said.others, said.time, said.reading)
    return Reading(at.setup, at.pose, at.approach, *of_value, check=at.check)


_READ: Mapping[type, Callable[[Any], events.Event]] = {
    _Asked: lambda said: events.Asked(said.reading, said.place()),
    _Planned: lambda said: events.Planned(tuple(place.place() for place in said.places), said.grounds),
    _Recorded: lambda said: events.Recorded(_reading(said)),
}
"""Kinds whose fields are written otherwise than those of their class."""
_KINDS = {kind.__name__.lower(): kind for kind in get_args(events.Event)} | {
    kind.__name__.lower()[1:]: kind for kind in _READ
}
"""Classes by the names of their kinds: what the record has, and of `_READ` how it is written."""


@cache
def _reader(name: str) -> tuple[frozenset[str], frozenset[str], TypeAdapter[Any]]:
    """Return the fields of a kind that this version knows, one with others is a newer version's, and what reads it.

    The second are those that even the oldest record has, where the class says something instead.
    """
    kind: Any = _KINDS[name]
    if kind in _READ:
        return frozenset(kind.model_fields), frozenset(), TypeAdapter(kind)
    names = frozenset(field.name for field in fields(kind))
    return names, names - _LATER, TypeAdapter(with_config(_Strict.model_config)(kind))


_LATER = frozenset(("prior_text", "usual_doubts", "fine_knots", "whole_lengths", "rest", "last", "result"))
"""What older records could not say."""
