"""Knots by evidence: detail that was read is followed, a smooth axis and what somebody said keep their knots."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from axiscal.description.campaign import Era, campaign_from_texts
from axiscal.estimation.accuracy.expanded import expanded
from axiscal.estimation.case import Case
from axiscal.estimation.detail import in_detail
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal_core.normal import Normal
from tests.generators.texts import campaign_text, machine_text, setup_text

Curve = Callable[[Array], Array]


def case(errors: dict[str, str], *, fine_knots: bool = True) -> Case:
    laser = setup_text("laser", "interferometer", direction="x", noise="0.3 um", approach="both")
    text = campaign_text("m", laser, compensation_active=False)
    machine = machine_text("w-b-X-t", {"X": (0, 1000)}, errors)
    return Case(campaign_from_texts(text, "c.toml", machine, "m", era=Era(fine_knots=fine_knots)))


FREE = case({"EXX": 'std = "10 um", length = "400 mm"'})
TURNING = case({"EXX": 'std = "10 um", length = "400 mm"', "EXX_reversal": 'std = "3 um"'})


def smooth(x: Array) -> Array:
    """Return an error in m that three knots to a wave follow."""
    return 8e-6 * np.sin(3 * x) + 4e-6 * x


def detailed(x: Array) -> Array:
    """Return one that has waves of 200 mm as well, beside knots at 100 mm."""
    return smooth(x) + 5e-6 * np.sin(2 * np.pi * x / 0.2)


def read(curve: Curve, count: int, seed: int = 1) -> list[Reading]:
    rng = np.random.default_rng(seed)
    at = rng.permutation(np.linspace(0.0, 1.0, count) + rng.uniform(-0.3, 0.3, count) / count).clip(0, 1)
    shown = curve(at) + 0.3e-6 * rng.standard_normal(count)
    return [Reading("laser", (x,), (1,), v, time=30.0 * i) for i, (x, v) in enumerate(zip(at, shown, strict=True))]


def knots(known: Estimation) -> int:
    return len(known.case.errors.by_name["EXX"].spline.knots)


def left(known: Estimation, curve: Curve) -> float:
    """Return the RMS that is left at places that were not read, a constant taken off, m."""
    at = np.linspace(0.013, 0.987, 300)[:, None]
    return float(np.std(curve(at[:, 0]) - known.estimate().deviation(at, np.ones_like(at))[:, 0]))


@pytest.mark.parametrize("count", [40, 80, 160])
def test_detail_that_was_read_is_followed(count: int) -> None:
    readings = read(detailed, count)
    before, after = concluded(FREE, readings), in_detail(FREE, readings)
    assert knots(after) > knots(before)
    assert knots(after) % 2 == 1
    assert left(after, detailed) < 0.5e-6
    assert left(after, detailed) < 0.5 * left(before, detailed)
    u = [expanded(each.case.yardstick, each.printed.belief).space for each in (before, after)]
    assert u[1] < u[0]


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("count", [12, 120])
def test_a_smooth_axis_keeps_its_knots(count: int, seed: int) -> None:
    readings = read(smooth, count, seed)
    assert knots(in_detail(FREE, readings)) == knots(concluded(FREE, readings))


def test_a_reversal_varies_where_readings_out_and_back_twice_show_it() -> None:
    """Read once out and back, a drift looks the same."""
    rng, out = np.random.default_rng(1), [(x, 1) for x in np.linspace(0, 1, 15).tolist()]
    for worn, passes in ((5e-6, 3), (0.0, 3), (5e-6, 1)):
        readings = list[Reading]()
        for x, side in [*out, *((x, -1) for x, _ in out[::-1])] * passes:
            off = side * (1e-6 + worn * np.exp(-50 * (x - 0.5) ** 2)) + 0.3e-6 * rng.standard_normal()
            readings.append(Reading("laser", (x,), (side,), smooth(x) + off, time=30.0 * len(readings)))
        names = in_detail(TURNING, readings).case.errors.by_name
        assert (names["EXX_reversal"].spline.size > 1) == (worn > 0 and passes > 1)


@pytest.mark.parametrize(
    "fixed",
    [
        case({"EXX": 'std = "10 um", length = "400 mm", knots = 11'}),
        case({"EXX": 'std = "10 um", length = "400 mm", spacing = "100 mm"'}),
        case({"EXX": 'std = "10 um", length = "400 mm"'}, fine_knots=False),
        replace(FREE, inherited=Normal(np.zeros(FREE.errors.size), FREE.errors.covariance())),
    ],
    ids=["knots stated", "spacing stated", "record of before", "inherited"],
)
def test_knots_that_are_fixed_stay(fixed: Case) -> None:
    assert knots(in_detail(fixed, read(detailed, 80))) == knots(concluded(fixed, read(detailed, 80)))
