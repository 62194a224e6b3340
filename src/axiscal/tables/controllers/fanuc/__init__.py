"""FANUC: stored pitch error compensation, in a file that the user's own control has punched.

`records` knows the form of the file, `plan` what its parameters say of an axis, `data` the entries of the points.
"""

from axiscal.tables.controllers.fanuc.exporting import Increments, fill, increments, read
from axiscal.tables.controllers.fanuc.pitch import PitchParameters, read_plans

__all__ = ["Increments", "PitchParameters", "fill", "increments", "read", "read_plans"]
