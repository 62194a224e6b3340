"""What is left after a time and what tables add, against machines drawn one by one, by other means."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.description.type_text import SisterRecord, TypePrior
from axiscal.estimation.data_equation import data_equation
from axiscal.estimation.estimate import concluded
from axiscal.estimation.inheritance import case_of
from axiscal.machine import load_machine, machine_from_text
from axiscal.machine.kinematics import Deviation, frames, tool_motion
from axiscal.measurement.reading import Place, Reading
from axiscal.measurement.simulation import Simulator
from axiscal.numerics import Array
from axiscal.ports.fleet.worn_machine import Aging, without_tables, worn
from axiscal_core.eigen import unique_root
from tests.generators.sisters import measured
from tests.generators.texts import campaign_text, setup_text

TABLE = """name = "Table"
chain = "w-b-X-Y-t"
[axes.X]
travel = ["0 mm", "500 mm"]
[axes.Y]
travel = ["0 mm", "400 mm"]
[errors]
C0Y = { std = "40 urad" }
ECX = { std = "50 urad", knots = 5, length = "250 mm", rest = "1 urad" }
EXY = { std = "3 um", knots = 5, length = "250 mm" }
EXY_reversal = { std = "3 um" }
"""
CAMPAIGN = campaign_text(
    "machine.toml",
    setup_text("laser", "interferometer", direction="x", moves=["X", "Y"], approach="both", noise="1 um", unknowns={}),
    target={"rms": "5 um"},
    usual="off",
    sure="exactly",
)
AXES = {"C0Y": "Y", "ECX": "X", "EXY": "Y", "EXY_reversal": "Y"}
MACHINES, AT_ONCE = 10_000, 1000


def _described(prior: str = "") -> CampaignDescription:
    return campaign_from_texts(CAMPAIGN, "campaign.toml", TABLE, "machine.toml", prior_text=prior)


def _spread(size: Array, seed: int) -> Array:
    """Return a covariance of these standard deviations in which every error has to do with every other."""
    shape = np.random.default_rng(seed).standard_normal((len(size), 2 * len(size))) + 2.0
    whole = shape @ shape.T
    std = size / np.sqrt(np.diagonal(whole))
    return np.asarray(std[:, None] * whole * std)


def _drawn(mean: Array, covariance: Array, rng: np.random.Generator, count: int) -> Array:
    return mean[:, None] + unique_root(covariance) @ rng.standard_normal((len(mean), count))


class Twin:
    """Machines one by one, of a type that was taught, as the readings of one of them leave it."""

    def __init__(self) -> None:
        errors = case_of(_described()).errors
        std = np.sqrt(np.diagonal(errors.prior_covariance()))
        self.own = _spread(1.3 * std, 2)
        rng = np.random.default_rng(4)
        self.mean = 0.5 * std * rng.standard_normal(len(std))
        records = (SisterRecord("one.axiscal", "1", 1),)
        machine = machine_from_text(TABLE)
        taught = TypePrior(machine.text, records, {}, 0, 1e-9, self.mean, self.own, self.own)
        described = _described(taught.text())
        places = [Place("laser", (x, y), (s, s)) for x in (0.05, 0.3) for y in (0.1, 0.35) for s in (1, -1)]
        truth = _drawn(self.mean, self.own, rng, 1)[:, 0]
        virtual = Simulator(described.machine, described.setups).with_coefficients(truth, 5)
        readings = measured(case_of(described), virtual, places, 5)
        self.known, self.rng = concluded(case_of(described), readings), rng
        self._read = data_equation(self.known.case.observation, readings)

    def left(self, kept: Array, renewed: str) -> Array:
        """Return how far off the tool point is at the yardstick's poses, less the shift that is not counted, (m, k) m.

        kept : (k,)
        """
        zero, rows, count = np.zeros(len(self.mean)), self._read.rows, len(kept)
        mean, mine = self.mean[:, None], _drawn(zero, self.own, self.rng, count)
        shown = rows @ (mean + mine) + self.rng.standard_normal((len(rows), count))
        scatter = rows @ self.own @ rows.T + np.eye(len(rows))
        off = np.linalg.solve(scatter, self._read.values[:, None] - shown)
        mine = mine + self.own @ rows.T @ off
        later, errors = np.empty_like(mine), self.known.case.errors
        # what comes anew on an axis that was renewed has nothing to do with how the other one ages
        aged = kept * mine + np.sqrt(1 - kept**2) * _drawn(zero, self.own, self.rng, count)
        new = _drawn(zero, self.own, self.rng, count)
        for term in errors.terms:
            later[term.columns] = (new if AXES[term.name] == renewed else aged)[term.columns]
        left = mean + later - self.known.printed.belief.mean[: errors.size][:, None]
        poses, _ = self.known.case.yardstick.poses
        rests = self.rng.standard_normal((len(errors.rests), len(poses), count))
        loose = errors.levers(poses) * errors.rests[:, None, None]
        tips = np.einsum("mcn,nk->mck", self.known.case.yardstick.rows, left) + np.einsum("tmc,tmk->mck", loose, rests)
        return np.asarray(np.sqrt(np.sum(tips**2, axis=1)))


@pytest.fixture(scope="module")
def twin() -> Twin:
    return Twin()


def _aging() -> Aging:
    weights = np.zeros((50, 50))
    weights[[20, 5], [-1, 40]] = 0.3, 0.7
    return Aging(weights, 1)


def _kept(twin: Twin, years: float) -> Array:
    cells = (twin.rng.random(AT_ONCE) < 0.7).astype(int)
    once, yearly = np.array([[0.705, 0.995], [0.555, 0.905]])[cells].T
    kept: Array = once * yearly**years
    return kept


@pytest.mark.long
@pytest.mark.parametrize("renewed", ["", "X", "Y"])
def test_rms_is_that_of_machines_drawn_one_by_one(twin: Twin, renewed: str) -> None:
    rms = worn(twin.known, _aging(), tuple(renewed))
    evenly, squares = twin.known.case.yardstick.evenly, list[float]()
    for _ in range(MACHINES // AT_ONCE):
        left = twin.left(_kept(twin, 2.0), renewed)
        squares.append(float(np.mean(left[evenly] ** 2)))
    np.testing.assert_allclose(rms(2.0), np.sqrt(np.mean(squares)), rtol=0.012)


SETUPS = {
    "interferometer": ("one-axis", 'direction = "x"'),
    "probe": ("dmu60", 'direction = [1, 2, -1]\nmoves = ["X", "Y", "Z", "B", "C"]'),
    "level": ("dmu60", 'direction = "y"\nmoves = ["X", "Y", "Z", "B", "C"]'),
    "sphere": ("dmu60", 'station = ["80 mm", "30 mm", "-150 mm"]'),
    "tracker": ("three-axis-mill", 'station = ["-1500 mm", "900 mm", "200 mm"]\nmoves = ["X", "Y", "Z"]'),
    "tracer": ("three-axis-mill", 'station = ["-300 mm", "-200 mm", "-100 mm"]\nmoves = ["X", "Y", "Z"]'),
}


@pytest.mark.parametrize("instrument", SETUPS)
def test_what_is_taken_off_is_what_the_tables_add(instrument: str) -> None:
    name, keys = SETUPS[instrument]
    text = f'machine = "{name}"\n[target]\nreadings = 1\n[[setups]]\nname = "s"\ninstrument = "{instrument}"\n{keys}\n'
    described = campaign_from_texts(text, "c.toml", load_machine(name).text, name)
    machine, setups = described.machine, described.setups
    virtual = Simulator(machine, setups).drawn(1)
    rng, shown, tips = np.random.default_rng(5), list[Array](), list[Array]()
    low, high = np.array([axis.travel for axis in machine.axes]).T
    offset = 20e-6 * rng.standard_normal(len(low))

    def control(poses: Array, approaches: Array) -> Array:
        return np.where(approaches > 0, offset, -offset)

    pose, approach = rng.uniform(low, high), rng.choice([-1.0, 1.0], len(low))
    at, come = pose[None], approach[None]
    own = virtual.model.compose(virtual.values(at), come)
    for sent in (at, at + control(at, come)):
        found, nominal = tool_motion(machine, sent, own), frames(machine, at)
        turned = found.rotation[0] @ nominal.tool[0].T
        turn = np.array([turned[2, 1], turned[0, 2], turned[1, 0]])
        actual = Deviation(found.translation - nominal.tcp, turn[None])
        tips.append(found.translation)
        shown.append(np.array(virtual.exactly(setups[0], at, actual, come)))
    reading = Reading("s", tuple(pose), tuple(approach.astype(int).tolist()), shown[1][0], others=tuple(shown[1][1:]))
    (bare,) = without_tables([reading], machine, setups, control)
    assert np.max(np.abs(shown[1] - shown[0])) > 5e-7
    moved = float(np.linalg.norm(tips[1] - tips[0]))
    np.testing.assert_allclose(bare.values, shown[0], atol=0.005 * moved)  # a station is 5 mm of a metre off
