"""What a tool of another length costs: a case that can be reckoned by hand, and one that costs nothing."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.errors.model import ErrorModel
from axiscal.errors.volume import whole_travel
from axiscal.estimation.accuracy.other_tool import LONGER, other_tool
from axiscal.estimation.belief import Belief
from axiscal.machine.description import machine_from_text
from tests.generators.texts import machine_text

TRAVELS = {"X": (0, 400), "Y": (0, 300), "Z": (-300, 0)}


def model(errors: dict[str, str]) -> ErrorModel:
    return ErrorModel(machine_from_text(machine_text("w-X'-b-Y-Z-t", TRAVELS, dict(errors), tool=100)))


def test_an_angle_that_one_length_has_balanced_shows_with_another() -> None:
    """EXZ = 100 mm of EBZ was seen at the tool's length of 100 mm: their sum is known, each alone is not.

    EBZ turns the tool about y: a point 100 mm below moves by -100 mm of it along x. With 70 mm more, 70 mm of EBZ is
    left wherever EBZ is 10 urad: 0.7 um, less its mean over the volume.
    """
    found = model({"EXZ": "10 um", "EBZ": "100 urad"})
    exz, ebz = (found.names[name].columns for name in ("EXZ", "EBZ"))
    root = np.zeros((found.size, 5))
    root[ebz] = 1e-5 * np.eye(5)
    root[exz] = 0.1 * root[ebz]
    belief = Belief(np.zeros(found.size), root @ root.T + 1e-22 * np.eye(found.size))
    worth = other_tool(found, belief, whole_travel(found))
    assert worth.stated < 1e-9
    basis = found.names["EBZ"].basis.rows(np.linspace(-0.3, 0, 2001))
    spread = basis - basis.mean(axis=0)
    assert worth.longer == pytest.approx(LONGER * 1e-5 * np.sqrt(np.sum(spread**2) / 2001), rel=0.05)
    assert worth.costs
    assert "one length cannot show every angular error" in worth.words


def test_displacements_alone_are_the_same_with_every_tool() -> None:
    found = model({"EXX": "10 um", "C0Y": "50 urad"})
    worth = other_tool(found, Belief(np.zeros(found.size), found.prior_covariance()), whole_travel(found))
    assert worth.longer == pytest.approx(worth.stated)
    assert worth.words == ""
