"""Every example runs, finds what it found before, and stands on the page with its picture."""

import json
import re
import runpy
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

from axiscal.numerics import Array
from tests.docs.examples import EXAMPLES, GOLDEN, PAGE, PICTURES, found, numbers, page
from tests.docs.pictures import svg

RELATIVE = 1e-3
"""The page shows four digits; the last readings of a plan may move by less."""
PLANNED = ("ex05_stacked_axes", "ex07_campaign", "ex08_paper_spline")
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
ROTARY = Path(__file__).resolve().parents[3] / "shared" / "data" / "rotary" / "spindle_runout_fixed_z.csv"


@pytest.fixture(
    scope="module",
    params=[
        pytest.param(path, id=path.stem, marks=() if path == EXAMPLES[0] else pytest.mark.long) for path in EXAMPLES
    ],
)
def example(request: pytest.FixtureRequest) -> tuple[Path, dict[str, Any]]:
    """Return each example with what it finds."""
    return request.param, found(request.param)


def test_the_example_finds_what_it_found(example: tuple[Path, dict[str, Any]]) -> None:
    path, result = example
    golden = json.loads(GOLDEN.read_text(encoding="utf-8"))[path.stem]
    assert list(golden) == list(numbers(result))
    for name, value in numbers(result).items():
        assert golden[name] == (pytest.approx(value, rel=RELATIVE) if isinstance(value, float) else value), name


def test_the_examples_stand_on_the_page() -> None:
    assert PAGE.read_text(encoding="utf-8") == page(), "run `make docs`"


def test_the_picture_is_that_of_the_example(example: tuple[Path, dict[str, Any]]) -> None:
    """Word for word; and number for number within two pixels, but where a picture follows what the planner chooses."""
    path, result = example
    drawn, kept = svg(result["picture"]), (PICTURES / f"{path.stem}.svg").read_text(encoding="utf-8")
    words = [
        [e.text for e in ElementTree.fromstring(text).iter() if e.text and not _NUMBER.fullmatch(e.text)]
        for text in (drawn, kept)
    ]
    assert words[0] == words[1], "run `make docs`"
    if path.stem not in PLANNED:
        assert _NUMBER.sub("0", drawn) == _NUMBER.sub("0", kept), "run `make docs`"
        new, old = (np.array([float(n) for n in _NUMBER.findall(text)]) for text in (drawn, kept))
        np.testing.assert_allclose(new, old, atol=2.0)


@pytest.mark.parametrize("file", [ROTARY] if ROTARY.is_file() else [None])
def test_the_rotary_example_foretells_the_other_half(file: Path | None) -> None:
    """Half of ten slow turns foretells the other half to the noise of the dial.

    On a real spindle where its readings are at hand (they carry no licence, so they stay where they are): eccentricity
    5 um, noise 0.2 to 0.3 um. Elsewhere on the example's own turns, which are like it.
    """
    main = runpy.run_path(str(EXAMPLES[1]))["main"]
    result = main(measured(file)) if file else main()
    assert result["RMS of what the other half differs, um"] < 0.3
    assert result["tilt, um"] == pytest.approx(5.16 if file else 5.0, abs=0.1)


def measured(file: Path) -> Array:
    """Return angle (deg) and reading (um) of a spindle at 2.6395 rpm, from columns time (s) and reading."""
    time, reading = np.loadtxt(file, delimiter=",", comments="#", skiprows=3).T
    return np.column_stack([360 * time * 2.6395 / 60, reading])
