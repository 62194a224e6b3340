"""A plan as Python shows it: figures, places, a table and a picture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from axiscal.estimation.case import Case
from axiscal.measurement.place import Place
from axiscal.measurement.place_texts import approach_text, place_text
from axiscal.planning.next_readings import placed
from axiscal.planning.proposal import Proposal
from axiscal.present.plan_answer import PlanAnswer
from axiscal.present.plan_words import bound_sentence
from axiscal.python.pictures import html_table
from axiscal.units import from_unit, to_unit

if TYPE_CHECKING:
    from axiscal.python.pictures import NotebookPicture


@dataclass(frozen=True, eq=False, repr=False)
class PlanResult:
    """A plan of a case."""

    case: Case
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
        from axiscal.python.pictures import plan_picture

        return plan_picture(self.answer)

    def __len__(self) -> int:
        return len(self.proposal.plan.readings)

    def __repr__(self) -> str:
        said = f"{to_unit(self.rms, 'um'):.3g} um after {self.minutes:.1f} min"
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
