"""What the core knows has its report, of a machine of somebody's own as of any other."""

import re
import runpy
from pathlib import Path

import numpy as np
import pytest

import axiscal as ac
from tests.golden.surfaces import lines_of


@pytest.fixture(scope="module")
def known() -> ac.Known:
    """A beam with a curve, and a tilt of the tool; the third of ten readings is wrong."""
    errors: list[ac.Error | ac.Basis] = [
        ac.Error("EXX", "20 um", length="150 mm"),
        ac.Offset("tilt", "tool", (0, 0, 0, 0, 1, 0), "50 urad"),
    ]
    machine = ac.Machine([ac.Axis.linear("X", "x", (0, "600 mm"))], errors, tool="100 mm")
    laser = ac.Laser("laser", "X", noise="0.5 um", approach="+")
    level = ac.Level("level", "X", about="y", noise="1 urad", approach="+")
    case = ac.Case(machine, [laser, level], usual="off", sure="exactly")
    poses = np.linspace(0, 0.6, 10)[:, None]
    places = ac.Places("laser", poses, np.ones_like(poses)) + ac.Places("level", poses[:1], [[1]])
    readings = ac.Readings.simulated(case, places, 4)
    values = readings.values.copy()
    values[2] += 300e-6
    return case.estimate(ac.Readings(places, values))


@pytest.mark.parametrize(
    ("language", "said"),
    [
        ("en", ["Calibration report", "Error curves", "Not believed, marked ×: readings 3.", "3×", "position, mm"]),
        (
            "de",
            [
                "Kalibrierbericht",
                "Fehlerkurven",
                "Nicht geglaubt, mit × gekennzeichnet: Messungen 3.",
                "3×",
                "Position, mm",
            ],
        ),
    ],
)
def test_the_report_says_what_is_known(known: ac.Known, tmp_path: Path, language: str, said: list[str]) -> None:
    made = ac.report(known, tmp_path / "out", title="Beam 4", language=language)
    words = lines_of(made)
    assert [each for each in (*said, "Beam 4", "laser.zero", "EXX", "tilt") if each not in words] == []
    figures = [f"{1e6 * size:.3g}".replace(".", "," if language == "de" else ".") for size in (known.U, known.rms)]
    assert [each for each in figures if f"{each} µm" not in words] == []
    (row,) = re.findall(r"tilt +(\S+) ± (\S+) µrad", words)
    mean, half = (float(each.replace(",", ".").replace("−", "-")) for each in row)
    tilt = known.names.index("tilt[0]")
    assert mean == pytest.approx(1e6 * known.mean[tilt], abs=0.05 * half)
    assert half == pytest.approx(1e6 * 1.96 * known.covariance[tilt, tilt] ** 0.5, rel=5e-3)


def tracer() -> ac.Case:
    """Return a mill that a tracer reads from where nobody knows to 50 mm."""
    axes = [ac.Axis.linear(name, name.lower(), (0, "500 mm")) for name in "XYZ"]
    errors = [ac.Error(f"E{c}{name}", "8 um", length="250 mm", knots=4) for name in "XYZ" for c in "XYZ"]
    unknown = {"zero": "1 mm"} | dict.fromkeys(("station_x", "station_y", "station_z"), "50 mm")
    unknown |= dict.fromkeys(("tool_x", "tool_y", "tool_z"), "0 mm")
    bar = ac.BallBar("tracer", "XYZ", ("700 mm", "-200 mm", "100 mm"), unknowns=unknown, approach="+")
    return ac.Case(ac.Machine(axes, errors), [bar], sure="exactly")


@pytest.mark.long
@pytest.mark.parametrize("machine", ["core_camera", "core_delta", "core_robot", "tracer"])
def test_a_strangers_machine_goes_from_python_to_its_report(machine: str, tmp_path: Path) -> None:
    example = Path(__file__).parents[2] / "examples" / f"{machine}.py"
    case = tracer() if machine == "tracer" else runpy.run_path(str(example))["case"]
    known = case.estimate(ac.Readings.simulated(case, case.lattice(40), seed=3))
    assert known.rms < 0.7 * case.known(case.prior.mean, case.prior.covariance).rms
    words = lines_of(ac.report(known, tmp_path, title=machine))
    assert [each for each in (machine, *case.setups, f"{1e6 * known.U:.3g}") if each not in words] == []
    last = (tmp_path / "unknowns.csv").read_text(encoding="utf-8").splitlines()[-1]
    assert last.startswith(f"{case.names[-1]},")


def test_what_comes_from_no_readings_has_none(known: ac.Known, tmp_path: Path) -> None:
    bare = ac.Known.of(known.case, known.mean, known.covariance)
    with pytest.raises(ac.InputError, match="known comes from no readings"):
        ac.report(bare, tmp_path)
    with pytest.raises(ac.InputError, match=r"report.*known"):
        ac.report("robot", tmp_path)  # type: ignore[arg-type]
    with pytest.raises(ac.InputError, match="report: language = 'xx' is unknown"):
        ac.report(known, tmp_path, language="xx")
    with pytest.raises(ac.InputError, match="report: title = '' is no name"):
        ac.report(known, tmp_path, title="")
    assert not (tmp_path / "report.pdf").exists()
