"""axiscal plans, runs and evaluates the calibration of machine tools, and says how good the machine then is.

    import axiscal as ac

A machine is described (`load_machine`), its errors are splines (`NaturalSpline`, `CyclicSpline`, `Constant`, stacked by
`ErrorModel`), an instrument sees linear combinations of them (`Setup`, `Observation`), a `Belief` is what is known of
them, `Knowledge` both together, which readings sharpen, and `best_step` is the reading that would sharpen it most.
`Campaign` does all of it and keeps a record; `Simulator` makes virtual machines to try it on. Inside everything
is metres, radians and seconds. The names below are loaded when they are first used; all others are imported from where
they live.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from axiscal.belief import Belief
    from axiscal.campaign.campaign import Campaign
    from axiscal.description.campaign import read_campaign
    from axiscal.design.step.best_step import best_step
    from axiscal.error_model.model import ErrorModel
    from axiscal.estimation.knowledge import Knowledge
    from axiscal.machine.description import load_machine
    from axiscal.measurement.observation import Observation
    from axiscal.measurement.setup import Setup
    from axiscal.numerics.cubic import Constant, CyclicSpline, NaturalSpline
    from axiscal.simulation import Simulator

__version__ = "0.1.0"

__all__ = [
    "Belief",
    "Campaign",
    "Constant",
    "CyclicSpline",
    "ErrorModel",
    "Knowledge",
    "NaturalSpline",
    "Observation",
    "Setup",
    "Simulator",
    "best_step",
    "load_machine",
    "read_campaign",
]

_HOMES = {
    "Belief": "belief",
    "Campaign": "campaign.campaign",
    "Constant": "numerics.cubic",
    "CyclicSpline": "numerics.cubic",
    "ErrorModel": "error_model.model",
    "Knowledge": "estimation.knowledge",
    "NaturalSpline": "numerics.cubic",
    "Observation": "measurement.observation",
    "Setup": "measurement.setup",
    "Simulator": "simulation",
    "best_step": "design.step.best_step",
    "load_machine": "machine.description",
    "read_campaign": "description.campaign",
}


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    found: object = getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted([*globals(), *_HOMES])
