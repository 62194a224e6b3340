"""What no reading shows, in words; see `description.type_b`."""

from __future__ import annotations

from axiscal.language.spoken import later, said

_CAUSES = {
    "scale": later("Scale of the {owner}"),
    "air": later("Refraction of air"),
    "cosine": later("Beam aslant"),
    "dead_path": later("Dead path in air"),
    "temperature": later("Temperature of the measured material"),
    "expansion": later("Expansion of the measured material"),
    "length": later("Length of the ball bar"),
    "square": later("Angle of the straightedge as a square"),
    "bow": later("Bow of the straightedge"),
    "gain": later("Gain of the {owner}"),
    "radius": later("Radius of ball and stylus"),
    "pre_travel": later("Pre-travel of the probe"),
}


def cause_words(name: str, owner: str) -> str:
    """Return a cause in words.  name : of its row; owner : the instrument or set-up that it belongs to, if any"""
    return said(_CAUSES[name], owner=said(owner) if owner else "")
