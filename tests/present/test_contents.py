"""What a report holds beside curves: standards' figures."""

from dataclasses import replace

import numpy as np
import pytest

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.evaluation.standards import PositioningTest, evaluate
from axiscal.measurement.reading import Reading
from axiscal.present.axis_tests_read import iso230_blocks
from tests.generators.laser_axis import CAMPAIGN, MACHINE


def _described(text: str) -> CampaignDescription:
    return campaign_from_texts(text, "c.toml", 'serial = "M-1"\n' + MACHINE, "m")


def _test_readings(skip: int | None = None) -> tuple[list[Reading], PositioningTest]:
    rng = np.random.default_rng(5)
    targets = np.linspace(0.05, 0.95, 7)
    up, down = (rng.normal(0, 1e-6, (7, 3)) for _ in range(2))
    readings = [
        Reading("laser", (float(target),), (side,), float(values[i, run]))
        for run in range(3)
        for values, side in ((up, 1), (down, -1))
        for i, target in enumerate(targets)
    ]
    return [r for i, r in enumerate(readings) if i != skip], PositioningTest(targets, up, down)


@pytest.mark.parametrize("name", ["X", "U"])
def test_readings_that_are_a_test_after_iso_230_2_get_its_figures(name: str) -> None:
    """Also of an axis of the second set, as the tailstock of a lathe."""
    readings, test = _test_readings()
    machine = MACHINE.replace("X-t", f"{name}-t").replace("axes.X", f"axes.{name}").replace("EXX", f"EX{name}")
    (block,) = iso230_blocks(campaign_from_texts(CAMPAIGN, "c.toml", machine, "m"), readings)
    wanted = evaluate(test)
    assert block.axis == name
    for name in ("A", "E", "R", "B", "M"):
        assert block.figures[name] == pytest.approx(1e6 * wanted.figures[name], rel=1e-5)


def test_a_reading_that_was_not_believed_takes_its_run_out_of_the_test() -> None:
    readings, test = _test_readings()
    wrong = 16  # in the second run upwards
    readings[wrong] = replace(readings[wrong], value=1e-3)
    (block,) = iso230_blocks(_described(CAMPAIGN), readings, {wrong})
    assert test.up is not None
    wanted = evaluate(PositioningTest(test.targets, test.up[:, [0, 2]], test.down))
    for name in ("A", "E", "R", "B", "M"):
        assert block.figures[name] == pytest.approx(1e6 * wanted.figures[name], rel=1e-5)
    assert block.left_out == [17]


def test_readings_with_a_gap_are_no_such_test() -> None:
    assert iso230_blocks(_described(CAMPAIGN), _test_readings(skip=4)[0]) == []
