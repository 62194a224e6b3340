"""Readings that stand in a file twice: found where they were pasted, not where chance does it."""

import numpy as np
import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.measurement.reading import Reading
from axiscal.present.findings import copies, repeated
from tests.generators.texts import campaign_text, machine_text, setup_text

NOISE = 0.5e-6
MACHINE = machine_text("w-b-X-t", {"X": (0, 1000)}, {"EXX": 'std = "10 um", length = "200 mm", knots = 9'})
CAMPAIGN = campaign_text(
    "machine.toml", setup_text("laser", "interferometer", direction="x", noise="0.5 um"), target={"readings": 20}
)


def taken(seed: int, count: int, decimals: int, noise: float = NOISE, runs: int = 1) -> list[Reading]:
    """Return readings as a display shows them: each place as often as there are runs, at a curve of 10 um."""
    rng = np.random.default_rng(seed)
    places = np.linspace(0, 1, count)
    curve = 10 * np.sin(4 * places + rng.uniform(0, 6))
    shown = [np.round(curve + rng.normal(0, noise * 1e6, count), decimals) for _ in range(runs)]
    return [
        Reading("laser", (float(x),), (1,), float(value) * 1e-6, line=None)
        for values in shown
        for x, value in zip(places, values, strict=True)
    ]


def test_a_block_that_was_pasted_again_elsewhere_is_found() -> None:
    readings = taken(2, 24, 3)
    pasted = [
        Reading("laser", here.pose, (1,), of.value) for here, of in zip(readings[14:19], readings[5:10], strict=True)
    ]
    found = repeated([*readings[:14], *pasted, *readings[19:]], NOISE)
    assert found == (5, 14, 5)


@pytest.mark.parametrize(("decimals", "noise"), [(2, NOISE), (1, NOISE), (0, NOISE), (0, 2e-6), (1, 0.1e-6)])
def test_right_files_are_not_taken_for_copies(decimals: int, noise: float) -> None:
    files = [taken(seed, 12, decimals, noise, runs=5) for seed in range(400)]
    assert sum(repeated(each, noise) is not None for each in files) == 0  # one of 10,000 may be


def test_each_set_up_is_looked_at_by_itself() -> None:
    second = CAMPAIGN.partition("[[setups]]")[2].replace('"laser"', '"again"')
    described = campaign_from_texts(f"{CAMPAIGN}[[setups]]{second}", "campaign.toml", MACHINE, "machine.toml")
    once = taken(7, 12, 2)
    elsewhere = [Reading("again", each.pose, each.approach, each.value) for each in once]
    assert list(copies([*once, *elsewhere], described.setups)) == []
    (found,) = copies([*once, *once, *elsewhere], described.setups)
    assert (found.code, found.error) == ("copies", None)
    assert '12 values of "laser" in its readings 13 to 24 repeat those in its readings 1 to 12' in found.text
