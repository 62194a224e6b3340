"""How far a probe stands beside the nozzle: read from a printer's files, else a plan asks."""

from pathlib import Path

import pytest

from axiscal.description.campaign import read_campaign
from axiscal.description.placed_readings import file_readings
from axiscal.measurement.readers.files import read_any
from axiscal.measurement.readers.probe_offset import offset_in
from axiscal.present.plan_words import open_questions
from benchmarks.zoo.animals import Job
from benchmarks.zoo.beds import rolled
from benchmarks.zoo.running import described, given

TWIST = "calibrate_y: 10\n#*# [axis_twist_compensation]\n#*# z_compensations = -0.01, 0.0, 0.01\n"
"""By which Klipper makes the heights those that the nozzle would touch (axis_twist_compensation.py)."""
ONE = Job("printer-gantry", ("probe",), "50 um", (('["klipper", "marlin", "reprapfirmware"]', '["klipper"]'),))
"""A bed whose tables one control gets: those of all three take seconds."""
MESH = rolled(1e-3, 2, (7.5, -28.0))(0).readings


@pytest.mark.parametrize(
    ("text", "beside"),
    [
        ("[probe]\nx_offset: -33\ny_offset: -46.5  # in front\nz_offset: 1\n", (-33, -46.5)),
        ("[display]\nx_offset: 3\n[probe_eddy_current btt]\ny_offset: 21\n", (0, 21)),
        ("[probe]\npin: PA0\n", None),
        ("echo:; Z-Probe Offset (mm):\necho:  M851 X-44.00 Y-6.50 Z-1.78\n", (-44, -6.5)),
        ("; G31 X1 Y1\nM558 P9\nG31 P25 X2.5 Y30 Z2.1\n", (2.5, 30)),
        ("M420 S1\n", None),
        (f"[probe]\ny_offset: 46\n[axis_twist_compensation]\n{TWIST}", (0, 0)),
        ("[probe]\ny_offset: 46\n[axis_twist_compensation]\ncalibrate_y: 10\n", (0, 46)),
        ("[probe]\ny_offset\n  5\n", None),  # a line behind a bare key, on which Python's reader fails
    ],
)
def test_reads_what_each_firmware_calls_it(text: str, beside: tuple[float, float] | None) -> None:
    found = offset_in(text)
    assert found is beside or found == pytest.approx([1e-3 * each for each in beside or ()])


def test_a_bed_map_brings_its_own_and_the_record_says_it(tmp_path: Path) -> None:
    campaign, cfg, out = described(ONE, tmp_path / "job"), tmp_path / "printer.cfg", tmp_path / "out"
    cfg.write_text(MESH)
    assert any(each.startswith("How far does the probe") for each in open_questions(read_campaign(campaign)))
    found = given("data", "estimate", campaign, cfg, "--out", out)
    assert found.status == 0
    assert "looks 29 mm beside the tool point" in " ".join((found.out + found.err).split())
    assert r"offset = [\"7.5 mm\", \"-28 mm\", \"0 mm\"]" in (out / "campaign.axiscal").read_text(errors="replace")
    text, moves = campaign.read_text(), 'moves = ["X", "Y"]'
    campaign.write_text(text.replace(moves, f'{moves}\noffset = ["7.5 mm", "-28 mm", "-1 mm"]'))
    stated = read_campaign(campaign)
    assert file_readings(tuple(read_any(cfg)), stated, cfg)[0] is stated
    campaign.write_text(text.replace(moves, f'{moves}\noffset = ["7.5 mm", "28 mm", "0 mm"]'))
    refused = given("data", "estimate", campaign, cfg, "--out", tmp_path / "other")
    assert refused.status == 1
    assert 'along x and y by this file, and 7.5 mm 28 mm by "probe"' in " ".join(refused.err.split())


@pytest.mark.parametrize("instrument", ["level", "tracker"])
def test_what_looks_at_the_tool_point_has_no_offset(tmp_path: Path, instrument: str) -> None:
    place = f'instrument = "{instrument}"\n'
    job = Job("three-axis-mill", (instrument,), "20 um", ((place, f'{place}offset = ["1 mm", "0 mm", "0 mm"]\n'),))
    found = given("plan", described(job, tmp_path / "job"))
    assert found.status == 1
    assert "offset without an instrument that reads a length in one direction" in " ".join(found.err.split())
