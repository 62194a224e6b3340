"""Displays that move in coarse steps which nobody stated: found where values show it, not where chance might do it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.description.campaign import campaign_from_texts
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.numerics.displays import step_of
from axiscal.present.findings import coarse_displays
from tests.generators.texts import campaign_text, machine_text, setup_text

NOISE = 0.5
"""um"""
MACHINE = machine_text("w-b-X-t", {"X": (0, 1000)}, {"EXX": 'std = "20 um", length = "300 mm", knots = 9'})
CAMPAIGN = campaign_text(
    "machine.toml",
    setup_text("laser along x", "interferometer", direction="x", noise="0.5 um"),
    target={"readings": 20},
)


def curve(seed: int, count: int, size: float = 30.0) -> Array:
    """Return readings before any display, um: a smooth curve of some size, with the noise."""
    rng = np.random.default_rng(seed)
    smooth = size * np.sin(np.linspace(0, 6, count) + rng.uniform(0, 6)) + rng.uniform(-size, size)
    return np.asarray(smooth + rng.normal(0, NOISE, count))


def shown(values: Array, step: float, decimals: int = 2) -> Array:
    """Return what a display of some step shows, as a file has it, m."""
    return np.round(np.round(values / step) * step, decimals) * 1e-6


def found(values: Array) -> float | None:
    """Return the step that is found beside the noise, um."""
    step = step_of(values, NOISE * 1e-6)
    return None if step is None else step * 1e6


@given(
    step=st.floats(1.7, 40),
    counts=st.lists(st.integers(-30, 30), min_size=6, max_size=40),
    offset=st.floats(-50, 50),
    decimals=st.sampled_from([3, 4, 9]),
)
def test_the_step_found_is_the_largest_of_which_all_values_differ_by_multiples(
    step: float, counts: list[int], offset: float, decimals: int
) -> None:
    multiples = np.array([0, 1, 2, 4, 7, 11, 16, 22, 29, *counts])
    for times in (1, 3):
        values = np.round(times * multiples * step + offset, decimals) * 1e-6
        assert found(values) == pytest.approx(times * step, abs=2 * 10.0**-decimals + 1e-5 * step)


@pytest.mark.parametrize("step", [1.6, 2.0, 2.54, 5.0, 6.35, 10.0])
def test_coarse_displays_are_found(step: float) -> None:
    steps = [found(shown(curve(seed, 26), step)) for seed in range(40)]
    assert steps == pytest.approx([step] * 40, rel=2e-3)


@pytest.mark.parametrize("decimals", [1, 2, 3, 9])
@pytest.mark.parametrize("count", [3, 5, 12, 40])
def test_values_with_usual_decimals_are_no_steps(decimals: int, count: int) -> None:
    files = [np.round(curve(seed, count, size), decimals) * 1e-6 for seed in range(100) for size in (0.3, 3.0, 30.0)]
    assert [step for step in map(found, files) if step] == []


def setups(more: str) -> tuple[Setup, ...]:
    """Return the set-up of the campaign with more said of it."""
    return campaign_from_texts(CAMPAIGN + more, "campaign.toml", MACHINE, "machine.toml").setups


def taken(values: Array, std: float | None = None) -> list[Reading]:
    """Return values as readings along the axis."""
    places = np.linspace(0, 1, len(values))
    return [Reading("laser along x", (float(x),), (0,), float(y), std) for x, y in zip(places, values, strict=True)]


@pytest.mark.parametrize("count", [4, 21])
def test_a_lead_error_at_equal_places_is_no_step(count: int) -> None:
    exact = np.linspace(0, 300, count)
    assert list(coarse_displays(taken(exact * 1e-6), setups(""))) == []
    assert len(list(coarse_displays(taken(shown(np.linspace(0, 307, 12), 20.0)), setups("")))) == 1
