"""A period that places do not see is named, with three places that see it, and of others there is no word."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.present.findings import regular_places
from tests.generators.texts import Said, campaign_text, machine_text, setup_text


def described(**laser: Said) -> CampaignDescription:
    return campaign_from_texts(
        campaign_text("m", setup_text("laser", "interferometer", direction="x", **laser), target={"readings": 9}),
        "c.toml",
        machine_text("w-b-X-t", {"X": (0, 1000)}, {"EXX": "10 um"}),
        "m",
    )


DESCRIBED = described()


def said_of(millimetres: Sequence[float], of: CampaignDescription = DESCRIBED) -> list[str]:
    readings = [Reading("laser", (at / 1e3,), (1,), 0.0) for at in millimetres]
    return [each.text for each in regular_places(readings, of.setups, of.machine.axes)]


def odd_places(text: str) -> list[float]:
    return [float(part.split(" mm")[0]) for part in text.split("X = ")[1:]]


def told_apart(places: Sequence[float], period: float) -> float:
    """Return what is left of a wave of amplitude one without its mean, a sum of squares, the mean over its phases."""
    waves = [
        np.sin(2 * np.pi * np.array(places) / period + phase) for phase in np.linspace(0, np.pi, 60, endpoint=False)
    ]
    return float(np.mean([len(wave) * np.var(wave) for wave in waves]))


@pytest.mark.parametrize(
    ("places", "period"),
    [
        (np.linspace(10, 990, 12).round(3), 89.09),
        (np.linspace(10, 990, 12).round(), 89.13),
        (np.arange(0, 1001, 100), 100),
        (np.arange(0, 1001, 25), 25),
        (np.arange(0, 1001, 250), 83.33),
        (np.arange(0, 401, 2.5), 2.5),
    ],
)
def test_a_period_that_places_do_not_see_is_named_and_the_places_that_are_asked_for_end_it(
    places: Array, period: float
) -> None:
    (text,) = said_of(places.tolist())
    assert f"comes again every {period:g} mm or in a part of it" in text
    assert told_apart(places.tolist(), period) < 0.01
    odd = odd_places(text)
    assert len(odd) == 3
    assert all(0 < at < 1000 for at in odd)
    assert all(
        told_apart([*places.tolist(), *odd], period / part) > 0.01 * len(places)
        for part in (1, 2, 3)
        if period > 2 * part
    )
    assert said_of([*places.tolist(), *odd]) == []


def test_of_right_places_there_is_no_word() -> None:
    """Places at whole millimetres, as plans have them: none by chance, of few places one in ten."""
    rng = np.random.default_rng(5)
    for count, most in ((5, 3), (8, 1), (12, 0), (24, 0)):
        drawn = [rng.uniform(0, 1000, count).round().tolist() for _ in range(20)]
        assert sum(bool(said_of(each)) for each in drawn) <= most
