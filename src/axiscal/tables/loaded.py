"""What a control has loaded, and what it adds to commands for it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np

from axiscal.numerics import Array
from axiscal.tables.surface import Control, Mesh, Skew, mesh_control, skew_control, sum_of
from axiscal.tables.table import CompensationTable
from axiscal.tables.volumetric import SampledError, tip_control
from axiscal_core.machine import Machine


def table_control(machine: Machine, tables: Iterable[CompensationTable]) -> Control:
    """Return the control that takes the deviations of tables away exactly as they say."""
    known = [(machine.index(table.axis), machine.index(table.over), table) for table in tables]

    def control(poses: Array, approaches: Array) -> Array:
        added = np.zeros_like(poses)
        for axis, over, table in known:
            added[:, axis] -= table.deviation(poses[:, over], approaches[:, over])
        return added

    return control


def lost_motion(machine: Machine, play: Mapping[str, float]) -> tuple[CompensationTable, ...]:
    """Return the tables that make up for what axes lose as they turn round, m or rad, half of it to each side."""
    travels = [(axis, np.array(machine.axis(axis).travel), np.full(2, lost / 2)) for axis, lost in play.items()]
    return tuple(CompensationTable(axis, ends, -half, half) for axis, ends, half in travels)


@dataclass(frozen=True, eq=False, slots=True)
class Loaded:
    """A compensation as its control understood it.

    tables : what it takes away; meshes : height maps; skew : tangents by plane, as set
    errors : by name, to a control that knows the chain; others : what does more than that
    """

    tables: tuple[CompensationTable, ...] = ()
    meshes: tuple[Mesh, ...] = ()
    skew: Skew = field(default_factory=dict)
    errors: Mapping[str, SampledError] = field(default_factory=dict)
    others: tuple[Control, ...] = ()

    def control(self, machine: Machine) -> Control:
        """Return what it adds to commands."""
        parts = [table_control(machine, self.tables), *self.others]
        parts += [mesh_control(machine, mesh) for mesh in self.meshes]
        parts += [tip_control(machine, self.errors)] if self.errors else []
        return sum_of(*parts, *([skew_control(machine, self.skew)] if self.skew else []))
