"""Events to and from the JSON text in which the record keeps them; floats survive to the last bit.

The fields of an event are those of its class; those of the place or the reading that it wraps stand beside them.
"""

from __future__ import annotations

import json
from dataclasses import fields
from datetime import datetime
from functools import cache
from typing import Any, get_args

from pydantic import TypeAdapter, ValidationError, with_config

from axiscal.document.quoting import shown
from axiscal.exceptions import NewerError, RecordError
from axiscal.measurement.reading import KEPT_AS, Place
from axiscal.record import events
from axiscal.record.lines import EventText

_BESIDE = ("person", "computer", "step")
"""What stands beside the fields of every kind."""


class PayloadError(ValueError):
    """Text in a record that is not an event."""


def encode(event: events.Event, **by: str) -> tuple[str, str]:
    """Return kind and JSON text; raise ValueError if a number is not finite, RecordError for what is no text.

    by : person, computer and step, as far as they are to be kept
    """
    text = as_text(_told(event) | by)
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
        if kind in _KINDS and (lacking := sorted(_needed(kind) - found.keys())):
            raise ValueError(f"it lacks {', '.join(lacking)}")
        if kind == "recorded":
            found = {"reading": found}
        if kind == "asked":
            found = {"reading": found.pop("reading"), "place": found}
        event: events.Event = _reader(kind).validate_json(json.dumps(found))
        return event
    except ValidationError as error:
        wrong = error.errors(include_url=False)
        if any(each["type"] == "unexpected_keyword_argument" for each in wrong):
            raise _newer(kind) from None
        where = ".".join(map(str, wrong[0]["loc"])).removeprefix("reading.").removeprefix("place.")
        raise PayloadError(f"an entry of kind {kind!r} cannot be read: {where}: {wrong[0]['msg']}") from error
    except (AttributeError, KeyError, TypeError, ValueError, RecursionError) as error:
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


_QUIET = "rest", "last", "check", "number"
"""Written only where they say something, as older versions did not know them."""


def _told(each: Any) -> dict[str, Any]:
    """Return what the record keeps of an event, or of what it holds; raises TypeError for what is neither."""
    found = dict[str, Any]()
    for field in fields(each):
        value = getattr(each, field.name)
        if isinstance(value, Place):  # a reading is one
            found |= _told(value)
        elif field.name != "line" and (value or field.name not in _QUIET):
            found[KEPT_AS.get(field.name, field.name)] = value
    return found


as_text = json.JSONEncoder(
    ensure_ascii=False, allow_nan=False, sort_keys=True, separators=(",", ":"), default=_told
).encode
"""Events and what stands beside them as JSON: one text for what is the same."""
_KINDS: dict[str, Any] = {kind.__name__.lower(): kind for kind in get_args(events.Event)}


_AT = {"setup", "position", "approach"}
_WRAPPED = {"recorded": _AT | {"value", "std"}, "asked": _AT | {"reading"}}
_LATER = {"prior_text", "usual_doubts", "fine_knots", "whole_lengths", "rest", "last", "result", "grounds"}
"""What older records could not say."""


def _needed(kind: str) -> set[str]:
    """Return the fields that even the oldest record has, where the class says something instead."""
    return _WRAPPED.get(kind) or {field.name for field in fields(_KINDS[kind])} - _LATER


@cache
def _reader(kind: str) -> TypeAdapter[Any]:
    """Return what reads a kind: strictly, and with no field that this version does not know."""
    if kind not in _KINDS:
        raise _newer(kind)
    return TypeAdapter(with_config(strict=True, extra="forbid", allow_inf_nan=False)(_KINDS[kind]))
