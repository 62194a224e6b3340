"""Names of the core, as editors and type checkers see them."""

from axiscal_core.axes import Axis as Axis
from axiscal_core.case import Case as Case
from axiscal_core.curve import Curve as Curve
from axiscal_core.errors import Basis as Basis
from axiscal_core.errors import Error as Error
from axiscal_core.errors import Offset as Offset
from axiscal_core.instrument import At as At
from axiscal_core.instrument import Instrument as Instrument
from axiscal_core.instrument import Mounting as Mounting
from axiscal_core.instrument import Unknowns as Unknowns
from axiscal_core.instrument import angle as angle
from axiscal_core.instrument import length as length
from axiscal_core.instruments import BallBar as BallBar
from axiscal_core.instruments import Laser as Laser
from axiscal_core.instruments import Level as Level
from axiscal_core.instruments import RTest as RTest
from axiscal_core.instruments import Tracker as Tracker
from axiscal_core.known import Known as Known
from axiscal_core.machine import Machine as Machine
from axiscal_core.normal import Normal as Normal
from axiscal_core.places import Places as Places
from axiscal_core.places import Readings as Readings
from axiscal_core.plan import Evaluation as Evaluation
from axiscal_core.plan import Plan as Plan
from axiscal_core.refusals import Array as Array
from axiscal_core.refusals import InputError as InputError
from axiscal_core.rigid import cross as cross
from axiscal_core.splines import spacing_limit as spacing_limit

__all__ = [
    "Array", "At", "Axis", "BallBar", "Basis", "Case", "Curve", "Error", "Evaluation", "InputError", "Instrument",
    "Known", "Laser", "Level", "Machine", "Mounting", "Normal", "Offset", "Places", "Plan", "RTest",
    "Readings", "Tracker", "Unknowns", "angle", "cross", "length", "spacing_limit",
]  # fmt: skip
