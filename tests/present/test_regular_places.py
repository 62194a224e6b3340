"""Places at regular distances are named with their step, others are not; odd places end it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.measurement.reading import Reading
from axiscal.present.findings import regular_places
from tests.generators.campaigns import built_in
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


def test_the_places_that_are_asked_for_end_it() -> None:
    (text,) = said_of(range(0, 1001, 100))
    odd = odd_places(text)
    assert len(odd) == 3
    assert all(0 < at < 1000 and at % 100 != 0 for at in odd)
    assert said_of([*range(0, 1001, 100), *odd]) == []


@pytest.mark.parametrize("raster", [50, 20, 5])
def test_they_are_where_the_set_up_can_be_read(raster: int) -> None:
    of = described(raster={"X": f"{raster} mm"})
    (text,) = said_of(range(0, 1001, 100), of)
    assert all(at % raster == 0 and at % 100 != 0 for at in odd_places(text))
    after = said_of([*range(0, 1001, 100), *odd_places(text)], of)
    assert [text.endswith("Its raster has no others.") for text in after] == ([] if raster == 5 else [True])


def test_where_it_can_be_read_nowhere_else_none_are_asked_for() -> None:
    (text,) = said_of(range(0, 1001, 100), described(raster={"X": "100 mm"}))
    assert text.endswith("an error of that period looks like none. Its raster has no others.")


ROTARY = built_in(
    setup_text("indexer", "autocollimator", direction="z", moves=["C"], park={"B": "0 deg"}), machine="dmu60"
)
TURNING = ROTARY.machine.index("C")


def turned(degrees: float) -> Reading:
    pose = [0.0] * len(ROTARY.machine.axes)
    pose[TURNING] = float(np.radians(degrees))
    return Reading("indexer", tuple(pose), (0,) * len(pose), 0.0)


@pytest.mark.parametrize(("step", "said"), [(10.0, "10 deg"), (22.5, "22.5 deg"), (5.625, "5.625 deg")])
def test_the_step_of_a_rotary_axis_is_named_in_degrees(step: float, said: str) -> None:
    """No multiple of a degree is a whole number of microradians."""
    readings = [turned(at) for at in np.arange(0.0, 360.1, step).tolist()]
    (found,) = regular_places(readings, ROTARY.setups, ROTARY.machine.axes)
    assert f"a multiple of {said} apart along C" in found.text
    odd = [turned(float(part.split(" deg")[0])) for part in found.text.split("C = ")[1:]]
    assert len(odd) == 3
    assert list(regular_places([*readings, *odd], ROTARY.setups, ROTARY.machine.axes)) == []
