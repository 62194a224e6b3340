"""What a type has taught, to the letter; its beliefs, and which of several foretells readings, written out."""

from __future__ import annotations

import json
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from axiscal.description.type_text import Learned, SisterRecord, TypePrior, is_type_text, type_prior
from axiscal.description.usual import NONE_VARY
from axiscal.errors.model import ErrorModel
from axiscal.estimation.case import Rival
from axiscal.estimation.data_equation import data_equation
from axiscal.estimation.membership import shares_of_rivals
from axiscal.estimation.promise.problem import Inherited, problem
from axiscal.estimation.type_prior import rivals
from axiscal.exceptions import RecordError
from axiscal.machine import machine_from_text
from axiscal.numerics import Array
from tests.generators.campaigns import drawn, mixed
from tests.generators.dense_posterior import Dense
from tests.generators.laser_axis import CASE, machine, read
from tests.generators.texts import machine_text

TEXT = machine_text(
    "w-X'-b-Y-t",
    {"X": (0, 400), "Y": (0, 300)},
    {"EXX": ("10 um", 4, 200), "EYY": ("8 um", 5, 100), "EXX_reversal": "2 um", "C0Y": "30 urad"},
)
ERRORS = ErrorModel(machine_from_text(TEXT))
SIZE = ERRORS.size
LEARNED = {"EXX": Learned(0.25, 0.1, 0.5, 0.2), "C0Y": Learned(3.0, 0.0, 1.0, 0.0)}


def taught() -> TypePrior:
    """Return a type whose numbers are any."""
    rng = np.random.default_rng(1)
    root, half = 5e-6 * rng.standard_normal((2, SIZE, SIZE))
    records = (SisterRecord("a.axiscal", "12", 30), SisterRecord("b.axiscal", "34", 0, "it has no readings"))
    common, own = root @ root.T, half @ half.T
    return TypePrior(TEXT, records, LEARNED, 3, 0.1, 1e-6 * rng.standard_normal(SIZE), common + own, own)


def test_a_text_says_all_of_it_to_the_last_bit_and_again() -> None:
    found = taught()
    again = type_prior(found.text())
    for name in ("mean", "covariance", "own"):
        assert np.array_equal(getattr(again, name), getattr(found, name))
    for name in ("machine_text", "records", "learned", "directions", "doubt", "fine_knots"):
        assert getattr(again, name) == getattr(found, name)
    assert again.text() == found.text()
    assert type_prior(replace(found, fine_knots=True).text()).fine_knots
    assert [record.file for record in found.counted] == ["a.axiscal"]
    assert is_type_text(found.text())
    assert not is_type_text(json.dumps({"created": {}}))


def changed(change: Callable[[dict[str, Any]], object], digest: bool = False) -> str:
    """Return the text after a change.  digest : the one of before stays"""
    document = json.loads(taught().text())
    if not digest:
        del document["digest"]
    change(document)
    return json.dumps(document)


def test_a_text_without_a_digest_is_as_it_was_and_one_that_does_not_fit_is_refused() -> None:
    for digest in (False, True):
        assert type_prior(changed(lambda _: None, digest=digest)).doubt == 0.1
    with pytest.raises(RecordError, match="its digest does not fit"):
        type_prior(changed(lambda document: document.update(doubt=0.2), digest=True))


def learned(**fields: float) -> Callable[[dict[str, Any]], object]:
    """Return what changes what was learnt of one error."""
    return lambda document: document["learned"]["EXX"].update(fields)


def values(**fields: object) -> Callable[[dict[str, Any]], object]:
    """Return what changes fields of the document."""
    return lambda document: document.update(fields)


SIZE_OF, DOUBT, FILE = "no size above zero", "no doubt between 0 and 1", "no file with a digest and a count"


@pytest.mark.parametrize(
    ("change", "said"),
    [
        *((learned(share=share), "") for share in (0.0, 1.0)),
        *((learned(share=share), SIZE_OF) for share in (-1e-300, 1.0 + 1e-15, np.nan)),
        *((learned(scale=scale), "") for scale in (1e-300, 1e300)),
        *((learned(scale=scale), SIZE_OF) for scale in (0.0, -1.0, np.inf, np.nan)),
        (learned(scale_std=0.0, share_std=0.0), ""),
        *((learned(scale_std=std), SIZE_OF) for std in (-1e-300, np.inf, np.nan)),
        *((learned(share_std=std), SIZE_OF) for std in (-1e-300, np.inf, np.nan)),
        *((values(doubt=doubt), "") for doubt in (1e-300, 1 - 1e-16)),
        *((values(doubt=doubt), DOUBT) for doubt in (0.0, 1.0, -0.1, np.nan)),
        *((values(**{name: left}), "") for name, left in (("fine_knots", True), ("records", []), ("learned", {}))),
        (values(mean=[0.0] * (SIZE - 1)), "a triangle of"),
        (values(mean=[0.0] * (SIZE - 1) + [np.inf]), "all of them finite"),
        (values(schema="axiscal-type/2"), "of the form"),
        (values(own="####"), "cannot be read"),
        (values(own=""), "a triangle of"),
        *((lambda document, each=each: document["records"][0].update(each), FILE)
          for each in ({"readings": 1.5}, {"digest": None})),
        (lambda document: document.pop("doubt"), "cannot be read"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_refused_and_what_just_can_be_is_read(
    change: Callable[[dict[str, Any]], object], said: str
) -> None:
    with pytest.raises(RecordError, match=said) if said else nullcontext():
        type_prior(changed(change))


@pytest.mark.parametrize("name", ["covariance", "own"])
def test_a_matrix_that_is_no_covariance_is_refused(name: str) -> None:
    found = taught()
    matrix = getattr(found, name).copy()
    values, vectors = np.linalg.eigh(matrix)
    for least, refused in ((0.0, nullcontext()), (-0.1, pytest.raises(RecordError, match="is none"))):
        bent = (vectors * np.r_[least * values[-1], values[1:]]) @ vectors.T
        with refused:
            type_prior(replace(found, **{name: (bent + bent.T) / 2}).text())


@pytest.mark.parametrize(("doubt", "told"), [(None, 0.1), (0.4, 0.4)])
def test_the_beliefs_are_those_of_the_first_lines_of_the_module(doubt: float | None, told: float) -> None:
    found, stated = taught(), ERRORS.prior_covariance()
    along_x, along_y = (_where(stated, *names) for names in (("EXX", "EXX_reversal"), ("EYY", "C0Y")))
    sized = stated + sum((each.scale - 1) * _where(stated, name) for name, each in LEARNED.items())
    expected = {
        "like its sisters": (1 - told, found.mean, found.covariance),
        "like its sisters, and 2.4 times as far from them": (0.3 * told, found.mean, 6.0 * found.covariance),
        "like its sisters but for X": (0.15 * told, found.mean, found.covariance + along_x),
        "like its sisters but for Y": (0.15 * told, found.mean, found.covariance + along_y),
        "as stated, in the sizes of its type": (0.2 * told, np.zeros(SIZE), sized),
        "as stated, and up to twice as large": (0.2 * told, np.zeros(SIZE), 4.0 * stated),
    }
    side_by_side = rivals(found, ERRORS, doubt)
    assert [rival.name for rival in side_by_side] == list(expected)
    assert sum(rival.weight for rival in side_by_side) == pytest.approx(1.0, abs=1e-15)
    for rival in side_by_side:
        weight, mean, covariance = expected[rival.name]
        assert rival.weight == pytest.approx(weight)
        assert np.abs(rival.belief.mean - mean).max() < 1e-12
        assert np.abs(rival.belief.covariance - covariance).max() < 1e-15


def _where(matrix: Array, *names: str) -> Array:
    """Return what of a matrix stands between the unknowns of the same of these errors."""
    kept = np.zeros_like(matrix)
    for name in names:
        columns = next(term.columns for term in ERRORS.terms if term.name == name)
        kept[columns, columns] = matrix[columns, columns]
    return kept


@pytest.mark.parametrize("seed", [3, 5, 6])
def test_how_probable_each_belief_is_after_readings_is_bayes_rule_written_out(seed: int) -> None:
    readings, size = read(machine(seed), 12), CASE.errors.size
    stated = CASE.errors.prior_covariance()
    beliefs = [Rival(f"{factor:g}", weight, Inherited(np.full(size, shift), factor * stated))
               for factor, weight, shift in ((1.0, 0.2, 0.0), (0.3, 0.5, 1e-6), (4.0, 0.6, 0.0))]  # fmt: skip
    expected = []
    for rival in beliefs:
        posed = problem(CASE.observation, readings, NONE_VARY, rival.belief, usual=False)
        seen = multivariate_normal(cov=Dense(posed).covariance(np.zeros(0)))
        expected.append(np.log(rival.weight) + float(seen.logpdf(posed.values)))
    shares = np.exp(np.array(expected) - max(expected))
    found = shares_of_rivals(beliefs, replace(CASE, inherited=beliefs[-1].belief), readings, {})
    assert found == pytest.approx(shares / shares.sum(), rel=1e-5)
    before = np.array([0.2, 0.5, 0.6]) / 1.3
    assert shares_of_rivals(beliefs, CASE, [], {}) == pytest.approx(before)


def test_a_data_equation_and_a_prior_make_the_belief_that_readings_make() -> None:
    case = mixed()
    readings = drawn(case)
    known, size = case.knowledge.read(readings).belief, case.errors.size
    data, prior = data_equation(case.observation, readings), case.errors.prior_covariance()
    gain = prior @ data.rows.T @ np.linalg.inv(data.rows @ prior @ data.rows.T + np.eye(len(data.values)))
    scale = np.sqrt(np.diagonal(prior))
    np.testing.assert_allclose(gain @ data.values / scale, known.mean[:size] / scale, atol=1e-6)
    correlated = (prior - gain @ data.rows @ prior - known.covariance[:size, :size]) / scale[:, None] / scale
    np.testing.assert_allclose(correlated, 0.0, atol=1e-6)
