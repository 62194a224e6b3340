"""Lengths between two places: a printed square becomes a skew, a ruler a slope; their truths nobody drew."""

import math
import re
from pathlib import Path

from benchmarks.zoo.answers import Answer
from benchmarks.zoo.running import given

SQUARE = """machine = "printer-gantry"
controls = ["marlin"]
compensation_active = false
[target]
wants = ["squareness XY"]
[[setups]]
name = "square"
instrument = "gauge"
"""
CORNERS = {"A": (30, 30), "B": (270, 30), "C": (270, 270), "D": (30, 270)}
SKEW = 0.00396


def _place(x: float, y: float) -> str:
    return f'["{x} mm", "{y} mm", "0 mm"]'


def _printed(name: str) -> float:
    """Return a side or diagonal as calipers read it: Y leans towards X, mm."""
    (x, y), (u, v) = (CORNERS[letter] for letter in name)
    return round(math.hypot(u - x + SKEW * (v - y), v - y), 2)


def test_a_printed_square_becomes_a_skew(tmp_path: Path) -> None:
    names = ("AC", "BD", "AD")
    ends = ", ".join(f"{name} = [{', '.join(_place(*CORNERS[letter]) for letter in name)}]" for name in names)
    (tmp_path / "square.toml").write_text(f"{SQUARE}lengths = {{ {ends} }}\n")
    rows = [f"square {name},{_printed(name)}" for name in names]
    (tmp_path / "lengths.csv").write_text("\n".join(["setup,length_mm", *rows]))
    out = tmp_path / "out"
    answer = Answer(out, given("data", "estimate", tmp_path / "square.toml", tmp_path / "lengths.csv", "--out", out))
    assert answer.outcome.status == 0, answer.text
    (found,) = answer.result["rows"][0]["signed"]
    assert abs(found["value"] + 1e6 * SKEW) < found["U"] < 1000
    factor = float(re.findall(r"M852 I([-\d.]+)", (out / "tables" / "marlin" / "axiscal.gcode").read_text())[0])
    assert 0.8 * SKEW < factor < SKEW


def test_two_diagonals_without_any_unknown_say_the_angle(tmp_path: Path) -> None:
    """By the cosine rule: the squares of both diagonals differ by 4 a b cos of the angle at A."""
    lengths = {name: _printed(name) for name in ("AC", "BD")}
    ends = ", ".join(f"{name} = [{', '.join(_place(*CORNERS[letter]) for letter in name)}]" for name in lengths)
    (tmp_path / "square.toml").write_text(f"{SQUARE}unknowns = {{}}\nlengths = {{ {ends} }}\n")
    rows = [f"square {name},{length}" for name, length in lengths.items()]
    (tmp_path / "lengths.csv").write_text("\n".join(["setup,length_mm", *rows]))
    out = tmp_path / "out"
    answer = Answer(out, given("data", "estimate", tmp_path / "square.toml", tmp_path / "lengths.csv", "--out", out))
    (found,) = answer.result["rows"][0]["signed"]
    leans = (lengths["AC"] ** 2 - lengths["BD"] ** 2) / (4 * 240**2)
    assert abs(found["value"] + 1e6 * leans) < 100
    assert answer.result["readings"] == 2
