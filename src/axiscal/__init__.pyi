"""Names of the library, as editors and type checkers see them."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, Self, overload

from axiscal.campaign.campaign import Campaign as Campaign
from axiscal.description.campaign import read_campaign as read_campaign
from axiscal.estimation.belief import Belief as Belief
from axiscal.estimation.knowledge import Knowledge as Knowledge
from axiscal.machine.description import DescribedMachine as _Machine
from axiscal.machine.description import load_machine as load_machine
from axiscal.measurement.observation import Observation as Observation
from axiscal.measurement.setup import Setup as Setup
from axiscal.measurement.simulation import Simulator as Simulator
from axiscal.python.estimated import Curve as Curve
from axiscal.python.estimated import Estimated
from axiscal.python.given import GivenReadings
from axiscal.python.given import setup as setup
from axiscal.python.measured_case import Case as _Case
from axiscal.python.own_report import report as report
from axiscal_core import Array as Array
from axiscal_core import At as At
from axiscal_core import Axis as Axis
from axiscal_core import BallBar as BallBar
from axiscal_core import Basis as Basis
from axiscal_core import Case as _OwnCase
from axiscal_core import Error as Error
from axiscal_core import Evaluation as Evaluation
from axiscal_core import InputError as InputError
from axiscal_core import Instrument as Instrument
from axiscal_core import Known as Known
from axiscal_core import Laser as Laser
from axiscal_core import Level as Level
from axiscal_core import Machine as Machine
from axiscal_core import Mounting as Mounting
from axiscal_core import Normal as Normal
from axiscal_core import Offset as Offset
from axiscal_core import Places as Places
from axiscal_core import Plan as Plan
from axiscal_core import Readings as Readings
from axiscal_core import RTest as RTest
from axiscal_core import Tracker as Tracker
from axiscal_core import Unknowns as Unknowns
from axiscal_core import angle as angle
from axiscal_core import cross as cross
from axiscal_core import length as length
from axiscal_core.splines import Constant as Constant
from axiscal_core.splines import CyclicSpline as CyclicSpline
from axiscal_core.splines import NaturalSpline as NaturalSpline

__version__: str

class Case(_Case):
    """The case of a machine of `load_machine`; one of a machine that is made in Python is the core's."""

    @overload
    def __new__(  # type: ignore[overload-overlap]
        cls,
        machine: _Machine,
        setups: Sequence[Mapping[str, Any] | Instrument],
        target: Mapping[str, Any] | None = None,
        learn: bool = False,
        *,
        usual: Literal["on", "off"] = "on",
        sure: Literal["exactly", "well", "roughly"] | None = None,
    ) -> Self: ...
    @overload
    def __new__(  # type: ignore[misc]
        cls,
        machine: Machine,
        setups: Sequence[Instrument],
        *,
        usual: Literal["on", "off"] = "on",
        sure: Literal["exactly", "well", "roughly"] = "well",
        aligned: bool = True,
    ) -> _OwnCase: ...

@overload
def estimate(campaign: _OwnCase, readings: Readings | Mapping[str, Sequence[object]]) -> Known: ...
@overload
def estimate(campaign: _Case | str | Path, readings: GivenReadings) -> Estimated:
    """Return what readings make known of a machine."""

__all__ = [
    "Axis",
    "Belief",
    "Campaign",
    "Case",
    "Constant",
    "Curve",
    "CyclicSpline",
    "Error",
    "Instrument",
    "Machine",
    "NaturalSpline",
    "Places",
    "Readings",
    "Simulator",
    "estimate",
    "load_machine",
    "read_campaign",
    "report",
    "setup",
]
