"""What a check must not swallow: errors that look like a set-up's own unknowns, and tables that were not loaded."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.stats import chi2

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.description.first_campaign import Purpose
from axiscal.description.first_files import first_described, of_builtin
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.machine_estimate import Estimate
from axiscal.evaluation.datums import datums_of
from axiscal.evaluation.table_checks import Judgement
from axiscal.evaluation.verification import judge
from axiscal.measurement.reading import Places, Reading
from axiscal.measurement.setup import Setup, Unknown
from axiscal.numerics import Array
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.registry import export
from axiscal.tables.surface import Control
from axiscal_core.normal import Normal
from tests.evaluation.said import said_of
from tests.generators.campaigns import on
from tests.generators.texts import machine_text, setup_text

MACHINE = machine_text(
    "w-b-X-t",
    {"X": (-200, 500)},
    {"EXX": 'std = "20 um", knots = 15, length = "300 mm"', "EBX": 'std = "1 urad", knots = 3'},
    tool=0,
    name="one",
)
LASER = setup_text("laser", "interferometer", direction="-x", noise="0.5 um", unknowns={"zero": "1 mm"})
NOISE, TOLERANCE = 0.5e-6, 6e-6
PLACES = np.linspace(-0.18, 0.48, 12)


Curve = Callable[[Array], Array]


def error(x: Array) -> Array:
    """What the machine does along x, m: known by hand."""
    return np.asarray(15e-6 * np.sin(x / 0.1) + 40e-6 * x)


@cache
def described() -> CampaignDescription:
    return on(MACHINE, LASER, target={"readings": 20}, usual="off", sure="exactly")


@cache
def known(count: int = 60) -> tuple[Estimate, Control]:
    """An estimate that has seen the machine in so many readings, and its tables."""
    rng, places = np.random.default_rng(1), np.linspace(-0.2, 0.5, count).tolist()
    values = [float(-error(np.array(x)) + rng.normal(0, NOISE)) for x in places]
    readings = [Reading("laser", (x,), (1,), value) for x, value in zip(places, values, strict=True)]
    estimate = concluded(Case(described()), readings).estimate()
    return estimate, export(estimate, "csv", ExportOptions()).control


def readings(
    seed: int, tables: float = 0.0, scale: float = 0.0, factor: float = 1.0, error: Curve = error, count: int = 60
) -> tuple[Reading, ...]:
    """Readings along −x under so many times the tables, with a scale error on top, all of it times a factor."""
    _, control = known(count)
    rng = np.random.default_rng(seed)
    commanded = tables * control(PLACES[:, None], np.ones((len(PLACES), 1)))[:, 0]
    tip = error(PLACES + commanded) + commanded + scale * (PLACES - 0.15)
    values = factor * (-tip + rng.normal(0, 1e-4) + rng.normal(0, NOISE, len(PLACES)))
    return tuple(Reading("laser", (x,), (1,), value) for x, value in zip(PLACES.tolist(), values.tolist(), strict=True))


def judged(found: tuple[Reading, ...], left: tuple[Reading, ...], *unknowns: Unknown) -> Judgement:
    estimate, control = known()
    (setup,) = described().setups
    mounted: Setup = replace(setup, unknowns=(Unknown("zero", 1e-3), *unknowns))
    return judge(estimate, (mounted,), found, left, control, TOLERANCE, (), TOLERANCE)


@pytest.mark.long
@pytest.mark.parametrize(
    ("times", "degrees", "least", "most"),
    [(1.0, np.inf, 0.03, 0.07), (2.0, np.inf, 0.55, 0.8), (3.0, np.inf, 0.9, 1.0), (1.0, 10.0, 0.03, 0.07)],
)
def test_one_of_twenty_machines_as_promised_is_called_worse_and_most_that_are_twice_as_bad(
    times: float, degrees: float, least: float, most: float
) -> None:
    """Machines so many times as far from an estimate of ten readings as it says: a normal or a t, curves by scipy."""
    estimate, control = known(10)
    (function,) = (each for each in estimate.model.curves if each.name == "EXX")
    rng, worse = np.random.default_rng(4), list[bool]()
    root, mean = estimate.factor[function.columns], estimate.mean[function.columns]
    wide = 1.0 if np.isinf(degrees) else np.sqrt((degrees - 2) / chi2.rvs(degrees, size=400, random_state=rng))
    believed = replace(estimate, belief=Normal(estimate.belief.mean, estimate.belief.covariance, degrees))
    for seed, size in enumerate(np.broadcast_to(wide, 400).tolist()):
        drawn = mean + times * size * root @ rng.standard_normal(root.shape[1])
        curve = CubicSpline(function.spline.control_positions, drawn, bc_type="natural")
        found, left = (readings(2 * seed + k, float(k), error=curve, count=10) for k in (0, 1))
        setups = described().setups
        worse.append(judge(believed, setups, found, left, control, TOLERANCE).verdict == "worse")
    assert least <= np.mean(worse) <= most


@pytest.mark.parametrize("unknowns", [(), (Unknown("growth", 1e-6),), (Unknown("slope", 2e-6),)])
def test_a_scale_error_fails_beside_a_growth_or_slope_that_is_known_well(unknowns: tuple[Unknown, ...]) -> None:
    """200 um/m over 330 mm from the middle are 66 um; a growth known to 1 um/m is 0.3 um of them."""
    judgement = judged(readings(2, scale=2e-4), readings(3, tables=1.0, scale=2e-4), *unknowns)
    assert (judgement.verdict, judgement.decision, judgement.loaded) == ("worse", "not conform", True)
    assert np.max(np.abs(judgement.left)) == pytest.approx(66e-6, abs=4e-6)


def test_a_line_that_is_taken_off_has_to_be_one_that_was_foreseen() -> None:
    judgement = judged(readings(2, scale=2e-4), readings(3, tables=1.0, scale=2e-4), Unknown("slope", 3e-5))
    assert judgement.lines == ("laser",)
    assert [datum.unknown for datum in judgement.strained] == ["slope"]
    assert (judgement.verdict, judgement.decision) == ("undecided", "conform")
    assert 'the slope of "laser" would have to be far larger' in said_of(judgement)


@pytest.mark.parametrize("factor", [-1.0, 0.0, 1000.0, 1e-3])
def test_as_found_values_that_are_nonsense_do_not_pass(factor: float) -> None:
    judgement = judged(readings(2, factor=factor), readings(5, tables=1.0))
    assert (judgement.verdict, judgement.decision, judgement.loaded) == ("undecided", "conform", False)
    told = said_of(judgement)
    assert "as found minus as left is not what the tables take away" in told
    assert "UNDECIDED" in told
    assert "contradict" in told


def test_both_legs_of_a_square_show_how_square_the_machine_is() -> None:
    """The square lies turned by any angle, which both legs share; a slope of one leg alone is the machine's."""
    described = first_described(of_builtin("three-axis-mill"), ["square"], Purpose())
    of = campaign_from_texts(described.text, "campaign.toml", described.machine.text, "machine.toml")
    at = np.array([-0.1, 0.0, 0.1, 0.12])
    poses = np.full((8, 3), 0.2)
    poses[:4, 0] += at
    poses[4:, 1] += at
    places = Places(np.repeat([0, 1], 4), poses, np.zeros_like(poses))
    datums = datums_of(of.machine, of.setups, places, 30e-6)
    turned, one_leg = 1e-3 * np.r_[at, -at], 1e-3 * np.r_[at, 0 * at]
    assert datums.lines == ("square XY",)
    assert np.abs(datums.free @ turned).max() < 1e-12
    assert np.abs(datums.free @ one_leg).max() > 40e-6
