"""All tables for a SINUMERIK 840D sl, ONE or 828D.

`$AA_ENC_COMP` has no direction: it holds the mean of both, and two `$AN_CEC` tables whose input is their output, one
for each direction, hold what is apart from it. CEC tables with another input hold straightness, sag and squareness.
"""

from __future__ import annotations

import numpy as np

from axiscal.compensation.controllers.sinumerik.notes import notes
from axiscal.compensation.controllers.sinumerik.read_back import multiplied_control, read_all
from axiscal.compensation.controllers.sinumerik.surfaces import product_control, products
from axiscal.compensation.controllers.sinumerik.writing import POINTS as CEC_POINTS
from axiscal.compensation.controllers.sinumerik.writing import axis_names, blocks_of, write
from axiscal.compensation.effect import table_control
from axiscal.compensation.export_options import ExportOptions
from axiscal.compensation.lookup import lookup_control
from axiscal.compensation.offer import Draft
from axiscal.compensation.sampling import axis_tables, cross_tables
from axiscal.compensation.surface import sum_of
from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.units import from_unit

POINTS = 200
"""Points of a table where nothing is said: what an 828D holds for an axis."""
_STEP = 1e-6
"""The grid of positions, m: the decimals that are written."""
_HOLDS = (
    "encoder compensation for every axis (the mean of both directions), and CEC tables for what the directions are "
    "apart, for straightness, sag and squareness."
)
_SURFACES = " What two axes do together: as products of CEC tables."
_LEFT = "errors that depend on two axes at once, the orientation of the tool, and the reversal of straightness."


def make(estimate: Estimate, options: ExportOptions) -> Draft:
    """Return the files; raises TableError."""
    if options.unit != "mm":
        raise TableError("tables for SINUMERIK are written in mm and deg", "leave --unit out, and load them in metric")
    machine, most = estimate.machine, options.points or POINTS
    names = axis_names(machine, options)
    grid = (_STEP, float(np.radians(1e-3)))
    own = axis_tables(estimate, options.spacing, most, grid)
    over = tuple(t.averaged() for t in cross_tables(estimate, options.spacing, most, _STEP))
    whole = options.old.under_tables((*own, *over), machine, max(most, CEC_POINTS), even=True)
    own, over = (tuple(t for t in whole if (t.axis == t.over) is itself) for itself in (True, False))
    together = products(estimate, options, most, _STEP)
    blocks, encoder = blocks_of(own, over, together), options.encoder - 1
    files = write(own, blocks, names, -1.0 if options.flip else 1.0, encoder)
    alone, pairs = read_all(files.values(), names, machine, options.flip)
    held = sum_of(lookup_control(machine, alone), multiplied_control(machine, pairs))
    wanted = sum_of(table_control(machine, (*own, *over)), product_control(machine, together))
    resolution = {axis.name: float(from_unit(4e-6, axis.unit)) for axis in machine.axes}
    said = notes(own, blocks, names, encoder)
    return Draft(
        files, held, wanted, resolution, (*own, *over), _HOLDS + _SURFACES * bool(together), _LEFT, said, tried=False
    )
