"""Every misuse of what stands beside the core is refused by a class of ours, which says where."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import axiscal as ac
from axiscal.exceptions import AxiscalError
from tests.core.strangers import mill

anything: Any = ac
"""The library as a language without types sees it."""


def known() -> ac.Known:
    case = mill()
    return case.known(case.prior.mean, case.prior.covariance)


def simulator() -> Any:
    return ac.Simulator(ac.load_machine("three-axis-mill"), ())


MISUSES: dict[str, tuple[Callable[[], object], str]] = {
    "export: nowhere": (lambda: anything.export(known(), "linuxcnc", None), "export: folder = None is none"),
    "export: to 3": (lambda: anything.export(known(), 3, "tables"), "export: control = 3 is none"),
    "plot: a case": (lambda: anything.plot(mill()), "plot: known"),
    "to_xarray: a name": (lambda: anything.to_xarray("mill"), "to_xarray: known"),
    "Case: a name": (lambda: anything.Case("dmu60", [ac.Laser("laser", "X")]), "Case: machine = 'dmu60' is none"),
    "Case: keys": (lambda: anything.Case(ac.load_machine("dmu60"), [{"name": "x"}]), "Case: instruments = "),
    "spline: a text": (lambda: anything.NaturalSpline("abc"), "Spline: knots"),
    "spline: rows at a text": (lambda: anything.NaturalSpline(np.arange(3.0)).rows("a"), "Spline: t"),
    "spline: a constant of texts": (lambda: anything.Constant("a", "b"), "Spline: knots"),
    "load_machine: 3": (lambda: anything.load_machine(3), "load_machine: source"),
    "read_campaign: 3": (lambda: anything.read_campaign(3), "read_campaign: path"),
    "Simulator: a name": (lambda: anything.Simulator("dmu60", []), "Simulator: machine"),
    "Simulator: set-ups of numbers": (
        lambda: anything.Simulator(ac.load_machine("dmu60"), [3]),
        "Simulator: setups",
    ),
    "Simulator.drawn: −1": (lambda: simulator().drawn(-1), "Simulator.drawn: seed"),
    "Simulator: a list of curves": (lambda: simulator().with_curves([1], 1), "Simulator.with_curves: curves"),
    "Simulator: curves of seed −1": (lambda: simulator().with_curves({}, -1), "Simulator.with_curves: seed"),
    "Campaign.create: of 3": (lambda: anything.Campaign.create("a.axiscal", 3), "Campaign.create: description"),
    "Campaign.open: 3": (lambda: anything.Campaign.open(3), "Campaign.open: path"),
}


@pytest.mark.parametrize("misuse", MISUSES)
def test_a_misuse_is_refused_where_it_is(misuse: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    given, says = MISUSES[misuse]
    with pytest.raises((ac.InputError, AxiscalError)) as refused:
        given()
    assert str(refused.value).startswith(says)
    assert [*tmp_path.iterdir()] == []
