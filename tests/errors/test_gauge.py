"""What cannot be seen: right, few, said with the reading that would show it, and never guessed from chance."""

from dataclasses import replace

import numpy as np
import pytest

from axiscal.errors.gauge import Hidden, hidden, undescribed, unseen_factor
from axiscal.machine import builtin_names, load_machine
from axiscal.numerics import Array
from axiscal_core.errors import Error
from axiscal_core.machine import Machine
from tests.generators.machines import random_poses


def tool_rows(model: Machine, directions: tuple[int, ...] = (0, 1, 2)) -> Array:
    """Return readings at the tool point anywhere, from both sides, to 1 µm."""
    rng = np.random.default_rng(1)
    poses, _ = random_poses(model, 800, rng)
    rows = model.rows_at(poses, rng.choice([-1.0, 1.0], poses.shape))[:, directions]
    return rows.reshape(-1, model.size) / 1e-6


def said(model: Machine, rows: Array) -> tuple[Hidden, ...]:
    return hidden(model, unseen_factor(model.root(), rows))


def test_what_is_unseen_is_the_posterior_after_a_million_readings() -> None:
    rng = np.random.default_rng(2)
    rows, covariance = rng.standard_normal((30, 6)) @ np.diag([1, 1, 1, 1e-2, 1e-5, 0]), np.diag(rng.uniform(1, 2, 6))
    found = unseen_factor(np.sqrt(covariance), rows)
    information = np.linalg.inv(covariance) + 1e6 / 30 * rows.T @ rows
    assert np.abs(found @ found.T - np.linalg.inv(information)).max() < 1e-9


@pytest.mark.parametrize("name", builtin_names())
def test_a_built_in_machine_hides_nothing_that_moves_the_tool_point(name: str) -> None:
    model = load_machine(name)
    found = said(model, tool_rows(model))
    assert [one.text for one in found if one.effect > 0] == []
    assert len(found) <= 1
    assert all("does not depend" in one.text for one in found)


def test_what_moves_the_tool_point_unseen_is_named_with_its_size_and_its_reading() -> None:
    """The table's straightness in z is 5 µm all along, nobody reads z."""
    errors = Error("EXX", 1e-5, knots=7), Error("EZX", 5e-6, knots=7)
    model = replace(load_machine("three-axis-mill"), errors=errors)
    (first, *_) = said(model, tool_rows(model, directions=(0, 1)))
    assert first.effect == pytest.approx(_curve_rms(model), rel=1e-4)
    assert first.text == (
        f"No allowed set-up shows EZX (straightness of X in z). It moves the tool point by {first.effect * 1e6:.2g} um "
        "(RMS over the volume); a reading along z while X moves would show it."
    )


def _curve_rms(model: Machine) -> float:
    """Return the RMS about its mean of a straightness curve of the prior, by sampling it densely."""
    function = model.by_name["EZX"]
    rows = function.spline.rows(np.linspace(0, 0.6, 20_001))
    centred = rows - rows.mean(axis=0)
    return float(np.sqrt(np.mean(np.einsum("mi,ij,mj->m", centred, function.covariance, centred))))


def test_what_is_not_described_is_named() -> None:
    assert undescribed(load_machine("three-axis-mill")) is None
    assert undescribed(load_machine("one-axis")) == "Not described, taken as zero: EYX, EZX, EAX, EBX, ECX."
    mill = load_machine("three-axis-mill")
    fewer = replace(mill, errors=tuple(e for e in mill.errors if e.name[-1] != "Z" or e.name == "EZZ_reversal"))
    fewer = replace(fewer, errors=tuple(e for e in fewer.errors if e.name != "EAX"))
    assert undescribed(fewer) == "Not described, taken as zero: EAX, all six of Z, B0Z, A0Z."
