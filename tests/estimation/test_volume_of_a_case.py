"""What a case measures over, what is seen of it from which sides, and what each source leaves of it."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from scipy.linalg import block_diag

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.budget import budget
from axiscal.estimation.case import NO_GOAL, Case
from axiscal.estimation.estimate import concluded
from axiscal.measurement.reading_rows import seen
from tests.generators.campaigns import CAMPAIGN, built_in, drawn
from tests.generators.texts import machine_text

WARM = 'temperature = "23 degC"\ntemperature_std = "1 K"\nexpansion = "11.7 um/m/K"\n'


def test_each_source_is_what_its_part_of_the_prior_leaves() -> None:
    """By the gain K of all readings: V (I − KH) B with B Bᵀ the part of the prior, noise by V K of its readings."""
    exact = CAMPAIGN.replace("\n", '\nusual = "off"\nsure = "exactly"\n', 1).replace("3 um/h", "0 um/h")
    case = Case(built_in(exact.replace('"probe"\n', f'"probe"\n{WARM}', 1)))
    known = concluded(case, drawn(case, 30))
    observation, size = known.knowledge.observation, case.errors.size
    (numbers, _), state = seen(observation, known.readings), known.knowledge.state(NO_GOAL)
    rows, rests = state.wide(numbers), observation.rests[state.cells[:, 0]]
    prior = block_diag(observation.prior_covariance(), np.diag(rests**2))
    noise = numbers.noise**2 + np.sum(state.unread(numbers) ** 2, axis=1)
    gain = prior @ rows.T @ np.linalg.inv(rows @ prior @ rows.T + np.diag(noise))
    tool = np.zeros((len(case.yardstick.root), len(prior)))
    tool[:, :size] = case.yardstick.root
    kept = tool @ (np.eye(len(prior)) - gain @ rows)

    def of(columns: Sequence[int]) -> float:
        own = prior[np.ix_(columns, columns)]
        left = kept[:, list(columns)]
        return float(np.sqrt(np.trace(left @ own @ left.T)))

    found = {(share.kind, share.setup): share.rms for share in budget(known)}
    for name in ("probe", "nest"):
        mine = np.array([known.readings[int(i)].setup == name for i in numbers.place])
        passed = tool @ gain[:, mine] * np.sqrt(noise[mine])
        assert found["instrument", name] == pytest.approx(float(np.linalg.norm(passed)), rel=1e-4)
    unknowns = range(size, size + len(observation.unknowns))
    cells = range(observation.size, len(prior))
    growth = size + [unknown.name for unknown in observation.unknowns].index("growth")
    assert found["temperature", ""] == pytest.approx(of([growth]), rel=1e-4)
    assert found["set-up", ""] == pytest.approx(of([each for each in unknowns if each != growth]), rel=1e-4)
    assert found["drift", ""] == 0.0
    rest = known.case.yardstick.rest
    assert found["detail", ""] == pytest.approx(np.sqrt(of(cells) ** 2 + rest), rel=1e-4)
    sized = known.case.yardstick_as_sized
    never = float(np.linalg.norm(sized.root @ sized.unseen))  # shifts that do not count too
    assert found["prior", ""] == pytest.approx(np.sqrt(of(range(size)) ** 2 - never**2), rel=1e-4)
    assert found["unseen", ""] == pytest.approx(sized.unseen_rms)
    assert found["artefact", ""] == 0.0
    assert known.posterior is not None
    disagreeing = replace(known.posterior.agreement, count=30, c2=4.0)
    wide = budget(replace(known, posterior=replace(known.posterior, agreement=disagreeing)))
    assert next(share.rms for share in wide if share.setup == "probe") == pytest.approx(
        2 * found["instrument", "probe"]
    )


@pytest.mark.parametrize("middle", [0, -250, 2000])
def test_where_the_zero_of_the_machine_lies_is_no_matter(middle: int) -> None:
    """Readings that see a squareness see how far it moves the volume; they still do not see where the volume lies."""
    errors = dict.fromkeys(("EXX", "EYX", "EXY", "EYY"), 'std = "20 um", knots = 5, length = "100 mm"')
    machine = machine_text("w-b-Y-X-t", {"X": (0, 200), "Y": (middle - 110, middle + 110)}, errors | {"C0Y": "1 mrad"})
    setups = "".join(
        f'[[setups]]\nname = "{way} along {axis}"\ninstrument = "indicator"\ndirection = "{way}"\nmoves = ["{axis}"]\n'
        'unknowns = { zero = "1 mm" }\n'
        for way, axis in product("xy", "XY")
    )
    text = f'machine = "machine.toml"\nusual = "off"\n[target]\nreadings = 9\naligned = false\n{setups}'
    assert Case(campaign_from_texts(text, "campaign.toml", machine, "machine.toml")).yardstick.zeroed == (
        True,
        True,
        False,
    )
