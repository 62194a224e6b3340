"""axiscal plans, runs and evaluates the calibration of machine tools, and says how good the machine then is.

    import axiscal as ac

    machine = ac.load_machine("three-axis-mill")
    case = ac.Case(machine, [ac.setup("interferometer", "x", moves=["X"])])
    plan = case.plan(readings=12)
    known = ac.estimate(case, "readings.csv")

`Curve` is one error with its band and its next reading. A `Case` is a machine with what `setup` makes of instruments,
or with an `Instrument` of one's own. It plans, judges `Places` of one's own, and goes on after `Readings`. `estimate`
takes readings to curves, deviations and tables. For whoever builds on the method:

- `load_machine` reads a machine. Its errors are splines (`NaturalSpline`, `CyclicSpline`, `Constant`). A `Machine` of
  one's own has each `Axis` and `Error` in Python: its case is the core's; see `report`.
- A `Belief` is what is known of them.
- `Case.next` is the reading that sharpens it most.

`Campaign` does all of it and keeps a record; `Simulator` makes virtual machines to try it on. Inside everything
is metres, radians and seconds. The names below are loaded when they are first used; all others are imported from where
they live, those of `axiscal_core` from here, too.
"""

from importlib import import_module
from warnings import warn

__version__ = "0.1.0"

_HOMES = {
    "Axis": "axiscal_core",
    "Belief": "axiscal.estimation.belief",
    "Campaign": "axiscal.campaign.campaign",
    "Case": "axiscal.python.measured_case",
    "Constant": "axiscal_core.splines",
    "Curve": "axiscal.python.estimated",
    "CyclicSpline": "axiscal_core.splines",
    "Error": "axiscal_core",
    "Instrument": "axiscal_core",
    "Machine": "axiscal_core",
    "NaturalSpline": "axiscal_core.splines",
    "Places": "axiscal_core",
    "Readings": "axiscal_core",
    "Simulator": "axiscal.measurement.simulation",
    "estimate": "axiscal.python.measured_case",
    "load_machine": "axiscal.machine.description",
    "read_campaign": "axiscal.description.campaign",
    "report": "axiscal.python.own_report",
    "setup": "axiscal.python.given",
}
"""Where the names are. `__init__.pyi` says the same to editors and type checkers, which cannot look in here."""
_LEAVING = {
    "Knowledge": ("axiscal.estimation.knowledge", "what `estimate` returns"),
    "Observation": ("axiscal.measurement.observation", "`Case.shows`"),
    "Setup": ("axiscal.measurement.setup", "`setup`"),
    "best_step": ("axiscal_core.step", "`Case.next`"),
}
"""Names that stay importable for one more version, and what to use instead."""
__all__ = [*_HOMES]


def __getattr__(name: str) -> object:
    """Return a name of the library; those that it has not are the core's: instruments, `length`, `InputError`."""
    if name in _LEAVING:
        home, instead = _LEAVING[name]
        warn(f"axiscal.{name} leaves: use {instead}", DeprecationWarning, stacklevel=2)
        return getattr(import_module(home), name)
    if name.startswith("_") or name not in (*_HOMES, *import_module("axiscal_core").__all__):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    found: object = getattr(import_module(_HOMES.get(name, "axiscal_core")), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted({"__version__", *_HOMES, *import_module("axiscal_core").__all__})
