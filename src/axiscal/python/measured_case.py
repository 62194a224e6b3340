"""A machine and the set-ups to measure on it, in Python, without a file on disk.

Set-ups have the keys of campaign.toml, whose quantities are texts with their units.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.document.quoting import toml_value
from axiscal.estimation.case import Case as Mathematics
from axiscal.estimation.inheritance import case_of
from axiscal.exceptions import DescriptionError
from axiscal.machine.description import Machine
from axiscal.measurement.instruments.written import name_of
from axiscal.measurement.reading import Place, approach_text, place_text
from axiscal.planning.next_readings import CANDIDATES, placed
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import Proposal, proposed
from axiscal.present.drawing.svg_picture import Figure, alone, axis_style, layout, line_trace, picture
from axiscal.present.plan_answer import PlanAnswer, plan_answer
from axiscal.present.plan_words import bound_sentence
from axiscal.units import format_quantity, from_unit, to_unit
from axiscal_core.instrument import Instrument
from axiscal_core.refusals import listed, one, whole, within
from axiscal_core.units import METRES, Quantity, in_minutes, si


def html_table(heads: Sequence[str], rows: Sequence[Sequence[str]], caption: str) -> str:
    """Return a table with a caption."""
    head = "".join(f"<th>{escape(text)}</th>" for text in heads)
    body = "".join("<tr>" + "".join(f"<td>{escape(text)}</td>" for text in row) + "</tr>" for row in rows)
    return f"<table><caption>{escape(caption)}</caption><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


LINE, FILL = "#1f5fa8", "rgba(31, 95, 168, 0.18)"
_WIDE, _NARROW, HEIGHT = 640, 360, 260
"""Pixels; a matter of taste."""


@dataclass(frozen=True, slots=True)
class NotebookPicture:
    """A picture that a notebook shows.

    figures : side by side, each a dict of `data` and `layout` as plotly's schema names them
    """

    figures: tuple[Figure, ...]

    @property
    def svg(self) -> tuple[str, ...]:
        """Each figure as the text of an SVG file."""
        width = _WIDE if len(self.figures) == 1 else _NARROW
        return tuple(alone(picture(figure, width, figure["name"])) for figure in self.figures)

    def _repr_html_(self) -> str:
        return "".join(self.svg)


SetupKeys = Mapping[str, Any]
"""A set-up before it stands on a machine: the keys of a [[setups]] table of campaign.toml."""


def setup(
    instrument: str | type[Instrument],
    direction: str | Sequence[float] | None = None,
    *,
    moves: Sequence[str] | None = None,
    name: str | None = None,
    **keys: Any,
) -> SetupKeys:
    """Return a set-up with the instrument's usual noise, unknowns and times.

    instrument : its name, or a class derived from `axiscal_core.Instrument`
    direction : "x", "-y" or a vector, for instruments that read along or about one; moves : axes, default all
    keys : of campaign.toml, quantities as text: noise="0.3 um", approach="both", park={"Y": "250 mm"}
    """
    one("setup", "instrument", instrument, (str, type), '"interferometer", or a class of your own')
    if isinstance(instrument, type):
        name, instrument = name or instrument.__name__.lower(), name_of(instrument)
    usual = " ".join([instrument, *([direction] if isinstance(direction, str) else []), *(moves or ())])
    stated = {"name": name or usual, "instrument": instrument, "direction": direction, "moves": moves, **keys}
    return {key: value for key, value in stated.items() if value is not None}


@dataclass(frozen=True, eq=False, repr=False)
class PlanResult:
    """A plan of a case."""

    case: Mathematics
    proposal: Proposal
    answer: PlanAnswer

    @property
    def rms(self) -> float:
        """The RMS standard deviation over the volume after the last reading, m."""
        return self.proposal.plan.accuracy.rms

    @property
    def minutes(self) -> float:
        """The time that mounting, ways, settling and reading take."""
        return to_unit(self.proposal.plan.seconds, "min")

    @property
    def bound(self) -> float | None:
        """The RMS that no plan of as many readings from the same candidates can beat, m; None where it is not known."""
        found = self.answer.bound_rms_um
        return None if found is None else from_unit(found, "um")

    @property
    def places(self) -> tuple[Place, ...]:
        """Where to read, in order."""
        return placed(self.case, self.proposal.plan)

    @property
    def document(self) -> dict[str, Any]:
        """The plan as `axiscal plan --json` prints it."""
        return self.answer.model_dump(mode="json", by_alias=True)

    def plot(self) -> NotebookPicture:
        """Return a picture: the accuracy after each reading against the minutes."""
        bound, points = self.answer.bound_rms_um, self.answer.points
        minutes = [0.0, *(point.minutes for point in points)]
        rms = [self.answer.before_rms_um, *(point.rms_um for point in points)]
        read = line_trace(minutes, rms, LINE, 1.5) | {"mode": "lines+markers", "marker": {"color": LINE, "size": 6}}
        ends = [minutes[0], minutes[-1]]
        floor = [] if bound is None else [line_trace(ends, [bound, bound], LINE, 1.5, "dot")]
        drawn = layout(axis_style("minutes"), axis_style("RMS, µm", rangemode="tozero"), HEIGHT)
        return NotebookPicture(({"name": "accuracy of a plan", "data": [read, *floor], "layout": drawn},))

    def __len__(self) -> int:
        return len(self.proposal.plan.readings)

    def __repr__(self) -> str:
        said = f"{format_quantity(self.rms, 'um', 3)} after {self.minutes:.1f} min"
        return f"<plan of {len(self)} readings: {said}. {bound_sentence(self.answer)}>"

    def _repr_html_(self) -> str:
        axes = self.case.description.machine.axes
        pairs = enumerate(zip(self.places, self.proposal.plan.readings, strict=True), 1)
        rows = [
            [
                str(number),
                place.setup,
                place_text(axes, place.pose),
                approach_text(axes, place.approach),
                f"{to_unit(reading.accuracy.rms, 'um'):.3g}",
                f"{to_unit(reading.seconds, 'min'):.1f}",
            ]
            for number, (place, reading) in pairs
        ]
        heads = ["reading", "set-up", "place", "coming", "RMS after it, um", "minutes"]
        return html_table(heads, rows, bound_sentence(self.answer))


class Case:
    """A machine and set-ups on it.

    machine : of `load_machine`; setups : of `setup`; target : keys of [target] in campaign.toml, such as
        {"rms": "2 um"}; learn : sizes, smoothness and noise are learnt from the readings
    raises DescriptionError, UnitError or axiscal_core.InputError for what makes no sense on this machine
    """

    def __init__(
        self,
        machine: Machine,
        setups: Sequence[SetupKeys],
        target: Mapping[str, Any] | None = None,
        learn: bool = False,
    ) -> None:
        one("Case", "machine", machine, Machine, 'load_machine("dmu60")')
        scales, every = "estimate" if learn else "stated", listed("Case", "setups", setups)
        keys = {"machine": machine.name, "scales": scales, "target": {} if target is None else target, "setups": every}
        try:
            text = "".join(f"{key} = {toml_value(value)}\n" for key, value in keys.items())
        except TypeError as fault:
            what, remedy = "a set-up cannot be written ({fault})", "Give texts, numbers, lists and mappings"
            raise DescriptionError(what, remedy, fault=fault) from fault
        described = campaign_from_texts(text, "the case", machine.text, machine.name, fine_knots=machine.fine_knots)
        self.description, self.inner = described, case_of(described)

    @classmethod
    def of(cls, description: CampaignDescription) -> Case:
        """Return the case of a campaign that was described in a file."""
        one("Case.of", "description", description, CampaignDescription, 'read_campaign("campaign.toml")')
        case = cls.__new__(cls)
        case.description, case.inner = description, case_of(description)
        return case

    def plan(
        self,
        readings: int | None = None,
        *,
        rms: Quantity | None = None,
        minutes: Quantity | None = None,
        candidates: int = CANDIDATES,
    ) -> PlanResult:
        """Return the readings that serve best together, with what no plan can beat.

        At least one of them ends it: so many readings, an RMS over the volume reached, so many minutes.
        raises PlanError, axiscal_core.InputError
        """
        where = "Case.plan"
        count = None if readings is None else whole(where, "readings", readings, 1)
        wanted = None if rms is None else within(where, "rms", si(rms, where, "rms", METRES), 0.0, open_end=True)
        seconds = None if minutes is None else 60.0 * in_minutes(minutes, where, "minutes")
        limits = Limits(count, wanted, None, seconds)
        proposal = proposed(self.inner, limits, whole(where, "candidates", candidates, 1), bounded=True)
        return PlanResult(self.inner, proposal, plan_answer(self.inner, proposal, limits))

    def __repr__(self) -> str:
        names = ", ".join(setup.name for setup in self.description.setups)
        return f"<Case {self.description.machine.name}: {names}>"
