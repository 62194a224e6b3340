"""ISG_CSV holds what two axes do together as a table of the later one over both."""

from __future__ import annotations

import numpy as np

from axiscal.machine import machine_from_text
from axiscal.tables.controllers.isg import SampledError, read_csv, write_csv
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.registry import export
from axiscal.tables.round_trip import drawn_and_known
from tests.generators.planes import BED, TABLE


def test_the_kernel_holds_what_two_axes_do_together() -> None:
    """Of a bed no table over one axis holds it, and none of its columns is there twice, which the kernel refuses."""
    made = export(drawn_and_known(machine_from_text(BED)), "isg", ExportOptions())
    assert made.effect.after < 0.1 * made.effect.before
    heads = [line.split() for line in made.files["volcomp.csv"].splitlines() if line[:1].isalpha()]
    errors = [name for head in heads for name in head if name.startswith("E")]
    assert len(errors) == len(set(errors)), "the kernel refuses a column that is there twice (70469)"
    assert ["Y", "X", "EZX"] in heads
    assert "as a table of the later one over both" in made.readme


def _surface(seed: int, over: str = "Z") -> SampledError:
    rng = np.random.default_rng(seed)
    return SampledError(np.linspace(0, 0.3, 5), rng.normal(0, 1e-5, (4, 5)), over, np.linspace(0, 0.2, 4))


def test_a_table_over_two_axes_is_read_as_it_was_written() -> None:
    machine = machine_from_text(TABLE)
    turned = SampledError(
        np.linspace(0, 2 * np.pi, 5), np.random.default_rng(1).normal(0, 1e-5, (3, 5)), "X", np.linspace(0.03, 0.11, 3)
    )
    text = write_csv({"EZX": _surface(0), "EBC": turned}, machine)
    again = read_csv(text, machine)
    assert write_csv(again, machine) == text
    np.testing.assert_allclose(again["EBC"].values, turned.values, atol=1e-14)
