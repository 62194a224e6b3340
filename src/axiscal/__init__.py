"""axiscal plans, runs and evaluates the calibration of machine tools, and says how good the machine then is.

    import axiscal as ac

    machine = ac.load_machine("three-axis-mill")
    case = ac.Case(machine, [ac.setup("interferometer", "x", moves=["X"])])
    plan = case.plan(readings=12)
    known = ac.estimate(case, "readings.csv")

`Curve` is one error with its band and its next reading. A `Case` is a machine with what `setup` makes of instruments,
or of an `Instrument` of one's own. It plans, judges `Places` of one's own, and goes on after `Readings`. `estimate`
takes readings to curves, deviations and tables. For whoever builds on the method:

- `load_machine` reads a machine. Its errors are splines (`NaturalSpline`, `CyclicSpline`, `Constant`), stacked by
  `ErrorModel`.
- An instrument sees linear combinations of them (`Setup`, `Observation`).
- A `Belief` is what is known of them. `Knowledge` is both together, and readings sharpen it.
- `axiscal_core.Case.next` is the reading that would sharpen it most.

`Campaign` does all of it and keeps a record; `Simulator` makes virtual machines to try it on. Inside everything
is metres, radians and seconds. The names below are loaded when they are first used; all others are imported from where
they live.
"""

from importlib import import_module

__version__ = "0.1.0"

_HOMES = {
    "Belief": "axiscal.estimation.belief",
    "Campaign": "axiscal.campaign.campaign",
    "Case": "axiscal.python.measured_case",
    "Constant": "axiscal_core.splines",
    "Curve": "axiscal.python.estimated",
    "CyclicSpline": "axiscal_core.splines",
    "ErrorModel": "axiscal.errors.model",
    "Instrument": "axiscal_core.instrument",
    "Knowledge": "axiscal.estimation.knowledge",
    "NaturalSpline": "axiscal_core.splines",
    "Observation": "axiscal.measurement.observation",
    "Places": "axiscal_core.places",
    "Readings": "axiscal_core.places",
    "Setup": "axiscal.measurement.setup",
    "Simulator": "axiscal.measurement.simulation",
    "estimate": "axiscal.python.measured_case",
    "load_machine": "axiscal.machine.description",
    "read_campaign": "axiscal.description.campaign",
    "setup": "axiscal.python.measured_case",
}
"""Where the names are. `__init__.pyi` says the same to editors and type checkers, which cannot look in here."""
__all__ = [*_HOMES]


def __getattr__(name: str) -> object:
    if name == "best_step":
        return _best_step()
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    found: object = getattr(import_module(_HOMES[name]), name)
    globals()[name] = found
    return found


def _best_step() -> object:
    """Return the exact step of the core, which has the name for one more version."""
    from warnings import warn

    from axiscal_core import Case as Core

    warn("axiscal.best_step is axiscal_core.Case.next, which takes a case", DeprecationWarning, stacklevel=3)
    return Core.next


def __dir__() -> list[str]:
    return sorted([*globals(), *_HOMES])
