"""What is known is the same after it was kept in a file."""

from pathlib import Path

import numpy as np
import pytest

import axiscal_core as ac
from tests.core.strangers import Warm, mill


def warm() -> ac.Case:
    machine = ac.Machine([ac.Axis.linear("X", "x", (0, "400 mm"))], [ac.Error("EXX", "10 um", length="200 mm")])
    return ac.Case(machine, [Warm("laser", "X")])


def estimated(case: ac.Case) -> ac.Known:
    """Return what readings with a slip, a noise and a time of their own make known."""
    places = case.lattice(12)
    values = ac.Readings.simulated(case, places, seed=1).values.copy()
    values[3] += 1e-3
    count = len(places)
    return case.estimate(ac.Readings(places, values, std=[4e-7] * count, time=[f"{30 * i} s" for i in range(count)]))


@pytest.mark.parametrize("ending", ["json", "npz"])
def test_what_was_saved_is_what_is_loaded(tmp_path: Path, ending: str) -> None:
    case = warm()
    known, file = estimated(case), tmp_path / f"known.{ending}"
    known.save(file)
    again = ac.Known.load(str(file), case)
    assert (again.U, again.sizes, again.bad, again.z) == (known.U, known.sizes, known.bad, known.z)
    assert known.bad == (3,)
    assert again.budget(np.ones(case.size)) == known.budget(np.ones(case.size))
    more = ac.Readings(case.lattice(4), np.zeros(4), std=[4e-7] * 4, time=[400.0, 410.0, 420.0, 430.0])
    assert np.array_equal(again.read(more).covariance, known.read(more).covariance)


def test_what_is_no_such_file_is_refused(tmp_path: Path) -> None:
    case = warm()
    known = estimated(case)
    known.save(tmp_path / "known.json")
    with pytest.raises(ac.InputError, match=r"Known\.load: path .* is of another case"):
        ac.Known.load(tmp_path / "known.json", mill())
    text = (tmp_path / "known.json").read_text(encoding="utf-8")
    outside, endless = (
        text.replace('"poses": [[0.0]', '"poses": [[9.0]'),
        text.replace('"alone": [[', '"alone": [[NaN, '),
    )
    files = {"outside.json": outside, "nan.json": endless, "cut.json": text[:-9], "list.json": "[1]", "other.npz": text}
    for name, wrong in (files | {"short.json": text.replace('"mean"', '"men"')}).items():
        (tmp_path / name).write_text(wrong, encoding="utf-8")
        with pytest.raises(ac.InputError):
            ac.Known.load(tmp_path / name, case)
    with pytest.raises(ac.InputError, match=r"does not hold what is known \(FileNotFoundError"):
        ac.Known.load(tmp_path / "none.json", case)
    with pytest.raises(ac.InputError, match=r"Known\.save: path = '\.txt' is unknown"):
        known.save(tmp_path / "known.txt")
