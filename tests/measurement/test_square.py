"""A square lies at one turn that both of its legs share, with opposite signs: together they show squareness."""

from __future__ import annotations

import numpy as np

from axiscal.estimation.case import Case
from axiscal.measurement.reading import Places
from tests.generators.campaigns import built_in
from tests.generators.texts import Said, setup_text

SQUARE = '[[artefacts]]\nname = "square"\nturned = "1 mrad"\n'
REACHES: list[tuple[str, str, Said]] = [("X", "y", ["100 mm", "400 mm"]), ("Y", "x", ["50 mm", "350 mm"])]
LEGS = [
    setup_text(
        f"leg along {moving}",
        "straightedge",
        artefact="square",
        direction=direction,
        moves=[moving],
        reach={moving: reach},
        approach="both",
    )
    for moving, direction, reach in REACHES
]


def test_the_legs_see_the_turn_with_opposite_signs_and_it_is_one_unknown() -> None:
    case = Case(built_in(SQUARE + "".join(LEGS)))
    shared = [u for u in case.observation.setups[0].unknowns if u.owner == "square"]
    assert [u.name for u in shared] == ["square_x", "square_y", "square_z"]
    columns = [case.observation.unknowns_of(k) for k in (0, 1)]
    both = sorted(set(columns[0].tolist()) & set(columns[1].tolist()))
    assert len(both) == 3
    park = np.array(case.description.setups[0].park)
    slopes = []
    for k, name in enumerate("XY"):
        poses = np.tile(park, (2, 1))
        index = case.description.machine.index(name)
        poses[1, index] += 0.1
        seen = case.observation.numbers(Places.of_setup(k, poses, np.zeros_like(poses))).rows
        slopes.append((seen[1] - seen[0])[both] / 0.1)
    np.testing.assert_allclose(slopes[0], [0, 0, 1], atol=1e-9)
    np.testing.assert_allclose(slopes[1], [0, 0, -1], atol=1e-9)
