"""Level surveys as they are written down: what they say, and that each way to break one is an error with its line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.description.placed_readings import placed_readings
from axiscal.exceptions import ReadingError
from axiscal.measurement.readers.files import read_any
from axiscal.measurement.reading import Reading
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
    campaign = f'machine = "bed.toml"\n[target]\nreadings = 1\n{tables}'
    return placed_readings(read_any(path), campaign_from_texts(campaign, "c.toml", MACHINE, "bed.toml"), path)


def test_a_survey_is_read_there_and_back_with_its_closing_reading(tmp_path: Path) -> None:
    readings = _placed(tmp_path / "survey.txt", SURVEY)
    assert [round(1e3 * r.pose[0]) for r in readings] == [50, 150, 250, 50, 150, 50]
    assert [r.approach[0] for r in readings] == [1, 1, 1, 1, -1, -1]
    assert [r.value for r in readings] == pytest.approx([2.4e-4, 2.2e-4, 2.1e-4, 2.5e-4, 2.2e-4, 2.5e-4])
    assert [r.line for r in readings] == [6, 7, 8, 9, 7, 6]


@pytest.mark.parametrize(
    ("unit", "factor"), [("um/m", 1e-6), ("mm/m", 1e-3), ("arcsec", np.pi / 648000), ("urad", 1e-6), ("µm/m", 1e-6)]
)
def test_every_unit_of_a_slope_is_read(tmp_path: Path, unit: str, factor: float) -> None:
    text = f"# Level survey\r\nX_mm,forward_{unit}\r\n450,3\r\n350,-2.5\r\n"
    readings = _placed(tmp_path / "survey.txt", text)
    assert [r.value for r in readings] == pytest.approx([3 * factor, -2.5 * factor])
    assert [r.approach[0] for r in readings] == [-1, -1]


def test_times_are_those_of_the_lines(tmp_path: Path) -> None:
    text = "# level survey\nX_mm,forward_um/m,back_um/m,time\n100,1,,9:00\n200,2,,9:01\n200,,3,9:03\n100,,4,9:04\n"
    readings = _placed(tmp_path / "survey.txt", text)
    assert [r.time for r in readings] == [0, 60, 240, 180]
    assert [r.value for r in readings] == pytest.approx([1e-6, 2e-6, 4e-6, 3e-6])


def test_the_set_up_is_the_one_with_that_base_or_the_one_that_is_named(tmp_path: Path) -> None:
    path, other = tmp_path / "survey.txt", LEVEL.replace("100 mm", "200 mm")
    assert {r.setup for r in _placed(path, SURVEY, RIDING, LEVEL)} == {"1"}
    longer = "# level survey\n# base = 200 mm\nX_mm,forward_um/m\n300,1\n"
    assert {r.setup for r in _placed(path, longer, LEVEL, other)} == {"1"}
    named = SURVEY.replace("# base = 100 mm", "# setup = 0")
    assert {r.setup for r in _placed(path, named, LEVEL, other)} == {"0"}
    riding = SURVEY.replace("# base = 100 mm\n", "")
    assert {r.setup for r in _placed(path, riding, RIDING)} == {"0"}


BROKEN = [
    (("# base = 100 mm", "# base = 100"), 3, "no unit"),
    (("# base = 100 mm", "# base = -1 mm"), 3, "is not above zero"),
    (("# base = 100 mm", "# bace = 100 mm"), 3, "'bace' is not known"),
    (("# Bed of the lathe, level pushed by hand", "# base = 1 mm"), 3, "'base' is said twice"),
    (("0.02 mm/m", "0.02 mm"), 4, "not an angle"),
    (("# division = 0.02 mm/m\n", ""), 4, "the value of one is not said"),
    (("X_mm", "station_mm"), 5, "column 'station_mm' is not known"),
    (("back_div", "Z_mm"), 5, "column 'Z_mm' is not known"),
    (("back_div", "back_in"), 5, "column 'back_in' has a unit of the wrong kind"),
    (("back_div", "forward_um/m"), 5, "a way is named twice"),
    (("150,11.0,11.0", "150,,"), 7, "the station has no reading"),
    (("150,11.0,11.0", "150,eleven,11.0"), 7, "'eleven' is not a number"),
    (("150,11.0,11.0", "150,nan,11.0"), 7, "is not finite"),
    (("150,11.0,11.0", "150,11,0,11,0"), 7, "the line has 5 cells"),
    (("150,11.0,11.0", ",11.0,11.0"), 7, "X_mm is empty"),
    (("150,11.0,11.0", "1500,11.0,11.0"), 7, "X = 1500 mm is outside the travel"),
    (("150,11.0,11.0", "20,11.0,11.0"), 7, "a foot of the level stands outside the travel"),
    (("# base = 100 mm", "# base = 90 mm"), 6, "stood on a base of 90 mm"),
    (("# Bed of the lathe, level pushed by hand", "# setup = bed"), 6, "bed"),
]


@pytest.mark.parametrize(("change", "line", "reason"), BROKEN)
def test_a_broken_survey_is_an_error_with_its_line(
    tmp_path: Path, change: tuple[str, str], line: int, reason: str
) -> None:
    old, new = change
    assert old in SURVEY
    with pytest.raises(ReadingError, match=reason) as failure:
        _placed(tmp_path / "survey.txt", SURVEY.replace(old, new, 1))
    assert failure.value.line == line
    assert failure.value.remedy


def test_two_readings_cannot_share_one_time(tmp_path: Path) -> None:
    text = "# level survey\nX_mm,forward_um/m,back_um/m,time\n100,1,,9:00\n200,2,3,9:01\n"
    with pytest.raises(ReadingError, match="two readings, and one time") as failure:
        _placed(tmp_path / "survey.txt", text)
    assert failure.value.line == 4


def test_a_survey_has_stations_and_readings(tmp_path: Path) -> None:
    for header in ("X_mm,time", "forward_um/m,time"):
        with pytest.raises(ReadingError, match="there is no column of") as failure:
            _placed(tmp_path / "survey.txt", f"# level survey\n{header}\n100,9:00\n")
        assert failure.value.line == 2


def test_a_campaign_without_a_level_has_no_set_up_for_a_survey(tmp_path: Path) -> None:
    with pytest.raises(ReadingError, match="no set-up of this campaign read"):
        _placed(tmp_path / "survey.txt", SURVEY, 'instrument = "probe"\ndirection = "z"\n')
    with pytest.raises(ReadingError, match="several set-ups of this campaign read"):
        _placed(tmp_path / "survey.txt", SURVEY, LEVEL, LEVEL)
