"""Level surveys as they are written down: what they say, and that each way to break one is an error with its line."""

from __future__ import annotations

from pathlib import Path

import pytest

from axiscal.description.placed_readings import placed_readings
from axiscal.measurement.readers.files import read_any
from axiscal.measurement.reading import Reading
from tests.generators.campaigns import on
from tests.measurement.test_stepped import LEVEL, MACHINE

SURVEY = """# level survey
# Bed of the lathe, level pushed by hand
# base = 100 mm
# division = 0.02 mm/m
X_mm,forward_div,back_div
50,12.0,12.5
150,11.0,11.0
250,10.5,
50,12.5,
"""
RIDING = 'instrument = "autocollimator"\ndirection = "z"\nmoves = ["X"]\n'


def _placed(path: Path, text: str, *setups: str) -> tuple[Reading, ...]:
    path.write_bytes(text.encode("utf-8"))
    tables = "".join(f'[[setups]]\nname = "{i}"\n{setup}\n' for i, setup in enumerate(setups or (LEVEL,)))
    return placed_readings(read_any(path), on(MACHINE, tables, target={"readings": 1}), path)


def test_a_survey_is_read_there_and_back_with_its_closing_reading(tmp_path: Path) -> None:
    readings = _placed(tmp_path / "survey.txt", SURVEY)
    assert [round(1e3 * r.pose[0]) for r in readings] == [50, 150, 250, 50, 150, 50]
    assert [r.approach[0] for r in readings] == [1, 1, 1, 1, -1, -1]
    assert [r.value for r in readings] == pytest.approx([2.4e-4, 2.2e-4, 2.1e-4, 2.5e-4, 2.2e-4, 2.5e-4])
    assert [r.line for r in readings] == [6, 7, 8, 9, 7, 6]


def test_times_are_those_of_the_lines(tmp_path: Path) -> None:
    text = "# level survey\nX_mm,forward_um/m,back_um/m,time\n100,1,,9:00\n200,2,,9:01\n200,,3,9:03\n100,,4,9:04\n"
    readings = _placed(tmp_path / "survey.txt", text)
    assert [r.time for r in readings] == [0, 60, 240, 180]
    assert [r.value for r in readings] == pytest.approx([1e-6, 2e-6, 4e-6, 3e-6])


def test_the_set_up_is_the_one_with_that_base_or_the_one_that_is_named(tmp_path: Path) -> None:
    path, other = tmp_path / "survey.txt", LEVEL.replace("100 mm", "200 mm")
    assert {r.setup for r in _placed(path, SURVEY, RIDING, LEVEL)} == {"1"}
    for base in ("# base = 200 mm", "# Base: 200 mm", "# base 200 mm", "# base = 200 mm,", "# by: me\n# base=200 mm"):
        longer = f"# level survey,\n{base}\nX_mm,forward_um/m\n300,1\n"
        assert [r.setup for r in _placed(path, longer, LEVEL, other)] == ["1"]
    assert {r.setup for r in _placed(path, SURVEY.replace("base = 100 mm", "setup = 0"), LEVEL, other)} == {"0"}
    riding = SURVEY.replace("# base = 100 mm\n", "")
    assert {r.setup for r in _placed(path, riding, RIDING)} == {"0"}
