"""ISG_CSV holds what two axes do together as a table of the later one over both.

The reader here is a twin of what the kernel's documentation says: columns under a header, a block for each `#`, linear
between the points of a grid.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator

from axiscal.exceptions import TableError
from axiscal.machine import machine_from_text
from axiscal.numerics import Array
from axiscal.tables.controllers.isg import read_csv, write_csv
from axiscal.tables.volumetric import SampledError, together
from tests.generators.planes import TABLE
from tests.tables.test_bed_round_trips import PLANE, X, Y, estimated, exported, klipper_file, warped


def blocks(text: str) -> list[tuple[list[str], Array]]:
    """Return header and numbers of each block."""
    lines = [line.split("//")[0].split() for line in text.splitlines()]
    found, rows = [], list[list[str]]()
    for words in [*lines, ["#"]]:
        if words != ["#"]:
            rows += [words] if words else []
        elif rows:
            found.append((rows[0], np.array([[float(word) for word in row] for row in rows[1:]])))
            rows = []
    return found


def test_the_kernel_holds_a_warped_bed(tmp_path: Path) -> None:
    record = estimated(tmp_path, klipper_file(X, Y, warped(X, Y)), "printer.cfg", planes=PLANE)
    files = exported(record, "isg")
    by_header = {tuple(header): numbers for header, numbers in blocks(files["volcomp.csv"])}
    both = by_header["Y", "X", "EZX"]
    names = [name for header in by_header for name in header if name.startswith("E")]
    assert len(names) == len(set(names)), "the kernel refuses a column that is there twice (70469)"
    y, x = np.unique(both[:, 0]), np.unique(both[:, 1])
    assert len(both) == len(x) * len(y)
    surface = RegularGridInterpolator((y, x), both[:, 2].reshape(len(y), len(x)))
    (over_y,) = (numbers for header, numbers in by_header.items() if header[0] == "Y" and header[1] != "X")
    (own,) = (header for header in by_header if header[0] == "Y" and header[1] != "X")
    straight = np.interp(Y, over_y[:, 0], over_y[:, own.index("EZY")])
    places = np.stack(np.meshgrid(Y, X, indexing="ij"), axis=-1)
    held = -(surface(places) - straight[:, None])  # a high bed is a tool too low; Y' carries the workpiece
    left = held - warped(X, Y)
    assert np.std(left) < 0.1 * np.std(warped(X, Y))
    assert "as a table of the later one over both" in files["README.txt"]
    assert "no table over one axis holds it" not in files["README.txt"]


def _surface(seed: int, over: str = "Z") -> SampledError:
    rng = np.random.default_rng(seed)
    return SampledError(np.linspace(0, 0.3, 5), rng.normal(0, 1e-5, (4, 5)), over, np.linspace(0, 0.2, 4))


def test_a_table_over_two_axes_is_read_as_it_was_written() -> None:
    machine = machine_from_text(TABLE)
    turned = SampledError(
        np.linspace(0, 2 * np.pi, 5), np.random.default_rng(1).normal(0, 1e-5, (3, 5)), "X", X[:3] / 1e3
    )
    text = write_csv({"EZX": _surface(0), "EBC": turned}, machine)
    again = read_csv(text, machine)
    assert write_csv(again, machine) == text
    np.testing.assert_allclose(again["EBC"].values, turned.values, atol=1e-14)


def test_old_and_new_add_up_whichever_depends_on_both_axes() -> None:
    curve, rng = SampledError(np.linspace(0, 0.3, 4), np.array([0.0, 1e-6, 3e-6, 2e-6])), np.random.default_rng(4)
    x, z = rng.uniform(0, 0.3, 50), rng.uniform(0, 0.2, 50)
    for new, old in ((_surface(2), curve), (curve, _surface(2)), (_surface(2), _surface(3))):
        whole = together({"EZX": new}, {"EZX": old})["EZX"]
        # between points both are bilinear, and the sum has the points of both: it is the same there
        np.testing.assert_allclose(whole.at(x, z), new.at(x, z) + old.at(x, z), atol=1e-18)
    with pytest.raises(TableError, match="depends on"):
        together({"EZX": _surface(2)}, {"EZX": _surface(3, "C")})
