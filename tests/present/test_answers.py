"""What is typed at the prompt."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.description.campaign import campaign_from_texts
from axiscal.exceptions import AxiscalError
from axiscal.machine import load_machine
from axiscal.measurement.setup import Setup
from axiscal.present.guide.question import measured
from tests.generators.texts import campaign_text, setup_text

SETUPS = campaign_text(
    "three-axis-mill",
    setup_text("dial", "indicator", direction="-y"),
    setup_text("level", "level", direction="x"),
    setup_text("nest", "rtest", station=["0 mm", "0 mm", "-300 mm"]),
    target={"readings": 1},
)


def setup(name: str) -> Setup:
    """Return one of the set-ups."""
    return campaign_from_texts(SETUPS, "campaign.toml", load_machine("three-axis-mill").text, "mill").setup(name)


DIAL, LEVEL, NEST = setup("dial"), setup("level"), setup("nest")


def test_angles_are_in_microradians() -> None:
    values = [measured(text, LEVEL)[0] for text in ("4 arcsec", "19.39")]
    np.testing.assert_allclose(values, [4 / 3600 / 180 * np.pi, 19.39e-6], rtol=1e-12)


@pytest.mark.parametrize(
    "text",
    [
        *("1.2 -0.4 0.8", "1,2 -0,4 0,8", "1.2; -0.4; 0.8", "1.2, -0.4, 0.8", "1.2um -0.4um 0.8 um"),
        *("0.0012 -0.0004 0.0008 mm", "1.2um,-0.4um,0.8um", "0.0012 -4e-4 8e-4 mm", "1.2; -0.4; 0.8 um"),
        "0.0012 mm, -0.0004 mm, 0.0008 mm",
    ],
)
def test_three_values_stand_in_one_line_and_a_unit_after_the_last_is_of_all(text: str) -> None:
    np.testing.assert_allclose(measured(text, NEST), [1.2e-6, -0.4e-6, 0.8e-6], rtol=1e-12)


@given(st.text(max_size=30))
def test_nothing_typed_is_a_traceback(text: str) -> None:
    for where in (DIAL, LEVEL, NEST):
        try:
            typed = measured(text, where)
        except AxiscalError:
            continue
        assert np.all(np.isfinite(typed))
