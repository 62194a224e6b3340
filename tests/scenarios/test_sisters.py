"""What `examples/sisters.py` prints of other machines' records, beside the type that scipy's splines are drawn from."""

import re
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from axiscal.description.campaign import campaign_from_texts
from axiscal.measurement.reading import Reading
from examples.sisters import main
from tests.generators.recorded import write_record

SIZE, SHARE, COUNT = 0.5, 0.7, 12
MACHINE = """name = "Slide"
chain = "w-b-X-t"
[axes.X]
travel = ["0 mm", "500 mm"]
[errors]
EXX = { std = "20 um", knots = 7 }
EXX_reversal = { std = "6 um" }
"""
CAMPAIGN = """machine = "machine.toml"
usual = "off"
sure = "exactly"
[target]
rms = "1.5 um"
[[setups]]
name = "laser"
instrument = "interferometer"
direction = "x"
moves = ["X"]
approach = "both"
noise = "0.5 um"
unknowns = { zero = "100 um" }
"""
KNOTS, STATED = np.linspace(0.0, 0.5, 7), np.array([20e-6] * 7 + [6e-6])


def drawn(count: int) -> list[np.ndarray]:
    """Return values at the knots and reversals of machines of one type."""
    rng = np.random.default_rng(7)
    common = np.sqrt(SHARE) * rng.standard_normal(8)
    return [SIZE * STATED * (common + np.sqrt(1 - SHARE) * rng.standard_normal(8)) for _ in range(count)]


@pytest.fixture(scope="module")
def records(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Records of twelve machines of the type, each read at sixteen places."""
    folder, rng = tmp_path_factory.mktemp("records"), np.random.default_rng(8)
    described = campaign_from_texts(CAMPAIGN, "campaign.toml", MACHINE, "machine.toml")
    files = []
    for number, errors in enumerate(drawn(COUNT)):
        curve, zero, readings = CubicSpline(KNOTS, errors[:7], bc_type="natural"), rng.normal(0, 1e-4), []
        for x in np.linspace(0.01, 0.49, 8):
            for side in (1, -1):
                value = float(curve(x)) + side * errors[7] / 2 + zero + rng.normal(0, 0.5e-6)
                readings.append(Reading("laser", (float(x),), (side,), value))
        files.append(write_record(folder / f"slide-{number}.axiscal", described, readings))
    return files


def test_what_is_left_before_the_first_reading_is_what_sisters_differ_by(
    records: list[Path], capsys: pytest.CaptureFixture[str]
) -> None:
    """Of a known type a share w of the variance is known: sqrt(1 - w) of the size is left."""
    main([str(file) for file in records])
    told, *others = capsys.readouterr().out.splitlines()
    size, share = (float(each) for each in re.findall(r"\d\.\d\d", told))
    (stated, left), (planned, sooner) = ([float(each) for each in re.findall(r"\d+\.\d\d", line)] for line in others)
    assert size == pytest.approx(SIZE, rel=0.3)
    assert share == pytest.approx(SHARE, abs=0.15)
    assert left / stated == pytest.approx(SIZE * np.sqrt(1 - SHARE), rel=0.2)
    assert sooner < planned < stated
    assert sooner < left
