"""A warm scale on a machine that is true at 20 degC, against readings worked out by hand: 5 K at 11.7 um/m/K."""

from dataclasses import replace

import numpy as np
import pytest

from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.machine.description import machine_from_text
from axiscal.measurement.instruments.displacement import Interferometer
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Unknown
from tests.generators.campaigns import on
from tests.generators.texts import Said, machine_text, setup_text

STRAIN = 58.5e-6
"""By what the scale is longer at 25 degC."""
MIDDLE = 0.15
WARM: dict[str, Said] = {"temperature": "25 degC", "expansion": "11.7 um/m/K"}


@pytest.mark.parametrize(
    ("chain", "direction", "sign", "std"),
    [("w-b-X-t", "x", 1.0, "0 K"), ("w-b-X-t", "-x", -1.0, "0.5 K"), ("w-X'-b-t", "-x", -1.0, "0 K")],
)
def test_a_warm_scale_of_a_true_machine_leaves_no_error(direction: str, sign: float, chain: str, std: str) -> None:
    """Along −x the carriage that goes too far reads −58.5 um/m; corrected the other way it would be 41 um."""
    laser = setup_text("laser", "interferometer", direction=direction, noise="0.5 um", **WARM, temperature_std=std)
    machine = machine_text(chain, {"X": (-200, 500)}, {"EXX": ("50 um", 5, 300)}, tool=0)
    case = Case(on(machine, laser, target={"readings": 20}))
    places = np.linspace(-0.19, 0.49, 15).tolist()
    estimation = concluded(case, [Reading("laser", (x,), (1,), sign * STRAIN * (x - MIDDLE)) for x in places])
    assert np.max(np.abs(estimation.estimate().mean)) < 1e-9
    assert not estimation.outliers


@pytest.mark.parametrize(
    ("chain", "angle", "direction", "share"),
    [
        ("w-C'-b-X-t", 0.0, (0.6, 0.8, 0.0), 0.6),
        ("w-C'-b-X-t", 0.0, (-0.8, 0.0, 0.6), -0.8),
        ("w-C'-X'-b-t", 0.0, (-1.0, 0.0, 0.0), -1.0),
        ("w-C'-b-X-t", 90.0, (0.0, 1.0, 0.0), 1.0),
        ("w-C'-X'-b-t", 90.0, (0.0, -1.0, 0.0), -1.0),
        ("w-C'-b-X-t", 90.0, (1.0, 0.0, 0.0), 0.0),
        ("w-X'-C'-b-t", 90.0, (-1.0, 0.0, 0.0), -1.0),
    ],
)
def test_growth_shows_as_far_as_it_goes_along_the_direction(
    chain: str, angle: float, direction: tuple[float, float, float], share: float
) -> None:
    """A table turned by 90 degrees sees the carriage of X go along its y."""
    machine = machine_from_text(
        machine_text(chain, {"C": (-180, 180), "X": (-200, 500)}, {"EXX": 'std = "5 um", knots = 4'}), "t.toml"
    )
    c, x = (next(k for k, axis in enumerate(machine.axes) if axis.name.startswith(letter)) for letter in "CX")
    poses = np.zeros((3, 2))
    poses[:, c], poses[:, x] = np.radians(angle), [-0.2, 0.15, 0.4]
    park = tuple(poses[0].tolist())
    unknowns = (Unknown("growth", 1e-6),)
    times = (0.0, 0.0, 0.0)
    setup = Interferometer("s", machine, direction, (x,), park, 1e-6, unknowns, *times, (0.0, 0.0), "both")
    warm = replace(setup, warmer=5.0, expansion=STRAIN / 5.0)
    at = setup.places(poses)
    hand = share * np.array([-0.35, 0.0, 0.25])
    growth, slope = setup.own_slopes(at, ["growth", "slope"])[:, 0].T
    assert growth == pytest.approx(hand, abs=1e-15)
    known = STRAIN * (hand - hand[0])  # from where the set-up is parked: the zero has the rest
    assert warm.shown(at, {})[:, 0] == pytest.approx(known, abs=1e-18)
    assert warm.shown(at, {"growth": 1e-6})[:, 0] == pytest.approx(known + 1e-6 * hand, abs=1e-18)
    assert slope == pytest.approx([-0.35, 0.0, 0.25])
