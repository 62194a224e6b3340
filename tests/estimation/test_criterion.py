"""Roots and Gram matrices of criteria: one J by both."""

import numpy as np
import pytest

from axiscal.machine.description import machine_from_text
from axiscal_core.criterion import joint
from tests.generators.texts import machine_text

MACHINE = machine_text(
    "w-X'-b-Z-C-t",
    {"X": (0, 300), "Z": (0, 400), "C": (0, 90)},
    {"EXX": 'std = "10 um", knots = 5, length = "150 mm"', "EBX": 'std = "20 urad", knots = 4, length = "200 mm"'},
)


@pytest.mark.parametrize(("chain", "reach"), [("w-X'-b-Z-C-t", 0.25), ("w-b-C-t", 1.0)])
def test_the_joint_criterion_is_the_integral_of_each_square_rotations_at_the_reach(chain: str, reach: float) -> None:
    """Half of the diagonal of 300 by 400 mm is 250 mm; integrals by the trapezoidal rule."""
    text = MACHINE.replace("w-X'-b-Z-C-t", chain)
    if "X" not in chain:
        text = text[: text.index("[axes.X]")] + text[text.index("[axes.C]") : text.index("[errors]")]
        text += '[errors]\nEZC = { std = "10 um", knots = 5, length = "40 deg" }\n'
        text += 'ECC = { std = "20 urad", knots = 4, length = "40 deg" }\n'
    model = machine_from_text(text)
    drawn, total = np.random.default_rng(4).standard_normal(model.size), 0.0
    for function in model.curves:
        at = np.linspace(function.spline.knots[0], function.spline.knots[-1], 20_001)
        curve = function.spline.rows(at) @ drawn[function.columns]
        total += (reach if function.angular else 1.0) ** 2 * float(np.trapezoid(curve**2, at))
    assert joint(model, model.size).value(drawn[:, None]) == pytest.approx(total, rel=1e-6)
