"""A machine that is known to the last digit, what is exported for it, and what a control that has the files leaves."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from axiscal.estimation.machine_estimate import Estimate
from axiscal.machine.description import machine_from_text
from axiscal.measurement.simulation import VirtualMachine
from axiscal.numerics import Array
from axiscal.tables import registry
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.offer import Export
from axiscal.tables.round_trip import drawn_and_known
from axiscal.tables.surface import left_by
from tests.generators.known import known_to_be, truth_of
from tests.generators.texts import Std, machine_text

CHAIN = "w-Y'-b-Z-X-t"
TRAVELS = {"X": (0, 300), "Y": (0, 240), "Z": (0, 200)}
BED: Mapping[str, Std] = {"EZX": ("60 um", 6, 100), "EZY": ("60 um", 5, 100)}
SQUARE: Mapping[str, Std] = {"C0Y": "0.5 mrad", "B0Z": "0.5 mrad", "A0Z": "0.5 mrad"}
STRAIGHT: Mapping[str, Std] = {"EYX": "15 um", "EXY": "15 um", "EXZ": "15 um", "EYZ": "15 um"}
OWN: Mapping[str, Std] = {"EXX": "20 um", "EYY": "20 um", "EZZ": "20 um"}
TURNS: Mapping[str, Std] = {f"E{about}{axis}": "60 urad" for about in "ABC" for axis in "XYZ"}
POSES = 30


@dataclass(frozen=True)
class Row:
    """What a control was seen to do.

    off : the largest deviation of what it adds from what the export says, in % of the largest that it adds
    found, left : the largest deviation of the tool before and after, um, the mean taken off, against a truth by exact
    kinematics; 0 where nothing is corrected
    """

    control: str
    version: str
    ran: str
    off: float
    found: float = 0.0
    left: float = 0.0

    @property
    def missed(self) -> float:
        """What is left in % of what was found."""
        return 100 * self.left / self.found if self.found else 0.0


@dataclass(frozen=True)
class Known:
    """A machine that somebody knows, and the same machine."""

    estimate: Estimate
    truth: VirtualMachine

    def poses(self) -> tuple[Array, Array]:
        """Return places all over the travels, and sides from which they are come to, both (POSES, q)."""
        rng = np.random.default_rng(5)
        low, high = np.array(self.estimate.box).T
        poses = rng.uniform(low, high, (POSES, len(low)))
        poses[:2] = low, high
        ways = np.where(poses >= np.roll(poses, 1, axis=0), 1.0, -1.0)
        return poses, ways

    def exported(self, controller: str, **options: object) -> Export:
        """Return the files for a control."""
        return registry.export(self.estimate, controller, ExportOptions(active=False, **options))  # type: ignore[arg-type]

    def row(
        self, control: str, version: str, ran: str, export: Export, added: Callable[[Array, Array], Array], sides: bool
    ) -> Row:
        """Return what a control does.

        added : (poses, ways) -> what it adds to the command of each axis, (m, q) m
        sides : whether it looks from which side a place is come to
        """
        poses, ways = self.poses()
        ways = ways if sides else np.zeros_like(ways)
        done, said = added(poses, ways), export.control(poses, ways)
        apart = done - said
        if sides:  # a control that takes a whole lost motion off one side is shifted by half of it
            apart = apart - (apart.max(axis=0) + apart.min(axis=0)) / 2
        off = 100 * float(np.max(np.abs(apart))) / float(np.max(np.abs(said)))
        found = self.truth.deviation(poses, ways)
        left = left_by(self.estimate.machine, self.truth.deviation, lambda p, w: done, poses, ways)
        return Row(control, version, ran, off, _largest(found), _largest(left))


def known(*errors: Mapping[str, Std], seed: int = 3, chain: str = CHAIN) -> Known:
    """Return a machine with these errors, drawn."""
    together = {name: std for each in errors for name, std in each.items()}
    drawn = drawn_and_known(machine_from_text(machine_text(chain, TRAVELS, together)), seed)
    model, mean = drawn.model, drawn.mean.copy()
    for each in (f for f in model.curves if f.kind == "reversal"):  # an axis that turns arrives short
        mean[each.columns] = -model.axes[each.axis].sign * np.abs(mean[each.columns])
    estimate = known_to_be(model, mean)
    return Known(estimate, truth_of(estimate))


def _largest(deviation: Array) -> float:
    return 1e6 * float(np.max(np.abs(deviation - deviation.mean(axis=0))))
