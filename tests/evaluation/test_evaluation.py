"""ISO 230-2 figures: published evaluations of real tests, a naive twin, the standard's definitions, any readings."""

import json
from pathlib import Path

import numpy as np
import pytest

from axiscal.evaluation.standards import Positioning, PositioningTest, evaluate, positioning_test
from axiscal.exceptions import ReadingError
from axiscal.measurement.readers.files import recognised
from tests.refusals.reading import refusals

GOLDEN = Path(__file__).resolve().parents[1] / "golden" / "iso230"
ROUNDING = 2e-5  # mm, of the published figures

GOOD = refusals("positioning").texts["test"]


def evaluated(tmp_path: Path, text: str) -> Positioning:
    path = tmp_path / "test.csv"
    path.write_text(text)
    return evaluate(positioning_test(recognised(path)))


@pytest.mark.parametrize("name", ["ess_target_x", "ess_muts_x", "ess_muts_y"])
def test_every_published_iso_figure_of_a_real_test(name: str) -> None:
    expected = json.loads((GOLDEN / f"{name}.expected.json").read_text())
    document = json.loads(json.dumps(evaluate(positioning_test(recognised(GOLDEN / f"{name}.csv"))).as_json()))
    published = expected["reported_by_source"]
    figures = {"A": "A", "A_up": "A_fwd", "A_down": "A_bwd", "E_up": "E_fwd", "E_down": "E_bwd"} | {
        "R_up": "R_fwd", "R_down": "R_bwd", "B": "B", "B_mean": "B_avg", "M": "M"
    }  # fmt: skip
    wanted = {ours: published[theirs] for ours, theirs in figures.items()}
    for figure, value in (wanted | {"R": expected["iso_R"], "E": expected["iso_E"]}).items():
        assert document[figure] / 1e3 == pytest.approx(value, abs=ROUNDING), figure
    columns = {"mean": "x_avg_bi", "B_i": "B_i", "s_up": "s_fwd", "s_down": "s_bwd"} | {
        "R_up_i": "R_fwd_i", "R_down_i": "R_bwd_i", "R_i": "R_i"
    }  # fmt: skip
    assert [row["target"] for row in document["per_target"]] == expected["target_mm"]
    for ours, theirs in columns.items():
        assert [row[ours] / 1e3 for row in document["per_target"]] == pytest.approx(published[theirs], abs=ROUNDING)


def test_one_direction_leaves_the_bidirectional_figures_open(tmp_path: Path) -> None:
    text = "".join(line for line in GOOD.splitlines(keepends=True) if ",-," not in line)
    figures = evaluated(tmp_path, text)
    assert figures.figures["A_up"] == pytest.approx((1.0 + 4 * 0.5 / 2**0.5) * 1e-6)
    assert figures.figures["E_up"] == pytest.approx(1e-6)
    assert set(figures.figures) == {"A_up", "E_up", "R_up"}
    assert figures.per_target[0]["B_i"] is None
    assert any("one direction" in warning for warning in figures.warnings)


def test_rotary_axes_are_told_in_arcsec(tmp_path: Path) -> None:
    text = GOOD.replace("target_mm", "target_deg").replace("deviation_um", "deviation_arcsec")
    document = evaluated(tmp_path, text).as_json()
    assert document["unit"] == "arcsec"
    assert document["target_unit"] == "deg"
    assert document["E_up"] == pytest.approx(1.0)
    assert document["per_target"][1]["target"] == pytest.approx(100.0)  # type: ignore[index]
    same = evaluated(tmp_path, text.replace("_arcsec", "_urad")).as_json()
    assert same["E_up"] == pytest.approx(1.0 / 4.8481368, rel=1e-7)


def test_nothing_is_said_of_a_test_that_follows_the_standard() -> None:
    rng = np.random.default_rng(1)
    targets = np.sort(np.arange(6) * 0.2 + rng.uniform(-0.01, 0.01, 6))
    up, down = rng.normal(0, 1e-6, (2, 6, 5))
    assert evaluate(PositioningTest(targets, up, down)).warnings == ()


@pytest.mark.parametrize(
    ("span", "rotary", "asked"),
    [
        (0.1, False, 5),
        (1.0, False, 5),
        (1.01, False, 6),
        (2.0, False, 10),
        (3.0, False, 13),
        (np.pi / 2, True, 3),
        (np.pi, True, 5),
        (2 * np.pi, True, 8),
    ],
)
def test_number_of_targets_that_the_standard_asks_for(span: float, rotary: bool, asked: int) -> None:
    def said(n: int) -> bool:
        zeros = np.zeros((n, 5))
        test = PositioningTest(np.linspace(0, span, n), zeros, zeros, rotary)
        return any(f"asks for {asked} targets" in warning for warning in evaluate(test).warnings)

    assert said(asked - 1)
    assert not said(asked)


def test_equal_spacing_is_pointed_out() -> None:
    zeros = np.zeros((5, 5))
    said = evaluate(PositioningTest(np.linspace(0, 0.4, 5), zeros, zeros)).warnings
    assert len(said) == 1
    assert "equally spaced" in said[0]


def test_a_single_run_has_no_standard_deviation(tmp_path: Path) -> None:
    text = "".join(line for line in GOOD.splitlines(keepends=True) if ",2," not in line)
    found = evaluated(tmp_path, text)
    shown = {name: found.as_json()[name] for name in ("E", "E_up", "B", "B_mean", "M", "A", "A_up", "R", "R_down")}
    assert shown == {"E": 3.0, "E_up": 1.0, "B": 1.0, "B_mean": 0.0, "M": 2.0} | dict.fromkeys(
        ("A", "A_up", "R", "R_down")
    )
    assert found.uncertainty == {}
    assert found.warnings[1].endswith("need repeats and are withheld.")


def test_a_missing_reading_costs_its_target_alone(tmp_path: Path) -> None:
    more = "".join(f"50,{way},{run},{value}\n" for way, run, value in (("+", 1, 9), ("-", 1, 9), ("+", 2, 9)))
    found = evaluated(tmp_path, GOOD + more)
    assert found.figures == evaluated(tmp_path, GOOD).figures
    assert found.warnings[0] == "Left out, because a run has no reading there: 50 mm."


def test_no_direction_at_all_is_refused() -> None:
    with pytest.raises(ReadingError, match="no readings"):
        evaluate(PositioningTest(np.zeros(2), None, None))


def test_the_uncertainty_is_how_the_figures_scatter_when_the_test_is_repeated() -> None:
    """Tests of five runs drawn from one machine: the scatter of each figure against the mean of what each promised."""
    rng, targets = np.random.default_rng(1), np.linspace(0, 1, 9)
    curve, found = 5e-6 * np.sin(3 * targets), []
    for _ in range(200):
        up, down = (curve[:, None] + shift + 1e-6 * rng.standard_normal((9, 5)) for shift in (2e-6, -2e-6))
        found.append(evaluate(PositioningTest(targets, up, down)))
    for name in ("A", "E", "B_mean", "M", "R_up"):
        scatter = 2 * float(np.std([each.figures[name] for each in found]))
        promised = float(np.mean([each.uncertainty[name] for each in found]))
        assert 0.75 * scatter < promised < 2.0 * scatter  # largest of several: on the safe side
