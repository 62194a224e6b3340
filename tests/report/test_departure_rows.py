"""What result.json says of each departure: what readings could show of it, and what they say of it."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from axiscal.estimation.estimate import concluded
from axiscal.estimation.ruled import ruled, ruling_of
from axiscal.estimation.vouching import defended
from axiscal.planning.vouched import departure_rows
from axiscal.report.contradictions import explaining
from tests.generators.laser_axis import CASE, machine, plus, read


def test_a_row_has_the_odds_the_size_and_the_words_of_what_explains_the_readings() -> None:
    known = ruled(concluded(CASE, plus(read(machine(2), 28), 10e-6 * np.linspace(0, 1, 28))))
    rows = {row["name"]: row for row in explaining(departure_rows(CASE, defended(known)), known)}
    best = ruling_of(known).comparison.explanations[0]
    drift = rows[f"{best.family} {best.owner}"]
    assert drift["odds"] == max(row["odds"] for row in rows.values()) == pytest.approx(best.odds, rel=1e-5)
    hours = 27 * 60 / 3600
    assert rows["drift laser"]["size_um"] * hours == pytest.approx(10.0, abs=1.5)
    assert 'the zero of "laser" seems to drift' in rows["drift laser"]["words"]
    assert all(math.isfinite(row["odds"]) for row in rows.values())
    json.dumps(list(rows.values()), allow_nan=False)


def test_readings_that_were_not_asked_say_nothing() -> None:
    known = ruled(concluded(CASE, read(machine(2), 28)[:2]))
    (row,) = explaining(departure_rows(CASE, defended(known)), known)
    assert (row["name"], row["odds"], row["size_um"], row["words"]) == ("drift laser", None, None, None)
