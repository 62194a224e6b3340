"""Every format of readings: drawn files of it come in as drawn, and what is broken or of no use is one clear error."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest

from axiscal.description.campaign import CampaignDescription
from axiscal.description.placed_readings import placed_approach, placed_readings
from axiscal.evaluation.standards import evaluate, positioning_test
from axiscal.exceptions import InputError, ReadingError
from axiscal.measurement.readers.csv_readings import Around
from axiscal.measurement.readers.files import FORMATS, Recognised, read_any, recognised
from axiscal.measurement.readers.text_file import MOST_LINES
from axiscal.present.delivery import read_in
from tests.generators.campaigns import on
from tests.generators.texts import Said, machine_text, setup_text
from tests.generators.written_maps import EVERYWHERE, FORMS, DrawnMap, drawn
from tests.measurement.test_instrument_files import RTL
from tests.refusals.reading import refusals

BED = machine_text("w-b-X-Y-Z-t", {"X": (-400, 400), "Y": (-400, 400), "Z": (-10, 10)}, {"EZX": "50 um"})
MAPS = [
    drawn((20, 280, 5), (20, 280, 5), 1),
    drawn((-120, 180, 7), (-305, -5, 4), 2, holes=3),
    drawn((0, 10, 3), (-40, 300, 11), 3, holes=5),
    drawn((-30, 36, 12), (10, 30, 3), 4, holes=1),
]
ISO = "target_mm,direction,run,deviation_um\n0,+,1,0.5\n10,+,1,1.5\n10,-,1,0\n0,-,1,-1\n"
TEXTS = {title: text for title, text in refusals("files").texts.items() if not title.endswith(".toml")}
"""By title, a good file of each."""


def described(*, nodes: DrawnMap | None) -> CampaignDescription:
    """Return a campaign whose probe reads along z, and states where the nodes of maps lie."""
    said: dict[str, Said] = {}
    if nodes is not None:
        said = {"map": {a: [f"{at[0]} mm", f"{at[-1]} mm", len(at)] for a, at in (("X", nodes.x), ("Y", nodes.y))}}
    probe = setup_text("probe", "probe", direction="z", moves=["X", "Y"], **said)
    return on(BED, probe)


def read(folder: Path, text: str | bytes, nodes: DrawnMap | None = None, unit: str = "") -> Recognised:
    path = folder / "file.txt"
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    campaign = described(nodes=nodes)
    return recognised(path, Around(campaign.machine.axes, campaign.setups), unit)


def tried(folder: Path, text: str) -> tuple[Recognised | None, InputError | None]:
    """Return what a text is, or why it is refused."""
    try:
        return read(folder, text, MAPS[0]), None
    except InputError as refused:
        return None, refused


def heights(found: Recognised) -> dict[tuple[float, float], float]:
    return {
        (round(1e3 * each.position["X"], 6), round(1e3 * each.position["Y"], 6)): -1e3 * each.value
        for each in found.found.readings
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
    if found.found.cells > len(found.found.readings):
        assert found.found.cells == drawing.z.size


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


ANY_ORDER = [each for each in FORMS if any(word in each for word in ("UBL map", "M421", "points"))]


@pytest.mark.parametrize("form", [each for each in ANY_ORDER if "Marlin 1" not in each])
def test_a_map_that_is_turned_upside_down_stays_as_it_is(tmp_path: Path, form: str) -> None:
    """Rows and points that say where they are may stand in any order."""
    lines = MAPS[1].text(form).splitlines()
    movable = [n for n, line in enumerate(lines) if any(map(line.__contains__, ("|", "I", "Bed X", ".")))]
    movable = [n for n in movable if not any(map(lines[n].__contains__, ("(", "Topography")))]
    for low, high in zip(movable[: len(movable) // 2], movable[::-1], strict=False):
        lines[low], lines[high] = lines[high], lines[low]
    assert heights(read(tmp_path, "\n".join(lines), MAPS[1])) == pytest.approx(MAPS[1].probed(), abs=1e-9)


BARE = [form for form in FORMS if any(word in form for word in ("a Marlin map", "mesh of the"))]


@pytest.mark.parametrize("form", BARE)
def test_a_map_without_coordinates_asks_for_them(tmp_path: Path, form: str) -> None:
    with pytest.raises(ReadingError, match=r"State it in the set-up.*map = \{ X = \[\"20 mm\", \"280 mm\", 5\], Y"):
        read(tmp_path, MAPS[0].text(form))
    with pytest.raises(ReadingError, match=r"5 x 5 nodes, and `map` of set-up \"probe\" says 3 x 11|says 7 x 4"):
        read(tmp_path, MAPS[0].text(form), MAPS[1])


def test_nodes_without_a_count_are_all_there(tmp_path: Path) -> None:
    lines = MAPS[0].text("a Marlin map (M421, M503)").splitlines()
    with pytest.raises(ReadingError, match="line 22: the mesh of 5 x 5 points has 21 values"):
        read(tmp_path, "\n".join(lines[:22]))
    found = read(tmp_path, "\n".join(lines[:22]), MAPS[0])
    assert found.sentence() == "file.txt: a Marlin map (M421, M503), 21 of 25 cells."


def test_a_mesh_of_marlin_is_printed_with_more_decimals(tmp_path: Path) -> None:
    rows = "0 -0.20000 -0.18000  0.10000\nRecv:  1  0.00100 +0.00000 -0.05000"
    text = f"Recv: 3x2 mesh. Z offset: 0.00000\nRecv: Measured points:\nRecv:   0   1   2\nRecv:  {rows}\nRecv: ok\n"
    found = heights(read(tmp_path, text, drawn((0, 20, 3), (5, 6, 2), 9)))
    assert [*found.values()] == pytest.approx([-0.2, -0.18, 0.1, 0.001, 0.0, -0.05])
    assert [*found][:4] == [(0.0, 5.0), (10.0, 5.0), (20.0, 5.0), (0.0, 6.0)]


@pytest.mark.parametrize("form", ["a Marlin map (M420 V)", "a Marlin map (M421, M503)"])
def test_rows_of_zeros_alone_are_those_that_nobody_probed(tmp_path: Path, form: str) -> None:
    drawing = MAPS[1]
    zeros = DrawnMap(drawing.x, drawing.y, np.where(np.arange(len(drawing.y))[:, None] < 2, drawing.z, 0.0))
    found = read(tmp_path, zeros.text(form), drawing)
    left = {at: z for at, z in drawing.probed().items() if at[1] < drawing.y[2]}
    assert heights(found) == pytest.approx(left, abs=1e-9)
    nothing = DrawnMap(drawing.x, drawing.y, np.zeros_like(drawing.z))
    with pytest.raises(ReadingError, match=r"no node was probed\. Probe the bed and save the map again"):
        read(tmp_path, nothing.text(form), drawing)


def test_marlin_may_say_where_its_nodes_lie_and_that_it_counts_inches(tmp_path: Path) -> None:
    text, inches = MAPS[0].text("a Marlin map (M421, M503)"), {at: 25.4 * z for at, z in MAPS[0].probed().items()}
    placed = read(tmp_path, f"; mesh from X 20.0 to 280.0 and Y 20.0 to 280.0\n{text}")
    assert heights(placed) == pytest.approx(MAPS[0].probed(), abs=1e-9)
    large = read(tmp_path, f"echo:  G20    ; Units in inches\n{text}", MAPS[0])
    assert heights(large) == pytest.approx(inches, abs=1e-9)


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
    whole = read(tmp_path, TEXTS[title], MAPS[0]).found.readings
    values = [(each.position, each.approach, each.value) for each in whole]
    assert all((each.position, each.approach, each.value) in values for each in found.found.readings)


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
        assert found is None or max(abs(each.value) for each in found.found.readings) < 1.0


def test_a_unit_is_taken_where_the_file_names_none(tmp_path: Path) -> None:
    inches = {(round(25.4 * x, 6), round(25.4 * y, 6)): 25.4 * z for (x, y), z in MAPS[0].probed().items()}
    for form in ("a bCNC probe file", "a Candle height map", "a list of points X Y Z"):
        found = read(tmp_path, MAPS[0].text(form), unit="inch")
        assert heights(found) == pytest.approx(inches, abs=1e-6)
        assert found.sentence(["probe"]).endswith("25 of 25 cells, in inch, for set-up probe.")
    for text in (
        "X_mm,Y_mm,Z_mm\n1,2,3\n",
        "Pos_mm;1+_um\n1;2\n",
        ISO,
        RTL,
        MAPS[0].text("a UBL map"),
        MAPS[0].text("a Klipper mesh"),
    ):
        with pytest.raises(ReadingError, match="Leave --unit out"):
            read(tmp_path, text, unit="inch")


def test_a_list_says_what_it_took_for_granted(tmp_path: Path) -> None:
    named, silent = (read(tmp_path, f"{head}\n1,2,3\n").found.note for head in ("X (in),Y (in),Z (thou)", "X,Y,Z"))
    assert (named, silent) == ("", "in mm")


def test_a_side_alone_is_that_of_the_only_axis_that_moves(tmp_path: Path) -> None:
    text = "setup;X_mm;approach;value_um\ndial;100;+;1\ndial;200;-;2\n"
    (tmp_path / "r.csv").write_text(text, encoding="utf-8")
    dial = setup_text("dial", "straightedge", direction="z", moves=["X"])
    campaign = on(BED, dial)
    found = placed_readings(read_any(tmp_path / "r.csv"), campaign, "r.csv")
    assert [each.approach for each in found] == [(1, 0, 0), (-1, 0, 0)]
    with pytest.raises(ReadingError, match='names no axis, and "probe" moves X and Y'):
        placed_approach(described(nodes=None).setups[0], campaign.machine, {"": 1})


HEADERS = [
    ("target_mm,direction,run,deviation_um", ",", "FR"),
    ("Position [mm];Richtung;Lauf;Abweichung [µm]", ";", ("vor", "zurück")),
    ("Sollposition_mm\tRichtung\tMesslauf\tAbweichung_um", "\t", ("vorwärts", "rückwärts")),
    ("cible (mm);sens;passage;écart (µm)", ";", ("aller", "retour")),
    ("posición_mm,dirección,ciclo,desviación_um", ",", ("adelante", "atrás")),
    ("posizione_mm;direzione;ciclo;scostamento_um", ";", ("avanti", "indietro")),
    ("pos_mm,dir,cycle,error_um", ",", ("'+", "\N{MINUS SIGN}")),
]


@pytest.mark.parametrize(("header", "between", "ways"), HEADERS)
@pytest.mark.parametrize("mark", ["", "\ufeff", "sep", "Test of X;;;\nSerial no.;4711;;\n;;;\n"])
def test_spreadsheets_of_europe_are_read(tmp_path: Path, header: str, between: str, ways: str, mark: str) -> None:
    rows = [(at, way, run, 0.01 * at + run - 3 * way) for run in (1, 2) for way in (0, 1) for at in (-40.5, 0, 310)]
    point = "." if between == "," else ","
    lines = [
        between.join([f"{at}", ways[way], f"{run}", f"{value:.3f}"]).replace(".", point) for at, way, run, value in rows
    ]
    first = f"sep={between}\n" if mark == "sep" else mark
    found = read(tmp_path, first + "\n".join([header, *lines, between * 3, ""])).found.readings
    values = [(1e3 * each.position[""], 1 - 2 * (each.approach[""] < 0), each.run, 1e6 * each.value) for each in found]
    assert values == [pytest.approx((at, 1 - 2 * way, run, value)) for at, way, run, value in rows]


TRADES = tomllib.loads((Path(__file__).parent / "trade_files.toml").read_text(encoding="utf-8"))["files"]


@pytest.mark.parametrize(("unit", "says", "text"), [row[1:] for row in TRADES], ids=[row[0] for row in TRADES])
def test_a_file_of_a_trade_is_read_as_it_is_meant(tmp_path: Path, unit: str, says: list[object], text: str) -> None:
    last = read(tmp_path, text, unit=unit).found.readings[-1]
    numbers = [*last.position.values(), last.value]
    assert numbers == pytest.approx(says[: len(numbers)])
    assert [*last.approach.values(), last.run, last.axis] == says[len(numbers) :]


@pytest.mark.parametrize(
    ("page", "header"),
    [
        ("cp1250", "Pozycja [mm];Kierunek;Odchyłka [um]"),
        ("cp1251", "Позиция [мм];Направление;Отклонение [мкм]"),
        ("cp1252", "Position visée [mm];Sens;Écart [µm]"),
    ],
)
def test_a_page_of_codes_is_that_in_which_most_words_are_known(tmp_path: Path, page: str, header: str) -> None:
    last = read(tmp_path, f"{header}\n0,0;+;0,5\n1'100,0;-;2,5\n".encode(page)).found.readings[-1]
    assert [last.position[""], last.value] == pytest.approx([1.1, 2.5e-6], abs=0.0)
    assert last.approach[""] == -1


@pytest.mark.parametrize(
    ("header", "unit", "note"),
    [
        ("Pos;1+;1-;2+;2-", 1e-6, "in mm and um (it names no unit)"),
        ("Pos_mm;1+;1-;2+;2-", 1e-6, "deviations in um (it names no unit)"),
        ("Position [mm];Lauf 1 vor [µm];Lauf 1 rück [µm];Lauf 2 vor [µm];Lauf 2 rück [µm]", 1e-6, ""),
        ("target_mm;run1_up_um;run1_down_um;run2_up_um;run2_down_um", 1e-6, ""),
        ("Pos_mm;1 forward_mm;1 reverse_mm;2 forward_mm;2 reverse_mm", 1e-3, ""),
    ],
)
def test_a_column_a_run_is_a_test(tmp_path: Path, header: str, unit: float, note: str) -> None:
    found = read(tmp_path, f"{header}\n10,5;1;2;3;4\n-7;5;6;;8\n").found
    assert found.note == note
    values = {(1e3 * each.position[""], each.approach[""], each.run): each.value / unit for each in found.readings}
    left = {(10.5, 1, 1): 1, (10.5, -1, 1): 2, (10.5, 1, 2): 3, (10.5, -1, 2): 4, (-7, 1, 1): 5, (-7, -1, 1): 6}
    assert values == pytest.approx(left | {(-7, -1, 2): 8})


@pytest.mark.parametrize("header", ["Pos;1+;1-", "Pos_mm;1+;1-"])
def test_deviations_that_may_be_in_mm_need_a_unit(tmp_path: Path, header: str) -> None:
    """They were taken for micrometres, and an accuracy of 39 um for one of 0.039 um."""
    rows = "".join(f"{at};{1e-4 * at:.4f};{1e-4 * at - 0.004:.4f}\n" for at in range(0, 400, 50))
    with pytest.raises(ReadingError, match=r"may be in mm as well as in um. Write Pos_mm and 1\+_um"):
        read(tmp_path, f"{header}\n{rows}")
    named = read(tmp_path, f"Pos_mm;1+_mm;1-_mm\n{rows}").found.readings
    assert max(each.value for each in named) == pytest.approx(35e-6)


def test_a_column_a_run_may_be_of_angles(tmp_path: Path) -> None:
    turned, pitch = (read(tmp_path, f"{at};1+_arcsec\n90;2\n").found.readings[0] for at in ("Pos_deg", "Pos_mm"))
    assert (turned.test, pitch.test) == ("positioning", "angular")
    assert turned.position[""] == pytest.approx(np.pi / 2)
    assert turned.value == pitch.value == pytest.approx(np.radians(2 / 3600))
    for header in ("Pos_deg;1+_um", "Pos_mm;1+_um;1-_arcsec"):
        with pytest.raises(ReadingError, match=r"mix a length and an angle|some runs are lengths, and some are angles"):
            read(tmp_path, f"{header}\n90;{';'.join(header.count(';') * '2')}\n")


def test_a_straightness_test_is_without_its_line(tmp_path: Path) -> None:
    at = np.arange(9) * 50.0
    bent = 5.0 * np.sin(at / 60.0)
    rows = "".join(f"1 {number} {y:.6f}\n" for number, y in enumerate(bent + 0.1 * at + 3.0, 1))
    targets = " ".join(f"{each:.3f}" for each in at)
    text = f"HEADER::\nFile type : rts\nTARGET DATA::\nTarget-count: 9\nTargets: {targets}\nDEVIATIONS::\n{rows}EOF::\n"
    named = [text.replace("rts\n", f"rts\n{unit}\n") for unit in ("Units: um", "Deviation units : \N{MICRO SIGN}m")]
    read_as = [read(tmp_path, each) for each in named] + [read(tmp_path, text, unit="um")]
    assert len({tuple(one.value for one in each.found.readings) for each in read_as}) == 1
    assert read(tmp_path, text, unit="mm").found.readings[0].value == pytest.approx(
        1e3 * read_as[0].found.readings[0].value
    )
    with pytest.raises(ReadingError, match="line 3: the file names its unit, and --unit names another"):
        read(tmp_path, named[0], unit="mm")
    figures = evaluate(positioning_test(read_as[0])).figures
    assert 1e6 * figures["E_up"] == pytest.approx(np.ptp(bent - np.polyval(np.polyfit(at, bent, 1), at)), abs=1e-5)


def test_klipper_prints_where_its_nozzle_stood_and_since_2025_where_the_bed_is_met(tmp_path: Path) -> None:
    probe = setup_text("probe", "probe", direction="z", moves=["X", "Y"], offset=["-33 mm", "-46 mm", "0 mm"])
    campaign = on(BED, probe)
    texts = "// probe at 133.000,96.000 is z=0.125000\n", "// probe: at 100.000,50.000 bed will contact at z=0.125000\n"
    for text in texts:
        path = tmp_path / "console.txt"
        path.write_text(f"Send: PROBE\n{text}// Result is z=0.125000\nok\n")
        found = recognised(path, Around(campaign.machine.axes, campaign.setups))
        assert heights(found) == pytest.approx({(100.0, 50.0): 0.125})


def dumped(drawing: DrawnMap, where: str) -> str:
    """Return an answer of Klipper to bed_mesh/dump_mesh, whose map is in force, or saved alone."""
    low, high = (
        {f"{end}_x": float(drawing.x[at]), f"{end}_y": float(drawing.y[at])} for end, at in (("min", 0), ("max", -1))
    )
    params = {**low, **high, "x_count": len(drawing.x), "y_count": len(drawing.y)}
    saved = {"points": drawing.z.tolist(), "mesh_params": params}
    held = {"name": "hot", "probed_matrix": drawing.z.tolist(), "mesh_params": params}
    none = {"name": "", "probed_matrix": [], "mesh_matrix": []}
    current, profiles = (held, {"other": {}}) if where == "in force" else (none, {"hot": saved})
    beside = {"probe_offsets": [-3.0, 25.0, 0.5], "calibration": {"points": [[0, 0]]}}
    return json.dumps({"result": {"current_mesh": current, "profiles": profiles, **beside}})


@pytest.mark.parametrize("where", ["in force", "saved"])
def test_a_dump_of_klipper_says_where_its_probe_stood(tmp_path: Path, where: str) -> None:
    found = read(tmp_path, dumped(MAPS[0], where))
    assert heights(found) == pytest.approx(MAPS[0].probed(), abs=1e-9)
    assert found.found.readings[0].beside == pytest.approx((-3e-3, 25e-3))


def test_settings_of_moonraker_say_where_the_probe_stood(tmp_path: Path) -> None:
    answer = json.loads(MAPS[0].text("a Moonraker mesh"))
    probe = {"probe": {"x_offset": -33.0, "y_offset": 2}, "axis_twist_compensation": {"z_compensations": []}}
    found = read(tmp_path, json.dumps([answer, {"configfile": {"settings": probe}}]))
    assert heights(found) == pytest.approx(MAPS[0].probed(), abs=1e-9)
    assert found.found.readings[0].beside == pytest.approx((-33e-3, 2e-3))


@pytest.mark.parametrize("between", [",", ";", "\t"])
def test_a_height_map_that_a_spreadsheet_saved_is_read(tmp_path: Path, between: str) -> None:
    lines = MAPS[1].text("a RepRapFirmware map").splitlines()
    cells = [re.sub(r",\s*", "\t", line).replace(".", "." if between == "," else ",") for line in lines[1:]]
    text = "\n".join([lines[0], *(line.replace("\t", between) + 3 * between for line in cells)])
    assert heights(read(tmp_path, text)) == pytest.approx(MAPS[1].probed(), abs=1e-9)


def test_readings_of_few_whole_targets_are_used_without_figures(tmp_path: Path) -> None:
    (tmp_path / "r.csv").write_text("Pos_mm;1+_um;1-_um\n0;0,1;0,2\n100;-;1,2\n200;2,1;n/a\n", encoding="utf-8")
    laser = setup_text("laser", "interferometer", direction="x", moves=["X"], approach="both")
    found = read_in(on(BED, laser), tmp_path / "r.csv")
    assert len(found.readings) == 4
    assert not found.extras.iso230
    assert "4 of 6 cells, for set-up laser" in found.told
