"""The method: where to read a machine, and what the readings make known of it.

    >>> import numpy as np, axiscal_core as ac
    >>> axes = [ac.Axis.linear(name, name.lower(), (0, "500 mm")) for name in "XYZ"]
    >>> errors = [ac.Error(f"E{c}{name}", "8 um", length="150 mm") for name in "XYZ" for c in "XYZ"]
    >>> lasers = [ac.Laser(f"laser {name}", name, along=name.lower()) for name in "XYZ"]
    >>> case = ac.Case(ac.Machine(axes, errors), lasers)
    >>> plan = case.plan(readings=12)
    >>> known = case.estimate(ac.Readings.simulated(case, plan.places, seed=1))
    >>> known.deviation([["100 mm", "200 mm", "300 mm"]]).mean.shape
    (1, 3)

A machine is a chain of axes whose errors are splines of few control values (B&H section III). An instrument sees a
linear combination of them. So what is known is a normal, readings sharpen it, and where to read next can be computed
before anything is read (section IV). Numbers are in m, rad and s; a text carries its unit.
"""

from importlib import import_module

__all__ = [
    "Array", "At", "Axis", "BallBar", "Basis", "Case", "Curve", "Error", "Evaluation", "InputError", "Instrument",
    "Known", "Laser", "Level", "Machine", "Mounting", "Normal", "Offset", "Places", "Plan", "RTest",
    "Readings", "Tracker", "Unknowns", "angle", "cross", "length", "spacing_limit",
]  # fmt: skip

_FILES = (
    "axes", "case", "curve", "errors", "instrument", "instruments", "known", "machine", "normal", "places", "plan",
    "refusals", "rigid", "splines",
)  # fmt: skip
"""Where the names are: who wants one file of them, as the product does, need not load them all."""


def __getattr__(name: str) -> object:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    for file in _FILES:
        found = vars(import_module(f"{__name__}.{file}"))
        globals().update({each: found[each] for each in __all__ if each in found})
    return globals()[name]


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
