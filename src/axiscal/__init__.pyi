"""Names of the library, as editors and type checkers see them."""

import axiscal_core
from axiscal.campaign.campaign import Campaign as Campaign
from axiscal.description.campaign import read_campaign as read_campaign
from axiscal.machine.description import load_machine as load_machine
from axiscal.measurement.simulation import Simulator as Simulator
from axiscal.python.control_files import export as export
from axiscal.python.curve_pictures import plot as plot
from axiscal.python.curve_pictures import to_xarray as to_xarray
from axiscal.python.own_report import report as report
from axiscal_core import *  # noqa: F403
from axiscal_core.splines import Constant as Constant
from axiscal_core.splines import CyclicSpline as CyclicSpline
from axiscal_core.splines import NaturalSpline as NaturalSpline

__version__: str
__all__ = [
    "Campaign",
    "Constant",
    "CyclicSpline",
    "NaturalSpline",
    "Simulator",
    "export",
    "load_machine",
    "plot",
    "read_campaign",
    "report",
    "to_xarray",
]
__all__ += axiscal_core.__all__
