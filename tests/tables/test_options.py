"""Options of `axiscal export`: each format uses what it says that it takes, and refuses all others by name."""

import re
from functools import cache

import pytest

from axiscal.exceptions import TableError
from axiscal.machine.description import machine_from_text
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.loaded import OldFile
from axiscal.tables.registry import controllers, export, exporter, refuse_untaken
from axiscal.tables.round_trip import drawn_and_known
from tests.generators.texts import machine_text
from tests.tables.test_controllers import COM, FANUC, known

TRAVELS = {"X": (0, 300), "Y": (0, 200), "Z": (0, 100)}

GIVEN: dict[str, dict[str, object]] = {
    "--spacing": {"spacing": 0.05},
    "--unit": {"unit": "in"},
    "--number": {"numbers": {"X": (2,), "Y": (1,), "Z": (0,)}},
    "--template": {"template": COM},
    "--mesh": {"mesh": 4},
    "--measuring-system": {"encoder": 2},
    "--on-top-of": {"old_files": (OldFile("X.csv", ""),)},
}
ELSEWHERE = ("--ini",)
"""Options that stand in no field of the choices."""
TEMPLATES = {"fanuc": FANUC, "heidenhain": COM}


def written(controller: str, **given: object) -> dict[str, str]:
    """Return the files for a machine that somebody knows."""
    options = {"template": TEMPLATES.get(controller), **given}
    return dict(export(known("small")[0], controller, ExportOptions(**options)).files)  # type: ignore[arg-type]


@cache
def plain(controller: str) -> dict[str, str]:
    """Return the files where no option is given."""
    return written(controller)


@pytest.mark.parametrize("option", [*GIVEN, *ELSEWHERE])
@pytest.mark.parametrize("controller", controllers())
def test_an_option_that_a_format_does_not_take_is_refused_with_those_that_do(controller: str, option: str) -> None:
    made = exporter(controller)
    if option in made.takes:
        refuse_untaken(controller, [option])
        return
    with pytest.raises(TableError, match=f"^{controller} does not take {option}. ") as refusal:
        written(controller, **GIVEN[option]) if option in GIVEN else refuse_untaken(controller, [option])
    takers = [name for name in controllers() if option in exporter(name).takes]
    assert option == "--on-top-of" or all(re.search(rf"\b{name}\b", str(refusal.value)) for name in takers)
    assert takers


@pytest.mark.parametrize(
    ("controller", "option"),
    [
        (controller, option)
        for controller in controllers()
        for option in sorted(exporter(controller).takes)
        if option in GIVEN.keys() - {"--template", "--on-top-of"}
    ],
)
def test_an_option_that_a_format_takes_changes_its_files(controller: str, option: str) -> None:
    given = GIVEN[option]
    if option == "--number" and not controller.startswith("linuxcnc"):
        given = {"numbers": {"X": (2,), "Y": (1,), "Z": (3,)}}
    if option == "--number" and controller == "fanuc":  # its template has other points for Y
        with pytest.raises(TableError, match="the points of X reach"):
            written(controller, **given)
    else:
        assert written(controller, **given) != plain(controller)


@pytest.mark.parametrize("against", ["X", "C"])
def test_isg_names_the_axes_that_count_against_the_kernel(against: str) -> None:
    text = machine_text("w-C'-b-X-Y-Z-t", {**TRAVELS, "C": (0, 360)}, {"EXX": ("10 um", 7, 150)})
    plain, turned = (
        export(drawn_and_known(machine_from_text(each)), "isg", ExportOptions()).readme
        for each in (text, text.replace(f"[axes.{against}]", f'[axes.{against}]\ndirection = "reversed"'))
    )
    assert f"{against}: direction is reversed in machine.toml." in turned
    assert "direction is reversed" not in plain
