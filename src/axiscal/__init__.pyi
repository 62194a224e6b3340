"""Names of the library, as editors and type checkers see them."""

from axiscal.campaign.campaign import Campaign as Campaign
from axiscal.description.campaign import read_campaign as read_campaign
from axiscal.errors.model import ErrorModel as ErrorModel
from axiscal.estimation.belief import Belief as Belief
from axiscal.estimation.knowledge import Knowledge as Knowledge
from axiscal.machine.description import load_machine as load_machine
from axiscal.measurement.observation import Observation as Observation
from axiscal.measurement.setup import Setup as Setup
from axiscal.measurement.simulation import Simulator as Simulator
from axiscal.python.estimated import Curve as Curve
from axiscal.python.measured_case import Case as Case
from axiscal.python.measured_case import estimate as estimate
from axiscal.python.measured_case import setup as setup
from axiscal_core.instrument import Instrument as Instrument
from axiscal_core.places import Places as Places
from axiscal_core.places import Readings as Readings
from axiscal_core.splines import Constant as Constant
from axiscal_core.splines import CyclicSpline as CyclicSpline
from axiscal_core.splines import NaturalSpline as NaturalSpline

__version__: str
__all__ = [
    "Belief",
    "Campaign",
    "Case",
    "Constant",
    "Curve",
    "CyclicSpline",
    "ErrorModel",
    "Instrument",
    "Knowledge",
    "NaturalSpline",
    "Observation",
    "Places",
    "Readings",
    "Setup",
    "Simulator",
    "estimate",
    "load_machine",
    "read_campaign",
    "setup",
]
