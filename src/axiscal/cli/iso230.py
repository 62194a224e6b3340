"""`axiscal data iso230`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from axiscal.cli.arguments import Json
from axiscal.cli.printing import say, say_document
from axiscal.evaluation.circle import figures_of
from axiscal.evaluation.one_axis import Positioning
from axiscal.language.spoken import decimals, later, said
from axiscal.units import to_unit

_WORDS = {
    "A": later("accuracy of positioning, bidirectional"),
    "A_up": later("  in the positive direction"),
    "A_down": later("  in the negative direction"),
    "E": later("systematic deviation, bidirectional"),
    "E_up": later("  in the positive direction"),
    "E_down": later("  in the negative direction"),
    "R": later("repeatability, bidirectional"),
    "R_up": later("  in the positive direction"),
    "R_down": later("  in the negative direction"),
    "B": later("reversal, the largest"),
    "B_mean": later("reversal, the mean"),
    "M": later("range of the mean deviation"),
}


_CIRCLE = {
    "G_plus": later("ISO 230-4, circular deviation, counter-clockwise"),
    "G_minus": later("ISO 230-4, circular deviation, clockwise"),
    "G_b": later("ISO 230-4, bidirectional circular deviation"),
    "F_max": later("ISO 230-4, radial deviation, the largest"),
    "F_min": later("ISO 230-4, radial deviation, the smallest"),
    "D": later("ISO 230-4, mean bidirectional radial deviation"),
}


def iso230(
    readings: Annotated[Path, typer.Argument(metavar="READINGS.csv", help="The test; its columns say which one.")],
    json: Json = False,
) -> None:
    """Print the figures of ISO 230-2 or ISO 230-4.

    The columns say what was tested: an axis or a circle.

    Positioning, ISO 230-2: target_mm, direction (+ or -), run, deviation_um; target_deg and deviation_arcsec for a
    rotary axis; a Renishaw .rtl file of a linear axis does as well. Behind ± stands how far each figure scatters when
    the test is repeated (k = 2).
    Circle, ISO 230-4: angle_deg, direction (+ counter-clockwise), deviation_um of the radius.

    \b
    Example:
      axiscal data iso230 readings.csv
    """

    found = figures_of(readings)
    document = found.as_json()
    if json:
        say_document(document)
        return
    if isinstance(found, Positioning):
        _say_positioning(found)
    else:
        for name, value in found.figures.items():
            figure = decimals(f"{to_unit(value, 'um'):10.3f}")
            say(f"{name:20}{figure} um   {said(_CIRCLE[name])}")
    for warning in found.warnings:
        say(warning)


def _say_positioning(found: Positioning) -> None:
    document, unit = found.as_json(), "arcsec" if found.rotary else "um"
    for name, words in _WORDS.items():
        value = document[name]
        figure = f"{said('not measured'):>12}"
        if value is not None:
            figure = decimals(f"{value:12.3f} {unit} ± {to_unit(found.uncertainty[name], unit):.3f}")
        say(f"{name:7}{figure}   {said(words)}")
    if found.vdi3441:
        shown = ", ".join(f"{name} {to_unit(value, unit):.3f}" for name, value in found.vdi3441.items())
        say(decimals(f"VDI/DGQ 3441: {shown} {unit}"))
