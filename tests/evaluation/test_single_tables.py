"""The check looks where each table corrects most: one that is wrong or missing fails, one not looked at is named."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.evaluation.check import Check
from axiscal.evaluation.table_checks import Judgement, parts_of, shares
from axiscal.measurement.reading import Places
from axiscal.measurement.simulation import Simulator, VirtualMachine
from axiscal.tables.loaded import Loaded
from axiscal.tables.surface import Control
from tests.evaluation.said import idle, measured, readings_of, said_of
from tests.generators.campaigns import on
from tests.generators.reaches import reach_of
from tests.generators.texts import Said, machine_text, setup_text

pytestmark = pytest.mark.long

MACHINE = machine_text(
    "w-X'-b-Y-Z-t",
    {"X": (0, 300), "Y": (0, 200), "Z": (0, 150)},
    {"EXX EYY EZZ": "20 um", "EYX": "15 um", "C0Y": "90 urad", "EXX_reversal": "8 um"},
    tool=50,
    name="Bench",
)
PROBE: dict[str, Said] = {"noise": "0.3 um", "approach": "both", "unknowns": {"zero": "100 um"}}
PROBES = [setup_text(way, "probe", direction=way, **PROBE) + reach_of(MACHINE) for way in "xyz"]
HUGE = "1 mm"


@cache
def checked(folder: Path) -> tuple[Check, VirtualMachine]:
    described = on(MACHINE, *PROBES, target={"readings": 45}, usual="off", sure="exactly")
    with Campaign.open(measured(folder / "bench.axiscal", described, 8), write=False) as campaign:
        return Check.from_campaign(campaign, "csv"), Simulator(described.machine, described.setups).drawn(8)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("single")


def judged(check: Check, truth: VirtualMachine, places: Places, loaded: Control, tolerance: str = HUGE) -> Judgement:
    setups = check.description.setups
    found, left = (readings_of(setups, truth, places, each, seed) for seed, each in ((1, idle), (2, loaded)))
    return check.judged((found, left), tolerance)


def with_share(check: Check, name: str, share: float) -> Control:
    """Return the tables with one of them loaded so many times: 0 is a missing file, -1 one with the wrong sign."""
    (table,) = (t for t in check.tables.tables if name == (t.axis if t.axis == t.over else f"{t.axis} over {t.over}"))
    alone = Loaded((table,)).control(check.estimate.machine)
    return lambda poses, ways: check.tables.control(poses, ways) + (share - 1) * alone(poses, ways)


def test_every_table_is_read_at_its_ends_and_where_it_corrects_most(folder: Path) -> None:
    check, _ = checked(folder)
    places = check.planned()
    for table in check.tables.tables:
        over, along = check.estimate.machine.index(table.over), "XYZ".index(table.axis)
        mine = places.poses[[abs(check.description.setups[s].direction[along]) > 0.9 for s in places.setups]][:, over]
        low, high = check.estimate.box[over]
        at = np.linspace(low, high, 301)
        most = at[np.argmax(np.abs(table.deviation(at, 1)))]
        for wanted in (low, high, most):
            assert np.min(np.abs(mine - wanted)) < 0.1 * (high - low), (table.axis, table.over, wanted)
    x = places.approaches[[check.description.setups[s].name == "x" for s in places.setups]][:, 0]
    assert set(x.tolist()) == {1.0, -1.0}


def test_all_tables_loaded_pass_and_are_all_checked(folder: Path) -> None:
    check, truth = checked(folder)
    judgement = judged(check, truth, check.planned(), check.tables.control)
    assert judgement.verdict == "promised"
    assert {share.name for share in judgement.shares if share.checked} >= {"X", "Y", "Z", "Y over X", "reversal of X"}
    assert judgement.idle == ()
    assert "Not checked: positioning" not in said_of(judgement)
    for share in judgement.shares:
        assert not share.checked or abs(share.value - 1) < 5 * share.std + 0.05


@pytest.mark.parametrize("name", ["X", "Y", "Z", "Y over X", "X over Y"])
@pytest.mark.parametrize(("share", "cause"), [(-1.0, "wrong sign"), (0.0, "was not loaded")])
def test_a_single_table_that_is_wrong_or_missing_fails_whatever_the_tolerance(
    folder: Path, name: str, share: float, cause: str
) -> None:
    check, truth = checked(folder)
    judgement = judged(check, truth, check.planned(), with_share(check, name, share))
    assert (judgement.verdict, judgement.decision) == ("faulty", "conform")
    faulty = [each.name for each in judgement.faulty]
    assert name in faulty
    assert set(faulty) <= {name, f"reversal of {name}"}
    text = said_of(judgement)
    assert cause in text
    assert f"not as exported: {', '.join(faulty)}" in text


def test_a_reversal_that_is_missing_fails(folder: Path) -> None:
    check, truth = checked(folder)
    means = [table.averaged() for table in check.tables.tables]
    judgement = judged(check, truth, check.planned(), Loaded(tuple(means)).control(check.estimate.machine))
    assert [each.name for each in judgement.faulty] == ["reversal of X"]
    assert judgement.verdict == "faulty"


def test_tables_that_were_not_looked_at_are_named_beside_the_verdict(folder: Path) -> None:
    check, truth = checked(folder)
    places = check.planned()
    along_x = places.within(np.array([check.description.setups[s].name == "x" for s in places.setups]))
    judgement = judged(check, truth, along_x, check.tables.control)
    assert judgement.verdict != "faulty"
    unchecked = {share.name for share in judgement.shares if not share.checked}
    assert {"Y", "Z", "Y over X"} <= unchecked
    assert judgement.idle == ("Y", "Z")
    assert "X" not in unchecked
    text = said_of(judgement)
    assert "Not checked: positioning Y Z" in text
    assert text.index("PROMISED") < text.index("Not checked")
    missing = judged(check, truth, along_x, with_share(check, "Z", 0.0))
    assert missing.verdict != "faulty"
    assert not next(share for share in missing.shares if share.name == "Z").checked


def test_shares_are_the_least_squares_of_the_change(folder: Path) -> None:
    check, _ = checked(folder)
    parts = parts_of(check.estimate, check.tables)[:3]
    rng = np.random.default_rng(3)
    columns, noise = rng.normal(size=(20, 3)), rng.uniform(0.5, 2.0, 20)
    change = columns @ np.array([1.0, -1.0, 0.0]) + 0.01 * rng.normal(size=20)
    found = shares(parts, columns, change, np.diag(noise**2))
    weights = np.diag(noise**-2.0)
    normal = columns.T @ weights @ columns
    assert [share.value for share in found] == pytest.approx(np.linalg.solve(normal, columns.T @ weights @ change))
    assert [share.std for share in found] == pytest.approx(np.sqrt(np.diag(np.linalg.inv(normal))))
    twins = columns[:, [0, 0, 1]]
    assert [share.checked for share in shares(parts, twins, change, np.diag((0.01 * noise) ** 2))] == [
        False,
        False,
        True,
    ]
