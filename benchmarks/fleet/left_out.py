"""One machine left out: what few readings make of it by the stated prior, and by what its sisters teach."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.inheritance import case_of
from axiscal.units import to_unit
from benchmarks.fleet.printers import SIDE, Printer, plane_basis

COUNTS = (5, 9, 16)
_BAND = 1.96


class Missed(NamedTuple):
    """rms : of the shape, truth less estimate at all nodes, um; held : share of the unread nodes in the 95 % band

    sister : how probable it is that the machine is like its sisters, None where nobody asked
    """

    rms: float
    held: float
    sister: float | None


def even_nodes(count: int) -> list[int]:
    """Return the nodes of an even design: corners and centre, 3 × 3, or 4 × 4."""
    side = {5: 2, 9: 3, 16: 4}[count]
    line = np.round(np.linspace(0, SIDE - 1, side)).astype(int)
    nodes = [int(row * SIDE + column) for row in line for column in line]
    return [*nodes, SIDE * SIDE // 2] if count == 5 else nodes


def missed(printer: Printer, case: Case, count: int) -> Missed:
    """Return what so many readings leave of the shape: offset and tilt, which every owner sets anew, are taken off."""
    read = even_nodes(count)
    known = concluded(case, printer.readings(read))
    knowledge, poses = known.printed, printer.nodes
    seen = knowledge.observation.rows(0, poses, np.ones_like(poses))
    basis = plane_basis()
    rows = seen.rows - basis @ (basis.T @ seen.rows)
    loose = seen.variances - knowledge.observation.setups[0].noise ** 2
    std = np.sqrt(np.sum((rows @ knowledge.belief.factor) ** 2, axis=1) + loose)
    off = printer.heights - rows @ knowledge.belief.mean
    unread = np.ones(len(poses), dtype=bool)
    unread[read] = False
    held = float(np.mean((np.abs(off) <= _BAND * std)[unread]))
    sister = None if known.membership is None else known.membership.sister
    return Missed(to_unit(float(np.sqrt(np.mean(off**2))), "um"), held, sister)


def each_way(printer: Printer, taught: str, count: int) -> dict[str, Missed]:
    """Return what is left by each prior.  taught : by the other machines of its type"""
    ways = {
        "stated": printer.described(),
        "learnt": printer.described(learning=True),
        "type": printer.described(prior=taught),
    }
    return {name: missed(printer, case_of(described), count) for name, described in ways.items()}
