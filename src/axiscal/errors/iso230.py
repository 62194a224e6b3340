"""ISO 230-1 and ISO 230-7 names of geometric errors, said in the words of a workshop."""

from __future__ import annotations

from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import WORDS, later, said
from axiscal.machine.axis import ROTARY_LETTERS, letter_direction
from axiscal.machine.error_names import error_named, shape_of

_WORDS = WORDS["errors"]
_PITCH = ("y", "x", "x")
"""About which the pitch of a linear axis along x, y or z turns; about the third way it yaws."""


def words(name: str) -> str:
    """Return an error name in plain words; a name of no known form, or of a stated shape, is returned as it is.

    name : `EXX`, `C0Y`, `EXX_reversal`, `EZXY`; axis names may carry a digit (`EXX2`)
    """
    try:
        parts = error_named(name)
    except DescriptionError:
        return name
    if parts.sides:
        turn = later("turn about {way} that {first} and {second} make together")
        shift = later("displacement in {way} that {first} and {second} make together")
        way = "xyz"[parts.component % 3]
        return said(turn if parts.angular else shift, way=way, first=parts.axes[0], second=parts.axes[1])
    axis, turns, along = parts.axis, parts.axis[0] in ROTARY_LETTERS, letter_direction(parts.axis[0])
    own, way = parts.component % 3 == along, "xyz"[parts.component % 3]
    if parts.kind == "reversal":
        if own and parts.angular == turns:
            return said("reversal of {axis}", axis=axis)
        return said("reversal in the {motion}", motion=words(parts.bare))
    if shape_of(parts) != "curve":
        return name
    text = _WORDS[parts.kind]["rotary" if turns else "linear"][2 * parts.angular + (not own)]
    if parts.kind == "motion" and parts.angular and way == _PITCH[along] and not (own or turns):
        text = later("pitch of {axis}")
    return said(text, axis=axis, way=way, reference="XYZ"[3 - along - parts.component % 3] if not own else "")
