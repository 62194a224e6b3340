"""Every format of readings: drawn files of it come in as drawn, and what is broken or of no use is one clear error."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from axiscal.description.campaign import CampaignDescription
from axiscal.description.placed_readings import placed_approach, placed_readings
from axiscal.evaluation.standards import evaluate, positioning_test
from axiscal.exceptions import InputError, ReadingError
from axiscal.measurement.readers.csv_readings import Around, Found
from axiscal.measurement.readers.files import FORMATS, read_any, recognised
from axiscal.measurement.readers.text_file import MOST_LINES
from axiscal.present.delivery import read_in
from tests.generators.campaigns import on
from tests.generators.texts import Said, machine_text, setup_text
from tests.generators.written_maps import EVERYWHERE, FORMS, DrawnMap, drawn
from tests.refusals.reading import refusals

BED = machine_text("w-b-X-Y-Z-t", {"X": (-400, 400), "Y": (-400, 400), "Z": (-10, 10)}, {"EZX": "50 um"})
MAPS = [
    drawn((20, 280, 5), (20, 280, 5), 1),
    drawn((-120, 180, 7), (-305, -5, 4), 2, holes=3),
    drawn((0, 10, 3), (-40, 300, 11), 3, holes=5),
    drawn((-30, 36, 12), (10, 30, 3), 4, holes=1),
]
TEXTS = {title: text for title, text in refusals("files").texts.items() if not title.endswith(".toml")}
"""By title, a good file of each."""


def described(*, nodes: DrawnMap | None) -> CampaignDescription:
    """Return a campaign whose probe reads along z, and states where the nodes of maps lie."""
    said: dict[str, Said] = {}
    if nodes is not None:
        said = {"map": {a: [f"{at[0]} mm", f"{at[-1]} mm", len(at)] for a, at in (("X", nodes.x), ("Y", nodes.y))}}
    probe = setup_text("probe", "probe", direction="z", moves=["X", "Y"], **said)
    return on(BED, probe)


def read(folder: Path, text: str | bytes, nodes: DrawnMap | None = None, unit: str = "") -> Found:
    path = folder / "file.txt"
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    campaign = described(nodes=nodes)
    return recognised(path, Around(campaign.machine.axes, campaign.setups), unit)


def tried(folder: Path, text: str) -> tuple[Found | None, InputError | None]:
    """Return what a text is, or why it is refused."""
    try:
        return read(folder, text, MAPS[0]), None
    except InputError as refused:
        return None, refused


def heights(found: Found) -> dict[tuple[float, float], float]:
    return {
        (round(1e3 * each.position["X"], 6), round(1e3 * each.position["Y"], 6)): -1e3 * each.value
        for each in found.readings
    }


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("number", range(len(MAPS)))
def test_a_map_comes_in_as_it_was_drawn(tmp_path: Path, form: str, number: int) -> None:
    drawing = MAPS[number]
    if form in EVERYWHERE:
        drawing = DrawnMap(drawing.x, drawing.y, np.nan_to_num(drawing.z, nan=0.125))
    found = read(tmp_path, drawing.text(form), drawing)
    assert heights(found) == pytest.approx(drawing.probed(), abs=1e-9)
    assert found.title == form.partition(", ")[0] or found.title in form
    if found.cells > len(found.readings):
        assert found.cells == drawing.z.size


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("remark", ["; probed on Monday", "# 1 2 3", "(PROBE)", ""])
def test_a_remark_above_a_map_changes_nothing_or_is_refused(tmp_path: Path, form: str, remark: str) -> None:
    found, _ = tried(tmp_path, f"{remark}\n{MAPS[0].text(form)}")
    assert found is None or heights(found) == pytest.approx(MAPS[0].probed(), abs=1e-9)


def test_a_file_without_end_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ReadingError, match=f"has {MOST_LINES + 2:,} lines, and at most {MOST_LINES:,} are read"):
        read(tmp_path, "X_mm,value_um\n" * (MOST_LINES + 1))


def test_every_format_has_a_good_file(tmp_path: Path) -> None:
    named = {title: read(tmp_path, text, MAPS[0]).title for title, text in TEXTS.items()}
    assert all(title.startswith(found) for title, found in named.items())
    assert {kind.title for kind in FORMATS} - {"a file of laser software"} <= set(named.values())


BARE = [form for form in FORMS if any(word in form for word in ("a Marlin map", "mesh of the"))]


@pytest.mark.parametrize("form", BARE)
def test_a_map_without_coordinates_asks_for_them(tmp_path: Path, form: str) -> None:
    with pytest.raises(ReadingError, match=r"State it in the set-up.*map = \{ X = \[\"20 mm\", \"280 mm\", 5\], Y"):
        read(tmp_path, MAPS[0].text(form))
    with pytest.raises(ReadingError, match=r"5 x 5 nodes, and `map` of set-up \"probe\" says 3 x 11|says 7 x 4"):
        read(tmp_path, MAPS[0].text(form), MAPS[1])


@pytest.mark.parametrize("title", TEXTS)
@pytest.mark.parametrize("share", [0.0, 0.15, 0.4, 0.75, 0.97])
def test_a_file_that_is_cut_off_is_refused_or_holds_what_stood_there(tmp_path: Path, title: str, share: float) -> None:
    lines = TEXTS[title].splitlines(keepends=True)
    text = "".join(lines[: int(share * len(lines))])
    found, refused = tried(tmp_path, text)
    if found is None:
        assert "\n" not in str(refused)
        assert getattr(refused, "remedy", "")
        return
    whole = read(tmp_path, TEXTS[title], MAPS[0]).readings
    values = [(each.position, each.approach, each.value) for each in whole]
    assert all((each.position, each.approach, each.value) in values for each in found.readings)


@pytest.mark.parametrize("title", TEXTS)
def test_what_is_no_number_of_a_machine_is_one_clear_error(tmp_path: Path, title: str) -> None:
    text = TEXTS[title]
    for broken in (b"\x00\xff" + text.encode(), bytes(range(256)) * 9):
        with pytest.raises(InputError):
            read(tmp_path, broken, MAPS[0])
    numbers = [*re.finditer(r"\d+", text)]
    for number in numbers[:: max(1, len(numbers) // 12)]:
        longer = text[: number.start()] + 5000 * "9" + text[number.end() :]
        found, refused = tried(tmp_path, longer)
        assert len(str(refused)) < 600
        assert found is None or max(abs(each.value) for each in found.readings) < 1.0


def test_a_unit_is_said_for_files_without_one_alone(tmp_path: Path) -> None:
    for title in ("a Klipper mesh", "a positioning test (.rtl)", "a test of one axis (ISO 230-2)"):
        with pytest.raises(ReadingError, match=r"(?i)leave --unit out"):
            read(tmp_path, TEXTS[title], unit="inch")


def test_a_side_alone_is_that_of_the_only_axis_that_moves(tmp_path: Path) -> None:
    text = "setup;X_mm;approach;value_um\ndial;100;+;1\ndial;200;-;2\n"
    (tmp_path / "r.csv").write_text(text, encoding="utf-8")
    dial = setup_text("dial", "straightedge", direction="z", moves=["X"])
    campaign = on(BED, dial)
    found = placed_readings(read_any(tmp_path / "r.csv"), campaign, "r.csv")
    assert [each.approach for each in found] == [(1, 0, 0), (-1, 0, 0)]
    with pytest.raises(ReadingError, match='names no axis, and "probe" moves X and Y'):
        placed_approach(described(nodes=None).setups[0], campaign.machine, {"": 1})


def test_a_straightness_test_is_without_its_line(tmp_path: Path) -> None:
    at = np.arange(9) * 50.0
    bent = 5.0 * np.sin(at / 60.0)
    rows = "".join(f"1 {number} {y:.6f}\n" for number, y in enumerate(bent + 0.1 * at + 3.0, 1))
    targets = " ".join(f"{each:.3f}" for each in at)
    text = f"HEADER::\nFile type : rts\nUnits: um\nTARGET DATA::\nTargets: {targets}\nDEVIATIONS::\n{rows}EOF::\n"
    figures = evaluate(positioning_test(read(tmp_path, text))).figures
    assert 1e6 * figures["E_up"] == pytest.approx(np.ptp(bent - np.polyval(np.polyfit(at, bent, 1), at)), abs=1e-5)


def test_klipper_printed_where_its_nozzle_stood_until_2025(tmp_path: Path) -> None:
    probe = setup_text("probe", "probe", direction="z", moves=["X", "Y"], offset=["-33 mm", "-46 mm", "0 mm"])
    campaign, path = on(BED, probe), tmp_path / "console.txt"
    path.write_text("Send: PROBE\n// probe at 133.000,96.000 is z=0.125000\nok\n")
    found = recognised(path, Around(campaign.machine.axes, campaign.setups))
    assert heights(found) == pytest.approx({(100.0, 50.0): 0.125})


def test_readings_of_few_whole_targets_are_used_without_figures(tmp_path: Path) -> None:
    (tmp_path / "r.csv").write_text("Pos_mm;1+_um;1-_um\n0;0,1;0,2\n100;-;1,2\n200;2,1;n/a\n", encoding="utf-8")
    laser = setup_text("laser", "interferometer", direction="x", moves=["X"], approach="both")
    found = read_in(on(BED, laser), tmp_path / "r.csv")
    assert len(found.readings) == 4
    assert "4 of 6 cells, for set-up laser" in found.told
