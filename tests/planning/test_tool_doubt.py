"""What a tool that nobody measured hides, against dense posteriors with and without it, and what is said of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.errors.gauge import MANY_READINGS, Hidden, unseen_factor
from axiscal.estimation.case import Case
from axiscal.language.spoken import speaking
from axiscal.measurement.observation import Observation
from axiscal.numerics import Array
from axiscal.planning.unseen import hidden_of, tool_doubt
from benchmarks.trust.benches import case_of

TOOL = {"tool_x", "tool_y", "tool_z"}


def five_axes(tool: str) -> Case:
    """Return five axes under an R-test whose tool is known so well."""
    return case_of("five axes", "stated", (("TOOL", tool),))


def told(case: Case, rows: Array | None = None, observation: Observation | None = None) -> list[Hidden]:
    """Return what is said of the tool of a case.  rows : readings over their noise, all that are allowed without"""
    seen = case.allowed_rows()[0] if rows is None else rows
    return list(tool_doubt(observation or case.observation, case.yardstick, case.prior.factor, seen))


def unseen(case: Case, rows: Array, tool_known: bool) -> float:
    """Return the RMS over the volume, m, that a million readings leave, by the gain written out."""
    covariance = case.prior.covariance
    if tool_known:
        for column, unknown in enumerate(case.observation.unknowns, start=case.errors.size):
            if unknown.name in TOOL:
                covariance[column, :] = covariance[:, column] = 0.0
    spread = rows @ covariance @ rows.T * MANY_READINGS / len(rows) + np.eye(len(rows))
    cross = covariance @ rows.T * np.sqrt(MANY_READINGS / len(rows))
    left = covariance - cross @ np.linalg.solve(spread, cross.T)
    size = case.errors.size
    factor = np.linalg.cholesky(left[:size, :size] + 1e-22 * np.eye(size))
    return replace(case.yardstick, unseen=factor).unseen_rms


def test_it_hides_what_an_exactly_known_tool_would_show() -> None:
    case = five_axes("100 um")
    rows = case.allowed_rows()[0]
    (found,) = told(case)
    whole, left = (unseen(case, rows, known) for known in (False, True))
    assert case.yardstick.unseen_rms == pytest.approx(whole, rel=0.01)
    assert found.effect == pytest.approx(np.sqrt(whole**2 - left**2), rel=0.01)
    assert f"{found.effect * 1e6:.2g} um of the {case.yardstick.unseen_rms * 1e6:.2g} um" in found.text
    assert found in hidden_of(case)


def test_it_is_said_from_a_tenth_of_the_variance_on() -> None:
    """The share grows with what is not known of the tool: below a tenth nothing is said, and above it something."""
    shares = []
    for tool in ("0.7 um", "1 um", "1.5 um", "3 um", "4 um"):
        case = five_axes(tool)
        rows = case.allowed_rows()[0]
        whole, left = (unseen(case, rows, known) for known in (False, True))
        share = 1 - left**2 / whole**2
        shares.append(share)
        assert abs(share - 0.1) > 0.01
        assert bool(told(case, rows)) == (share > 0.1)
    assert min(shares) < 0.1 < max(shares)


@pytest.mark.parametrize(
    ("unknowns", "said", "remedy"),
    [
        (
            [("tool_x", 5e-6, "tool"), ("tool_y", 6e-6, "tool"), ("tool_z", 9e-6, "tool")],
            "A tool of another length (known to 9 um) or that sits aside (known to 6 um) looks like",
            'tool_length = "5 um" and tool_eccentricity; write "0 um" if',
        ),
        (
            [("tool_x", 7e-6, ""), ("tool_y", 5e-6, "")],
            "A tool that sits aside (known to 7 um) looks like",
            'tool_x, tool_y, tool_z under unknowns, such as tool_z = "5 um"',
        ),
    ],
)
def test_what_is_not_known_of_it_is_said_and_where_to_state_it(
    unknowns: list[tuple[str, float, str]], said: str, remedy: str
) -> None:
    case = five_axes("100 um")
    setup = case.description.setups[0]
    known = {unknown.name: unknown for unknown in case.observation.unknowns}
    kept = tuple(replace(known[name], std=std, owner=owner) for name, std, owner in unknowns)
    observation = Observation(case.errors, (replace(setup, unknowns=kept),))
    size, moved = case.errors.size, case.errors.by_name["Z0B"].columns.start
    open_ones = np.zeros(size + len(kept))
    open_ones[[moved, *range(size, size + len(kept))]] = 20e-6
    rows = 1e6 * np.eye(size + len(kept))[size:]
    rows[:, moved] = 1e6  # each shows the sum of where an axis lies and of one unknown of the tool
    factor = np.diag(open_ones)
    seen = replace(case.yardstick, unseen=unseen_factor(factor, rows)[:size])
    (found,) = tool_doubt(observation, seen, factor, rows)
    assert found.text.startswith(said)
    assert remedy in found.text
    assert found.text.endswith(".")
    with speaking("de"):
        (found,) = tool_doubt(observation, seen, factor, rows)
    assert found.text.startswith("Ein Werkzeug ander")
    assert "Das Werkzeug messen und angeben, wie genau es bekannt ist" in found.text
