"""Rows that a target asks for: what is understood, refused with its line, or described and read by nobody."""

from dataclasses import replace

import pytest

from axiscal.description.artefacts import unused_artefacts
from axiscal.description.campaign import campaign_from_texts
from axiscal.description.target import Target, rows_of
from axiscal.machine import load_machine
from tests.generators.texts import setup_text

MILL, FIVE = load_machine("three-axis-mill"), load_machine("dmu60")
LASER = setup_text("laser", "interferometer", direction="x", moves=["X"])
CAMPAIGN = f'machine = "m"\n[target]\nreadings = 5\n{{line}}\n{LASER}'


def _target(line: str, machine: str = MILL.text) -> Target:
    return campaign_from_texts(CAMPAIGN.format(line=line), "c.toml", machine, "m").target


def test_rows_with_limits_and_without() -> None:
    texts = (
        '"positioning X 5 um", "Backlash  x", "straightness Y in Z 0.003 mm", "squareness XY 10 urad", "yaw Y 2 arcsec"'
    )
    wants = _target(f"wants = [{texts}]").wants
    assert [want.row.name for want in wants] == [
        "positioning X",
        "backlash X",
        "straightness Y in Z",
        "squareness XY",
        "yaw Y",
    ]
    assert [want.limit for want in wants] == [5e-6, None, pytest.approx(3e-6), 1e-5, pytest.approx(9.696e-6, rel=1e-3)]


@pytest.mark.parametrize("written", ["XZ", "ZX", "xz", "zX"])
def test_a_plane_is_named_in_any_order_and_case(written: str) -> None:
    (want,) = _target(f'wants = ["Squareness {written} 10 urad"]').wants
    assert (want.row.name, want.limit) == ("squareness XZ", 1e-5)


def test_a_rotary_axis_has_a_centre_and_is_positioned_by_angles() -> None:
    text = CAMPAIGN.format(line='wants = ["centre of C 3 um", "tilt of B 9 urad", "positioning C 4 urad"]')
    text = text.replace('moves = ["X"]', 'moves = ["X"]\npark = { Y = "0 mm", Z = "250 mm" }')
    wants = campaign_from_texts(text, "c.toml", FIVE.text, "m").target.wants
    assert [(want.row.kind, want.row.axes, want.limit) for want in wants] == [
        ("centre", ("C",), 3e-6),
        ("tilt", ("B",), 9e-6),
        ("positioning", ("C",), 4e-6),
    ]


def test_every_row_is_understood_by_its_own_name() -> None:
    names = [row.name for row in rows_of(MILL)]
    assert len(names) == len(set(names)) == 3 + 3 + 3 + 6 + 9 + 3 + 1
    wants = _target(f"wants = [{', '.join(map(repr, names))}]").wants
    assert [want.row for want in wants] == rows_of(MILL)


def test_a_limit_of_the_volume_is_its_u() -> None:
    assert _target('wants = ["volume 20 um"]').expanded == 20e-6
    assert replace(_target('U = "20 um"'), wants=()) == replace(_target('wants = ["volume 20 um"]'), wants=())


BALL = '[[artefacts]]\nname = "{}"\nballs = {{ one = ["{} mm", "0 mm", "0 mm"] }}\n'
TOUCHED = '[[setups]]\nname = "touched"\ninstrument = "sphere"\nartefact = "left"\n'


def said_of(*names: str) -> str | None:
    balls = "".join(BALL.format(name, 50 * number) for number, name in enumerate(names, start=1))
    return unused_artefacts(f'machine = "dmu60"\n{balls}{TOUCHED}')


def test_an_artefact_that_nobody_reads_is_named() -> None:
    assert said_of("left") is None
    said = said_of("left", "right")
    assert said is not None
    assert '"right"' in said
    assert '"left"' not in said
    assert "artefact = " in said
