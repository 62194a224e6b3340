"""Figures of one result that say one thing are one figure: of all golden results, and of campaigns that seeds draw.

They are read back from `result.json` and from what a person reads of it, as an outsider would.
"""

import json
import math
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import redirect_stderr, redirect_stdout
from functools import cache
from io import StringIO
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from scipy.stats import chi2

from axiscal.campaign.campaign import Campaign
from axiscal.cli.app import run
from axiscal.present.result_set import RECORD
from tests.generators.drawn_campaigns import written
from tests.golden.__main__ import EXPECTED

Document = dict[str, Any]
ROUNDED = 1e-4
"""Of figures that are written with six digits, some of which follow from others."""
SPREAD = 1.03
"""By how much the spread of estimates over drawn sizes widens what readings leave: by 2.4 % at most, of 200 seeds."""
QUICK, SEEDS = 2, 6
"""Campaigns that every test run draws, and with those of a longer run."""


class Result(NamedTuple):
    """name : of whose result; document : `result.json`; said : what is printed with `--details`, "" where unknown

    record : what it is of; None where only the document is kept
    """

    name: str
    document: Document
    said: str = ""
    record: Path | None = None


@cache
def golden() -> tuple[Result, ...]:
    """Return every golden result in which an uncertainty is printed."""
    read = ((path, json.loads(path.read_text(encoding="utf-8"))) for path in sorted(EXPECTED.rglob("result.json")))
    each = ((path, found) for path, found in read if "as" not in found and found["U_um"] is not None)
    return tuple(Result(str(path.relative_to(EXPECTED)), found) for path, found in each)


def _listed(found: Any) -> list[Any]:
    """Return a list, of a long one in a golden result what is kept of it."""
    kept: list[Any] = found["values"] if isinstance(found, dict) else found
    return kept


def _near(first: float, second: float, slack: float = ROUNDED) -> bool:
    return math.isclose(first, second, rel_tol=slack, abs_tol=1e-6)


def positioning_is_the_volume_on_one_axis(result: Result) -> Iterator[str]:
    """Where errors along one axis, of that axis, are all that is described."""
    document, ways = result.document, {re.sub("_.*", "", name) for name in result.document["errors"]}
    alone = [way for way in ways if len(ways) == 1 and re.fullmatch(r"E([XYZ])\1", way)]
    ours = {row["row"]: row for row in document["rows"]}
    row, volume = ours.get(f"positioning {alone[0][-1]}" if alone else ""), ours.get("volume")
    if row is None or volume is None or document["plane_errors"]:
        return
    for name in ("known_to", "known_before", "floor", "found", "largest", "left"):
        if row[name] != volume[name]:
            yield f"{name}: {row[name]} and {volume[name]}"


def k_is_that_of_a_sum_of_squares(result: Result) -> Iterator[str]:
    """Between the factor of as many equal directions as count and that of a figure whose size is hardly known."""
    ways = sum(each > 1e-6 for each in result.document["U_axis_um"].values()) or 1
    if not math.sqrt(chi2.ppf(0.95, ways) / ways) * 0.99 <= result.document["k"] <= 2.9:
        yield f"k = {result.document['k']}"


def what_endless_readings_leave_is_the_least(result: Result) -> Iterator[str]:
    for row in result.document["rows"]:
        if row["floor"] > row["known_to"] * (1 + ROUNDED):
            yield f"{row['row']}: at best {row['floor']}, now {row['known_to']}"


def no_row_is_known_less_than_before(result: Result) -> Iterator[str]:
    """Nor than type B leaves it: with gain g readings leave (1 − g) before² + g² b², of which b is at best."""
    for row in result.document["rows"]:
        if row["known_to"] > max(row["known_before"], row["floor"]) * SPREAD:
            yield f"{row['row']}: now {row['known_to']}, before {row['known_before']}, at best {row['floor']}"


def no_curve_is_known_less_than_before(result: Result) -> Iterator[str]:
    """But for what type B adds, which no reading improves."""
    for name, curve in result.document["errors"].items():
        now, before = (math.hypot(*_listed(curve[key])) for key in ("std", "prior_std"))
        if now > before * SPREAD and not (result.record and _is_of_type_b(result.record, name)):
            yield f"{name}: now {now}, before {before}"


def _is_of_type_b(record: Path, name: str) -> bool:
    """Return whether readings alone leave less of a curve than there was before."""
    with Campaign.open(record, write=False) as campaign:
        known = campaign.estimate(ended=True)
    curve = known.case.errors.by_name[name]
    rows = curve.spline.rows(np.linspace(*known.case.errors.axes[curve.axis].travel, 101))
    beliefs = (known.of_readings, known.without_readings)
    now, before = (np.linalg.norm(rows @ belief.factor[curve.columns]) for belief in beliefs)
    return bool(now <= before * SPREAD)


def one_uncertainty_of_one_thing(result: Result) -> Iterator[str]:
    document, rows = result.document, {row["row"]: row for row in result.document["rows"]}
    pairs = {"k u and U": (document["k"] * document["rms_um"], document["U_um"])}
    if "volume" in rows:
        pairs["row of the volume and U"] = rows["volume"]["known_to"], document["U_um"]
    if document["history"]:
        pairs["last of the history and u"] = _listed(document["history"])[-1]["rms_um"], document["rms_um"]
    of_volume = {"rms": document["rms_um"], "worst": document["worst_um"], "U": document["U_um"]}
    for aim in document["answer"]["aims"]:
        known = of_volume.get(aim["name"]) or rows[aim["name"]]["known_to"]
        pairs[f"aim {aim['name']}"] = aim["now"], known
    for row in rows.values():
        if len(row.get("signed", [])) == 1:  # no document of an earlier version has them
            pairs[f"sign of {row['row']}"] = row["signed"][0]["U"], row["known_to"]
    yield from (f"{name}: {first} and {second}" for name, (first, second) in pairs.items() if not _near(first, second))


def squares_of_the_sources_add_up(result: Result) -> Iterator[str]:
    sources, u = [source["rms_um"] for source in result.document["budget"]], result.document["rms_um"]
    if sources and not _near(math.hypot(*sources), u, 2e-3):  # sources below 0.0005 of the square are left out
        yield f"√(sum of squares) = {math.hypot(*sources)}, u = {u}"


def no_source_is_larger_than_the_whole(result: Result) -> Iterator[str]:
    for source in result.document["budget"]:
        if source["rms_um"] > result.document["rms_um"] * (1 + ROUNDED):
            yield f"{source['source']}: {source['rms_um']}, u = {result.document['rms_um']}"


def tables_leave_what_is_not_known_and_what_they_do_not_hold(result: Result) -> Iterator[str]:
    """u² and U² with the tables are those without, and what the files leave."""
    u, whole = result.document["rms_um"], result.document["U_um"]
    for name, table in {each["controller"]: each for each in result.document["tables"] if each["file"]}.items():
        left, expected = table["after_um"], table["expected_um"]
        if not _near(expected, math.hypot(u, left), 1e-2):
            yield f"{name}: expected {expected}, u = {u}, left {left}"
        if not _near(table["U_um"], math.hypot(whole, result.document["k"] * left), 1e-2):
            yield f"{name}: U = {table['U_um']}, without files {whole}, left {left}"


def a_way_that_no_error_takes_has_no_uncertainty(result: Result) -> Iterator[str]:
    """Of machines that describe displacements alone: without rotary axes they go no other way."""
    names = [*result.document["errors"], *result.document["plane_errors"]]
    names += [name for name in result.document["constants"] if ": " not in name]
    ways = {re.sub("^E?", "", name)[0].lower() for name in names}
    if not ways <= set("xyz"):
        return
    for way in sorted(set("xyz") - ways):
        if result.document["U_axis_um"][way] > 1e-6:
            yield f"U along {way} = {result.document['U_axis_um'][way]}"
        if f"U along {way}" in result.said:
            yield f"U along {way} is printed"


Identity = Callable[[Result], Iterator[str]]
EACH: tuple[Identity, ...] = (
    positioning_is_the_volume_on_one_axis,
    one_uncertainty_of_one_thing,
    a_way_that_no_error_takes_has_no_uncertainty,
    what_endless_readings_leave_is_the_least,
    no_row_is_known_less_than_before,
    no_curve_is_known_less_than_before,
    k_is_that_of_a_sum_of_squares,
    squares_of_the_sources_add_up,
    no_source_is_larger_than_the_whole,
    tables_leave_what_is_not_known_and_what_they_do_not_hold,
)


def broken(identity: Identity, results: Sequence[Result]) -> list[str]:
    """Return where an identity does not hold."""
    return [f"{result.name}: {what}" for result in results for what in identity(result)]


@pytest.mark.parametrize("identity", EACH)
def test_it_holds_in_every_golden_result(identity: Identity) -> None:
    assert broken(identity, golden()) == []


def drawn(seed: int, folder: Path) -> Result:
    """Return the result of a campaign that a seed draws, as commands give it."""
    campaign, readings = written(seed, folder)
    with redirect_stdout(StringIO()) as said, redirect_stderr(StringIO()):
        run(["data", "estimate", str(campaign), str(readings), "--out", str(folder / "out"), "--details"])
    document = json.loads((folder / "out" / "result.json").read_text("utf-8"))
    return Result(f"seed {seed}", document, said.getvalue(), folder / "out" / RECORD)


@pytest.fixture(
    scope="module", params=[range(QUICK), pytest.param(range(QUICK, SEEDS), marks=pytest.mark.long)], ids=str
)
def campaigns(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> list[Result]:
    """Return what seeds draw, those left out whose uncertainty is withheld."""
    found = [drawn(seed, tmp_path_factory.mktemp(f"seed{seed}")) for seed in request.param]
    return [result for result in found if result.document["U_um"] is not None]


@pytest.mark.parametrize("identity", EACH)
def test_it_holds_in_campaigns_that_seeds_draw(identity: Identity, campaigns: list[Result]) -> None:
    assert broken(identity, campaigns) == []
