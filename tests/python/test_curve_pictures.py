"""Curves as pictures and as arrays of xarray."""

import sys
from types import ModuleType
from xml.etree import ElementTree

import numpy as np
import pytest

import axiscal as ac
from tests.core.strangers import mill


def known() -> ac.Known:
    case = mill()
    return case.estimate(ac.Readings.simulated(case, case.lattice(20), seed=1))


def test_every_curve_has_its_picture() -> None:
    found = known()
    drawn = ac.plot(found)
    tags = [ElementTree.fromstring(svg).tag for svg in drawn.svg]
    assert tags == ["{http://www.w3.org/2000/svg}svg"] * sum(term.spline.size > 1 for term in found.case.machine.curves)
    assert drawn._repr_html_() == "".join(drawn.svg)


def test_arrays_hold_curves_with_their_rests(monkeypatch: pytest.MonkeyPatch) -> None:
    found = known()
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(ac.InputError, match="pip install xarray"):
        ac.to_xarray(found)
    monkeypatch.setitem(sys.modules, "xarray", ModuleType("xarray"))
    monkeypatch.setattr(sys.modules["xarray"], "Dataset", dict, raising=False)
    data = ac.to_xarray(found)
    along, mean, unit = data["EXX_mean"]
    assert (unit, data[along][2], data["ECX_std"][2]) == ({"units": "m"}, {"units": "m"}, {"units": "rad"})
    curve = found["EXX"](data[along][1])
    assert mean == pytest.approx(curve.mean, rel=1e-9, abs=1e-15)
    rest = found.case.machine.by_name["EXX"].rest
    assert rest > 0
    assert data["EXX_std"][1] == pytest.approx(np.sqrt(curve.std**2 + rest**2), rel=1e-9)
