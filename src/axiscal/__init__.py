"""axiscal plans, runs and evaluates the calibration of machine tools, and says how good the machine then is.

    import axiscal as ac

    machine = ac.load_machine("three-axis-mill")
    case = ac.Case(machine, [ac.setup("interferometer", "x", moves=["X"])])
    plan = case.plan(readings=12)
    known = ac.estimate(case, "readings.csv")

`Curve` is one error with its band and its next reading; a `Case` is a machine with what `setup` makes of instruments,
and plans; `estimate` takes readings to curves, deviations and tables. Below them, for whoever builds on the method: a
machine is described (`load_machine`), its errors are splines (`NaturalSpline`, `CyclicSpline`, `Constant`, stacked by
`ErrorModel`), an instrument sees linear combinations of them (`Setup`, `Observation`), a `Belief` is what is known of
them, `Knowledge` both together, which readings sharpen, and `best_step` is the reading that would sharpen it most.
`Campaign` does all of it and keeps a record; `Simulator` makes virtual machines to try it on. Inside everything
is metres, radians and seconds. The names below are loaded when they are first used; all others are imported from where
they live.
"""

from importlib import import_module

TYPE_CHECKING = False  # not from typing: while that is loaded, before any of our code runs, Ctrl-C ends in a traceback
if TYPE_CHECKING:
    from axiscal.belief import Belief
    from axiscal.campaign.campaign import Campaign
    from axiscal.description.campaign import read_campaign
    from axiscal.design.step.best_step import best_step
    from axiscal.error_model.model import ErrorModel
    from axiscal.estimation.knowledge import Knowledge
    from axiscal.library.curve import Curve
    from axiscal.library.estimated import estimate
    from axiscal.library.measured_case import Case
    from axiscal.library.setup_keys import setup
    from axiscal.machine.description import load_machine
    from axiscal.measurement.observation import Observation
    from axiscal.measurement.setup import Setup
    from axiscal.numerics.cubic import Constant, CyclicSpline, NaturalSpline
    from axiscal.simulation import Simulator

__version__ = "0.1.0"

__all__ = [
    "Belief",
    "Campaign",
    "Case",
    "Constant",
    "Curve",
    "CyclicSpline",
    "ErrorModel",
    "Knowledge",
    "NaturalSpline",
    "Observation",
    "Setup",
    "Simulator",
    "best_step",
    "estimate",
    "load_machine",
    "read_campaign",
    "setup",
]

_HOMES = {
    "Belief": "belief",
    "Campaign": "campaign.campaign",
    "Case": "library.measured_case",
    "Constant": "numerics.cubic",
    "Curve": "library.curve",
    "CyclicSpline": "numerics.cubic",
    "ErrorModel": "error_model.model",
    "Knowledge": "estimation.knowledge",
    "NaturalSpline": "numerics.cubic",
    "Observation": "measurement.observation",
    "Setup": "measurement.setup",
    "Simulator": "simulation",
    "best_step": "design.step.best_step",
    "estimate": "library.estimated",
    "load_machine": "machine.description",
    "read_campaign": "description.campaign",
    "setup": "library.setup_keys",
}


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    found: object = getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted([*globals(), *_HOMES])
