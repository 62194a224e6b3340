"""Real controls do what our exports say, to 1 % of the correction, and take the errors of a machine away."""

import pytest

from tests.controls.fetched import MissingError
from tests.controls.zoo import CONTROLS, linuxcnc_samples

ALLOWED = 1.0
"""% of the largest correction, and of what was found."""


@pytest.mark.long
@pytest.mark.parametrize("name", CONTROLS)
def test_a_control_does_what_its_export_says(name: str) -> None:
    try:
        row = linuxcnc_samples(every=10) if name == "linuxcnc-samples" else CONTROLS[name]()
    except MissingError as why:
        pytest.skip(str(why))
    assert row.off <= ALLOWED, row
    assert row.missed <= ALLOWED, row
