"""campaign.toml as described in docs/campaign.md: the page's own example and its table of what may be left out."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest

from axiscal.description.campaign import Era, campaign_from_texts, read_campaign
from axiscal.machine import load_machine
from axiscal.measurement.instrument import INSTRUMENTS
from axiscal.measurement.setup import Unknown
from axiscal.units import format_quantity

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "campaign.md").read_text(encoding="utf-8")
EXAMPLE = PAGE.split("```toml\n")[1].split("```")[0]


def test_the_page_s_example_means_what_it_says(tmp_path: Path) -> None:
    (tmp_path / "c.toml").write_text(EXAMPLE)
    campaign = read_campaign(tmp_path / "c.toml")
    target, laser, dial = campaign.target, *campaign.setups
    assert (target.expanded, target.rms, target.worst, target.readings, target.budget) == (1e-5, None, None, 40, None)
    assert (laser.direction, laser.moves, laser.park) == ((1, 0, 0), (0,), (0.3, 0.25, 0.3))
    assert laser.unknowns == (Unknown("zero", 1e-4),)
    assert (laser.raster, laser.approach) == ((0.01, 0, 0), "both")
    assert (laser.resolution, laser.scatter) == pytest.approx((1e-7, 3e-7))
    assert laser.noise == pytest.approx(math.hypot(3e-7, 1e-7 / math.sqrt(12)))
    assert (laser.setup_time, laser.settle, laser.reading_time) == (1800, 1, 3)
    assert (dial.approach, dial.raster, dial.park) == ("+", (0, 0, 0), (0.3, 0.2, 0.2))
    assert dial.unknowns == (Unknown("zero", 1e-3), Unknown("slope", 1e-3))


def test_each_line_of_the_target_that_the_page_comments_out_can_be_used(tmp_path: Path) -> None:
    (tmp_path / "c.toml").write_text(re.sub(r"^# (?=\w+ = )", "", EXAMPLE.partition("[[")[0], flags=re.MULTILINE))
    lines = (tmp_path / "c.toml").read_text().partition("[target]")[2]
    (tmp_path / "c.toml").write_text(f'machine = "three-axis-mill"\n[target]{lines}[[{EXAMPLE.partition("[[")[2]}')
    target = read_campaign(tmp_path / "c.toml").target
    assert (target.rms, target.worst, target.readings, target.budget) == (6e-6, 12e-6, 40, 10800)
    assert target.volume == ((0.05, 0.55), (0.0, 0.4), (0.0, 0.4))
    assert len(target.wants) == 3


@pytest.mark.parametrize(
    ("written", "direction"),
    [
        ('"x"', (1, 0, 0)),
        ('"-y"', (0, -1, 0)),
        ('"+Z"', (0, 0, 1)),
        ("[0, 0, -3]", (0, 0, -1)),
        ("[3, 4.0, 0]", (0.6, 0.8, 0)),
        ("[1e-9, 1e-9, 1e-9]", (1 / math.sqrt(3),) * 3),
    ],
)
def test_directions(written: str, direction: tuple[float, ...]) -> None:
    text = EXAMPLE.replace('direction = "x"', f"direction = {written}")
    campaign = campaign_from_texts(text, "c.toml", load_machine("three-axis-mill").text, "m")
    assert campaign.setups[0].direction == pytest.approx(direction, abs=1e-15)
    assert math.hypot(*campaign.setups[0].direction) == pytest.approx(1, abs=1e-15)


def test_the_table_of_defaults_is_the_program_s() -> None:
    rows = re.findall(r"^\| (\w+) \| (length|angle) [^|]*\|(.*)\|$", PAGE, re.MULTILINE)
    assert [row[0] for row in rows] == list(INSTRUMENTS)
    for name, reads, rest in rows:
        kind, usual = INSTRUMENTS[name], INSTRUMENTS[name].usual
        unit = "um" if reads == "length" else "urad"
        unknowns = [
            (u.name, format_quantity(u.std, "um" if kind.unknown_reads[u.name] == "length" else "urad"))
            for u in usual.unknowns
        ]
        expected = [
            format_quantity(usual.noise, unit),
            ", ".join(f"{unknown} {std}" for unknown, std in unknowns),
            format_quantity(usual.setup_time, "min"),
            format_quantity(usual.settle, "s"),
            format_quantity(usual.reading_time, "s"),
        ]
        assert (kind.reads, [cell.strip() for cell in rest.split("|")]) == (reads, expected)


@pytest.mark.parametrize(
    ("controls", "lines", "begun_before", "noise"),
    [
        ('["klipper"]', "", False, 5e-6),
        ('["marlin", "reprapfirmware"]', "", False, 5e-6),
        ('["klipper"]', 'noise = "2 um"\n', False, 2e-6),
        ('["klipper", "linuxcnc"]', "", False, 1e-6),
        ('["klipper"]', "", True, 1e-6),
    ],
)
def test_the_probe_of_a_printer_reads_as_its_owners_say(
    controls: str, lines: str, begun_before: bool, noise: float
) -> None:
    text = f'machine = "printer-gantry"\ncontrols = {controls}\n[target]\nreadings = 5\n[[setups]]\nname = "probe"\n'
    text += f'instrument = "probe"\ndirection = "z"\nmoves = ["X", "Y"]\n{lines}'
    printer = load_machine("printer-gantry").text
    (probe,) = campaign_from_texts(text, "c.toml", printer, "m.toml", era=Era(not begun_before)).setups
    assert probe.noise == noise
