"""`axiscal iso230`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from axiscal.cli.arguments import Json
from axiscal.cli.printing import say, say_document
from axiscal.evaluation import evaluate, read_iso230
from axiscal.units import to_unit

_WORDS = {
    "A": "accuracy of positioning, bidirectional",
    "A_up": "  in the positive direction",
    "A_down": "  in the negative direction",
    "E": "systematic deviation, bidirectional",
    "E_up": "  in the positive direction",
    "E_down": "  in the negative direction",
    "R": "repeatability, bidirectional",
    "R_up": "  in the positive direction",
    "R_down": "  in the negative direction",
    "B": "reversal, the largest",
    "B_mean": "reversal, the mean",
    "M": "range of the mean deviation",
}


def iso230(
    readings: Annotated[Path, typer.Argument(metavar="READINGS.csv", help="target_mm, direction, run, deviation_um.")],
    json: Json = False,
) -> None:
    """Print the ISO 230-2 figures of one axis.

    Columns: target_mm, direction (+ or -), run, deviation_um; target_deg and deviation_arcsec for a rotary axis. A
    Renishaw .rtl file of a linear axis does as well. Behind ± stands how far each figure scatters when the test is
    repeated (k = 2).

    \b
    Example:
      axiscal iso230 readings.csv
    """

    found = evaluate(read_iso230(readings))
    document = found.as_json()
    if json:
        say_document(document)
        return
    for name, words in _WORDS.items():
        value = document[name]
        figure = f"{'not measured':>12}"
        if value is not None:
            spread = to_unit(found.uncertainty[name], "arcsec" if found.rotary else "um")
            figure = f"{value:12.3f} {document['unit']} ± {spread:.3f}"
        say(f"{name:7}{figure}   {words}")
    if found.vdi3441:
        unit = "arcsec" if found.rotary else "um"
        shown = ", ".join(f"{name} {to_unit(value, unit):.3f}" for name, value in found.vdi3441.items())
        say(f"VDI/DGQ 3441: {shown} {unit}")
    warnings = document["warnings"]
    for warning in warnings if isinstance(warnings, list) else []:
        say(str(warning))
