"""The harness for any control: a machine is drawn and known, its files are written, tried, and read once more.

Whoever writes for a control tests it with this, as axiscal tests its own.
"""

from __future__ import annotations

import numpy as np

from axiscal.errors.volume import whole_travel
from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.tables.exporter import Exporter, ExportOptions
from axiscal.tables.loaded import OldFile
from axiscal.tables.offer import Export, spread_poses, tried_out
from axiscal_core.machine import Machine
from axiscal_core.normal import Normal

_SURE = 1e-20
"""Variance of every control value of a machine that is known, m² or rad²."""


def drawn_and_known(machine: Machine, seed: int = 1) -> Estimate:
    """Return what somebody believes who knows a machine that was drawn from its description."""
    model = machine
    drawn = np.linalg.cholesky(model.covariance()) @ np.random.default_rng(seed).standard_normal(model.size)
    return Estimate(model, Normal(drawn, _SURE * np.eye(model.size)), whole_travel(model))


def round_trip(control: Exporter, estimate: Estimate, options: ExportOptions | None = None) -> Export:
    """Return the files of a control, tried out and read back as files that are active in it.

    Raises TableError where they would not correct the machine, or where `load` makes something else of them.
    """
    options = options or ExportOptions()
    made = tried_out(type(control).__name__, estimate, control.make(estimate, options))
    files = [OldFile(name, text) for name, text in made.files.items()]
    loaded = control.load(files, estimate.machine, options).control(estimate.machine)
    poses, ways = spread_poses(estimate)
    apart = float(np.max(np.abs(loaded(poses, ways) - made.control(poses, ways))))
    if not apart <= 1e-9:
        what = "loaded as files that were active, they move an axis by {apart:.3g} m or rad more or less"
        raise TableError(what, "let load read all that write writes", apart=apart)
    return made
