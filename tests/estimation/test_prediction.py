"""Predictions of the tool point: drawn machines, the ends of each travel, what is left out."""

from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from axiscal.errors.volume import deviation_of
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.prediction import predict_poses, tcp_prediction
from axiscal.exceptions import ReadingError
from axiscal.machine import machine_from_text
from axiscal.measurement.readers.csv_readings import RawReading
from axiscal_core.machine import Machine
from axiscal_core.normal import Normal
from tests.generators.texts import machine_text

TEXT = machine_text(
    "w-X'-b-C-t",
    {"X": (-100, 300), "C": (-30, 90)},
    {
        "EXX": 'std = "10 um", length = "150 mm", knots = 4, rest = "2 um"',
        "EYX": ("6 um", 4, 150),
        "EXX_reversal": "4 um",
        "EYX_reversal": "3 um",
        "EXC": 'std = "5 um", length = "40 deg", knots = 4, rest = "1 um"',
    },
)
ERRORS = machine_from_text(TEXT)
FILE = Path("poses.csv")


@dataclass
class Known:
    """What of an estimation a prediction looks at."""

    errors: Machine
    belief: Normal

    def estimation(self) -> Estimation:
        """Return it as one."""
        described = SimpleNamespace(machine=self.errors, setups=(), usual=False)
        case, printed = SimpleNamespace(errors=self.errors, description=described), SimpleNamespace(belief=self.belief)
        return cast("Estimation", SimpleNamespace(case=case, printed=printed, readings=()))


def known(seed: int = 1) -> Known:
    """Return a belief whose numbers are any."""
    rng = np.random.default_rng(seed)
    root = 2e-6 * rng.standard_normal((ERRORS.size, ERRORS.size))
    return Known(ERRORS, Normal(4e-6 * rng.standard_normal(ERRORS.size), root @ root.T))


POSES = np.array([[-0.1, 0.3], [0.05, -0.5], [0.3, 1.5], [0.12, 0.0]])


@pytest.mark.parametrize("side", [-1.0, 0.0, 1.0])
def test_the_band_is_the_scatter_of_machines_that_come_from_that_side_or_from_any(side: float) -> None:
    """Where nobody says from which side, the tool comes from either as often; rests are drawn at each place."""
    have, rng, count = known(), np.random.default_rng(2), 60_000
    mean, std = tcp_prediction(have.estimation(), POSES, np.full(POSES.shape, side))
    drawn = have.belief.mean + rng.standard_normal((count, have.belief.size)) @ have.belief.factor.T
    sides = rng.choice([-1.0, 1.0], count) if side == 0 else np.full(count, side)
    levers = ERRORS.levers(POSES)
    for index, pose in enumerate(POSES):
        rows = [ERRORS.rows_at(pose[None], np.full((1, 2), each))[0] for each in (-1.0, 1.0)]
        shown = np.where((sides < 0)[:, None], drawn @ rows[0].T, drawn @ rows[1].T)
        for term, lever in zip(ERRORS.terms, levers, strict=True):
            shown += term.rest * rng.standard_normal(count)[:, None] * lever[index]
        np.testing.assert_allclose(std[index], shown.std(axis=0), rtol=0.02, atol=1e-12)
    exact = deviation_of(ERRORS, have.belief.mean, POSES, np.full(POSES.shape, side)).displacement
    assert np.array_equal(mean, exact)


def raw(position: dict[str, float], approach: dict[str, int] | None = None, line: int = 2) -> RawReading:
    """Return a pose of a file."""
    return RawReading("", position, approach or {}, 0.0, None, "length", line)


def test_what_a_pose_leaves_out_is_the_middle_of_the_travel_from_any_side() -> None:
    have = known().estimation()
    found = predict_poses(have, [raw({"C": 0.2}, {"C": -1})], FILE)
    stated = predict_poses(have, [raw({"X": 0.1, "C": 0.2}, {"C": -1})], FILE)
    expected = tcp_prediction(have, np.array([[0.1, 0.2]]), np.array([[0.0, -1.0]]))
    assert found[0] == pytest.approx(stated[0])
    assert np.array(found) == pytest.approx(np.array(expected))
    assert len(predict_poses(have, [], FILE)[0]) == 0


@pytest.mark.parametrize(("at", "allowed"), [(0.0, True), (0.5e-9, True), (2e-9, False)])
def test_an_end_of_the_travel_is_within_it_up_to_rounding(at: float, allowed: bool) -> None:
    have, (low, high) = known().estimation(), ERRORS.axes[0].travel
    for end in (low - at, high + at):
        if allowed:
            assert len(predict_poses(have, [raw({"X": end})], FILE)[0]) == 1
        else:
            with pytest.raises(ReadingError, match=r"poses\.csv, line 7.*X = .* mm is outside the travel") as caught:
                predict_poses(have, [raw({"X": 0.0}), raw({"X": end}, line=7)], FILE)
            assert "X goes from -100 mm to 300 mm" in str(caught.value)
