"""A square as an artefact: its legs are straightedges that lie as one, turned by one turn that nobody knows."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager
from dataclasses import replace

from axiscal.description.campaign_schema import SetupTable
from axiscal.document import nearest, shown
from axiscal.exceptions import DescriptionError
from axiscal.measurement.artefact import Artefact
from axiscal.measurement.instruments.displacement import SQUARE
from axiscal.measurement.setup import Setup, Unknown

At = Callable[..., AbstractContextManager[None]]
"""Places failures at the keys of a set-up."""


def on_square(table: SetupTable, artefacts: Mapping[str, Artefact], at: At, setup: Setup) -> Setup:
    """Return a set-up whose straightedge is a leg of a square: the turn of the square instead of a slope of its own.

    Raises DescriptionError for an artefact that is not there, or has balls.
    """
    if table.instrument != "straightedge" or table.artefact is None:
        return setup
    with at("artefact"):
        if table.artefact not in artefacts:
            near = nearest(table.artefact, artefacts)
            remedy = f'Perhaps "{near}" is meant' if near else "Add it under [[artefacts]], with its name alone"
            raise DescriptionError(f"there is no artefact {shown(table.artefact)}", remedy)
        square = replace(artefacts[table.artefact], mounted=table.mounted)
        if square.balls:
            remedy = 'Let the square be an artefact without balls: [[artefacts]] name = "square", turned = "1 mrad"'
            raise DescriptionError(f"{square.name} has balls: a straightedge lies at none", remedy)
    own = tuple(unknown for unknown in setup.unknowns if unknown.name != "slope")
    turns = tuple(Unknown(name, square.turned, square.standing) for name in SQUARE)
    return replace(setup, unknowns=(*own, *turns))
