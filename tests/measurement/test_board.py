"""Balls on a board that is put down again and turned: what it leaves open is the same board, and another place."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import least_squares

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation
from axiscal.measurement.candidates import spread
from axiscal.measurement.observation import owned
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal_core.rigid import rotation
from tests.generators.texts import machine_text, setup_text

MACHINE = machine_text(
    "w-b-X-Y-Z-t", {"X": (0, 600), "Y": (0, 400), "Z": (-150, 0)}, {"C0Y B0Z A0Z": "100 urad"}, tool=80
).replace("[tool]", '[tool]\nstylus = "6 mm"')
BALLS = {"one": (-120, -110, 0), "two": (120, -120, 60), "three": (115, 120, 10), "four": (-120, 120, 50)}
PLACED = ((300, 200, 45), (300, 200, 135), (150, 150, 0), (450, 250, 90), (450, 150, 180))
BOARD = """
machine = "router.toml"
usual = "off"
sure = "exactly"
scales = "stated"
[[artefacts]]
name = "board"
balls = {{ {balls} }}
calibrated = "0.3 mm"
diameter = "25 mm"
turned = "5 mrad"
"""
PLACEMENT = setup_text(
    "{number}", "sphere", artefact="board", at=["{x} mm", "{y} mm", "-220 mm"], turn="{turn} deg", retract="25 mm"
)
NOISE, HEIGHT, TOOL = 1.5e-6, -0.22, 0.08
ROUNDS = 3


def board() -> str:
    said = ", ".join(f'{name} = ["{x} mm", "{y} mm", "{z} mm"]' for name, (x, y, z) in BALLS.items())
    placements = [PLACEMENT.format(number=n, x=x, y=y, turn=turn) for n, (x, y, turn) in enumerate(PLACED, start=1)]
    return BOARD.format(balls=said) + "".join(placements)


def described(text: str) -> CampaignDescription:
    return campaign_from_texts(text, "campaign.toml", MACHINE, "router.toml")


class Touched:
    """A board touched in five placements, made up here: three angles, 12 of balls, 30 of placements, a strain."""

    def __init__(self) -> None:
        self.stds = np.array([1e-4] * 3 + [3e-4] * 12 + ([1e-3] * 3 + [5e-3] * 3) * 5 + [0.5e-6])
        self.balls = np.array(list(BALLS.values())) / 1e3
        self.order = [(p, b) for p in range(5) for _ in range(ROUNDS) for b in range(4)]

    def values(self, unknown: Array) -> Array:
        """Return the found places of the balls less what the machine says, (readings, 3)."""
        (c, b, a), own = unknown[:3], unknown[3:15].reshape(4, 3)
        shape = self.balls - self.balls.mean(axis=0)
        found = []
        for place, ball in self.order:
            x, y, turn = PLACED[place]
            shift, tilt = unknown[15 + 6 * place : 18 + 6 * place], unknown[18 + 6 * place : 21 + 6 * place]
            put = rotation(np.array([[0.0, 0.0, math.radians(turn)]]))[0]
            stated = put @ self.balls[ball] + [x / 1e3, y / 1e3, HEIGHT]
            scaled = (1 + unknown[-1]) * shape[ball]
            stands = rotation(tilt[None])[0] @ put @ (scaled + own[ball]) - put @ shape[ball] + shift
            _, along, up = stated + np.array([0, 0, TOOL])
            swung = np.array([-c * along + b * up, -a * up, 0.0])
            found.append(swung - stands)
        return np.array(found)

    def fitted(self, values: Array) -> tuple[Array, Array]:
        """Return what least squares say, and its standard deviations."""

        def left(scaled: Array) -> Array:
            return np.concatenate([((values - self.values(scaled * self.stds)) / NOISE).ravel(), scaled])

        solved = least_squares(left, np.zeros(len(self.stds)), x_scale="jac", xtol=1e-14, ftol=1e-14, gtol=1e-14)
        slopes = np.asarray(solved.jac, dtype=float)
        spread = np.sqrt(np.diagonal(np.linalg.inv(slopes.T @ slopes)))
        return solved.x * self.stds, spread * self.stds


def estimated(description: CampaignDescription, values: Array) -> Estimation:
    """Return the estimate of readings taken ball after ball, three times in each placement."""
    readings = list[Reading]()
    at = iter(values.tolist())
    for setup in description.setups:
        for pose in spread(description.machine, (setup,), 400).poses.tolist() * ROUNDS:
            value, *others = next(at)
            one = Reading(setup.name, tuple(pose), (0, 0, 0), value, others=tuple(others), number=len(readings) + 1)
            readings.append(one)
    return concluded(Case(description), readings)


@pytest.mark.long
def test_least_squares_of_scipy_find_the_same_angles_and_know_them_as_well() -> None:
    touched, rng = Touched(), np.random.default_rng(4)
    truth = rng.standard_normal(len(touched.stds)) * touched.stds
    values = touched.values(truth) + NOISE * rng.standard_normal((len(touched.order), 3))
    mean, spread = touched.fitted(values)
    known = estimated(described(board()), values)
    names = [term.name for term in known.case.errors.terms]
    columns = [known.case.errors.terms[names.index(name)].columns.start for name in ("C0Y", "B0Z", "A0Z")]
    belief = known.knowledge.belief
    np.testing.assert_allclose(belief.mean[columns], mean[:3], atol=5e-8)
    np.testing.assert_allclose(np.sqrt(np.diagonal(belief.covariance))[columns], spread[:3], rtol=2e-3)
    assert spread[0] < 3e-6
    assert np.all(np.abs(mean[:3] - truth[:3]) < 4 * spread[:3])


def test_a_board_that_is_put_down_again_is_the_same_board_at_another_place() -> None:
    setups = described(board()).setups
    unknowns = owned(setups)[0]
    assert len(unknowns) == 12 + 1 + 5 * 6
    assert {each.owner for each in unknowns if each.name == "one_x"} == {"board"}
    assert len({each.owner for each in unknowns if each.name == "place_x"}) == 5
    assert setups[3].artefact is not None
    np.testing.assert_allclose(setups[3].artefact.points[0], [0.45 + 0.11, 0.25 - 0.12, -0.22], atol=1e-12)
