"""Old bed maps: the grid of nodes that was probed, as a mesh of heights that a printer adds to Z."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from axiscal.compensation.surface import Mesh
from axiscal.measurement.readers.bed_map import Node


def mesh_of_nodes(nodes: Sequence[Node]) -> Mesh:
    """Return the mesh of nodes on a grid; where there is none nothing is added."""
    x, y = (np.unique([getattr(node, side) for node in nodes]) for side in "xy")
    added = np.zeros((len(y), len(x)))
    for node in nodes:
        added[np.searchsorted(y, node.y), np.searchsorted(x, node.x)] = node.height
    return Mesh(x, y, added)
