"""axiscal plans, runs and evaluates the calibration of machine tools, and says how good the machine then is.

    import axiscal as ac

    machine = ac.load_machine("three-axis-mill")
    case = ac.Case(machine, [ac.Laser("laser", "X", along="x")])
    plan = case.plan(readings=12)
    known = case.estimate(ac.Readings(plan.places, values))
    ac.export(known, "linuxcnc", "tables")

Every name of `axiscal_core`, the method, is here as well, and is the same object: a `Curve` is one error with its band
and its next reading, a `Case` a machine with instruments on it. Beside them stand:

- `load_machine` reads a machine that is built in, or of a file. Errors are splines (`NaturalSpline`, `CyclicSpline`,
  `Constant`).
- `export`, `report`, `plot` and `to_xarray` make files of a control, a PDF, pictures and arrays of what is known.
- `Campaign` does all of it for a campaign of `read_campaign` and keeps a record; `Simulator` makes virtual machines.

Inside everything is metres, radians and seconds. Names are loaded when they are first used; all others are imported
from where they live.
"""

from importlib import import_module

from axiscal_core import __all__ as _core

__version__ = "0.1.0"

_HOMES = {
    "Campaign": "axiscal.campaign.campaign",
    "Constant": "axiscal_core.splines",
    "CyclicSpline": "axiscal_core.splines",
    "NaturalSpline": "axiscal_core.splines",
    "Simulator": "axiscal.measurement.simulation",
    "export": "axiscal.python.control_files",
    "load_machine": "axiscal.machine.description",
    "plot": "axiscal.python.curve_pictures",
    "read_campaign": "axiscal.description.campaign",
    "report": "axiscal.python.own_report",
    "to_xarray": "axiscal.python.curve_pictures",
}
"""Where names are that are not the core's. `__init__.pyi` says the same to editors and type checkers."""
_GONE = {
    "Belief": "ac.Normal is what is known of numbers: `.read(rows, values, variances)`, `.through(rows)`",
    "Estimated": "ac.Known is what `case.estimate(readings)` returns",
    "Knowledge": "ac.Known is what `case.estimate(readings)` returns",
    "Observation": "`case.shows(places, x)` says what readings show",
    "PlanResult": "ac.Plan is what `case.plan` returns",
    "Setup": "instruments are objects: ac.Laser, ac.Level, ac.BallBar, ac.RTest, ac.Tracker, or a class of your own",
    "best_step": "`case.next()` is the reading that serves most",
    "estimate": "`case.estimate(readings)` takes ac.Readings or a table",
    "setup": "instruments are objects: ac.Laser, ac.Level, ac.BallBar, ac.RTest, ac.Tracker, or a class of your own",
}
"""Names of before, and what to use instead."""
__all__ = [*_HOMES, *_core]


def __getattr__(name: str) -> object:
    if name in _GONE:
        raise AttributeError(f"axiscal.{name} is gone: {_GONE[name]}.")
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    found: object = getattr(import_module(_HOMES.get(name, "axiscal_core")), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted({"__version__", *__all__})
