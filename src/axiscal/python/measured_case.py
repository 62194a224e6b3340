"""A machine and the set-ups to measure on it, in Python, without a file on disk: planned, judged and estimated."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from axiscal.description.campaign import CampaignDescription, campaign_from_texts, read_campaign
from axiscal.document.quoting import toml_value
from axiscal.estimation.accuracy.expanded import expanded
from axiscal.estimation.accuracy.yardstick import Root, joint_root
from axiscal.estimation.case import Case as Mathematics
from axiscal.estimation.case import timed
from axiscal.estimation.estimate import estimated
from axiscal.estimation.inheritance import case_of
from axiscal.estimation.located import absorbed
from axiscal.estimation.promise.problem import Inherited
from axiscal.exceptions import DescriptionError, InputError, PlanError, TargetError
from axiscal.machine.description import Machine
from axiscal.measurement.instrument import scales_of
from axiscal.measurement.reading import Reading, approach_text, place_text
from axiscal.measurement.reading_rows import blank_readings, places_of, rows_at, shown_by_each, visited
from axiscal.planning.enough import reached_by
from axiscal.planning.next_readings import CANDIDATES, placed, posed
from axiscal.planning.plan.plan import judged
from axiscal.planning.plan.task import Limits
from axiscal.planning.promise import foreseen
from axiscal.planning.proposal import OwnCriterion, Proposal, SoFar, proposed, refuse_endless, refuse_out_of_reach
from axiscal.present.drawing.plot import Plot
from axiscal.present.plan_answer import PlanAnswer, plan_answer
from axiscal.present.plan_words import bound_sentence
from axiscal.python import given
from axiscal.python.estimated import Estimated, NotebookPicture, html_table, names_of
from axiscal.python.given import GivenPlaces, GivenReadings, PlannedPlaces, SetupKeys, readings_of
from axiscal.units import format_quantity, to_unit
from axiscal_core import refusals
from axiscal_core.case import Case as OwnCase
from axiscal_core.criterion import Criterion, goal
from axiscal_core.instrument import Instrument
from axiscal_core.machine import Machine as OwnMachine
from axiscal_core.normal import Normal
from axiscal_core.places import Places
from axiscal_core.plan import Evaluation
from axiscal_core.refusals import Array, finite, listed, one, spread, whole, within
from axiscal_core.threads import one_thread
from axiscal_core.units import METRES, Quantity, in_minutes, si


@contextmanager
def _placed(where: str) -> Iterator[None]:
    """Say in which call a plan, or a target, makes no sense."""
    try:
        yield
    except (PlanError, TargetError) as fault:
        raise fault.placed(where) from None


@dataclass(frozen=True, eq=False, repr=False)
class PlanResult:
    """A plan of a case."""

    case: Mathematics
    proposal: Proposal
    answer: PlanAnswer
    before: Sequence[Reading]

    @property
    def J(self) -> float:  # noqa: N802 (the paper's letter)
        """What the criterion is after the last reading."""
        return self.proposal.plan.value

    @property
    def U(self) -> float:  # noqa: N802 (the field's letter)
        """Expanded uncertainty over the volume after the last reading, m, causes of type B among it."""
        return expanded(self.case.yardstick, foreseen(self.case, self.before, [*self.places]).belief).space

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
        """The RMS that no plan of as many readings can beat, m; None where it is below half of this one's."""
        return self.proposal.plan.bound

    @property
    def places(self) -> PlannedPlaces:
        """Where to read, in order."""
        return PlannedPlaces(placed(self.case, self.proposal.plan), len(self.case.description.machine.axes))

    @property
    def document(self) -> dict[str, Any]:
        """The plan as `axiscal plan --json` prints it."""
        return self.answer.model_dump(mode="json", by_alias=True)

    def plot(self) -> NotebookPicture:
        """Return a picture: the accuracy after each reading against the minutes."""
        bound, points = self.answer.bound_rms_um, self.answer.points
        minutes = [0.0, *(point.minutes for point in points)]
        rms = [self.answer.before_rms_um, *(point.rms_um for point in points)]
        name = "accuracy of a plan"
        return NotebookPicture((Plot(name, "minutes", "RMS, µm", minutes, rms, level=bound, marked=True),))

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

    machine : of `load_machine`; setups : of `setup`, or instruments
    target : keys of [target] in campaign.toml, such as {"rms": "2 um", "criterion": "joint"}
    learn : sizes, smoothness and noise are learnt from the readings
    usual : "on" adds what usually goes wrong and nobody stated
    sure : how well stated sizes are known; "well" if not said, "roughly" with `learn` and in campaign.toml
    raises DescriptionError, UnitError or axiscal_core.InputError for what makes no sense on this machine
    Of a machine that is made in Python it is the case of the core, which takes the same instruments.
    """

    def __new__(cls, machine: Machine | OwnMachine, setups: Any = (), *more: Any, **named: Any) -> Any:
        """Return the case."""
        if not isinstance(machine, OwnMachine):
            return super().__new__(cls)
        if more or {"target", "learn"} & {*named}:
            remedy = "Give a criterion to its plans; its sizes are learnt as `sure` says"
            raise refusals.InputError("Case", "target", "and learn are for machines of load_machine", remedy)
        return OwnCase(machine, setups, **named)

    def __init__(
        self,
        machine: Machine | OwnMachine,
        setups: Sequence[SetupKeys | Instrument],
        target: Mapping[str, Any] | None = None,
        learn: bool = False,
        *,
        usual: Literal["on", "off"] = "on",
        sure: Literal["exactly", "well", "roughly"] | None = None,
    ) -> None:
        one("Case", "machine", machine, Machine, 'load_machine("dmu60")')
        assert isinstance(machine, Machine), "the case of any other is the core's"
        scales = "estimate" if one("Case", "learn", learn, bool, "True or False") else "stated"
        every = [given.mounted(s) if isinstance(s, Instrument) else s for s in listed("Case", "setups", setups)]
        for each in every:
            one("Case", "setups", each, Mapping, 'setup("interferometer", "x"), or an instrument')
        how = {"machine": machine.name, "scales": scales, "usual": usual, **({} if sure is None else {"sure": sure})}
        keys = {**how, "target": {} if target is None else target, "setups": every}
        try:
            text = "".join(f"{key} = {toml_value(value)}\n" for key, value in keys.items())
            described = campaign_from_texts(
                text, "Case", machine.text, machine.name, fine_knots=machine.fine_knots, anew=True
            )
        except TypeError as fault:
            what, remedy = "a set-up cannot be written ({fault})", "Give texts, numbers, lists and mappings"
            raise DescriptionError(what, remedy, fault=fault) from fault
        except InputError as fault:
            raise given.of_objects(
                fault, [str(each.get("name", f"number {i}")) for i, each in enumerate(every, 1)]
            ) from None
        self.description, self.inner = described, case_of(described)

    @classmethod
    def of(cls, description: CampaignDescription) -> Case:
        """Return the case of a campaign that was described in a file."""
        one("Case.of", "description", description, CampaignDescription, 'read_campaign("campaign.toml")')
        case: Case = object.__new__(cls)
        case.description, case.inner = description, case_of(description)
        return case

    def plan(
        self,
        readings: int | None = None,
        *,
        minutes: Quantity | None = None,
        rms: Quantity | None = None,
        criterion: Criterion | None = None,
        candidates: GivenPlaces | int = CANDIDATES,
        after: GivenReadings | Places | Estimated | None = None,
        keep: GivenPlaces | None = None,
    ) -> PlanResult:
        """Return the readings that serve best together, with what no plan can beat.

        At least one of the first three ends it: so many readings, so many minutes, an RMS over the volume reached.
        criterion : what is made small, the target's if not said: "volume", "joint", or V (w, n) of the unknowns in the
            order of `Case.names`; a function of their covariance judges places alone, see `evaluate`
        candidates : how many even places are tried, or the places where readings may be taken
        after : readings that are there already, or places of such; keep : places that are among those of the plan
        raises PlanError, TargetError, axiscal_core.InputError
        """
        where = "Case.plan"
        if readings is None and minutes is None and rms is None:
            raise refusals.InputError(where, "readings", "is not said, nor minutes, nor rms", "Say when the plan ends")
        count = None if readings is None else whole(where, "readings", readings, 1)
        wanted = None if rms is None else within(where, "rms", si(rms, where, "rms", METRES), 0.0, open_end=True)
        seconds = None if minutes is None else 60.0 * in_minutes(minutes, where, "minutes")
        limits = Limits(count, wanted, None, seconds)
        case, so_far = self._after(after, where)
        own = self._criterion(case, criterion, where)
        if isinstance(candidates, int | float):
            lattice: Any = whole(where, "candidates", candidates, 1)
        elif chosen := given.places_of(candidates, self.description, where, "candidates"):
            lattice = places_of(self.description.setups, chosen)
        else:
            raise refusals.InputError(where, "candidates", "are none", "Give one place or more")
        kept = () if keep is None else given.places_of(keep, self.description, where, "keep")
        if count is not None and len(kept) > count:
            raise refusals.InputError(where, "keep", f"holds {len(kept)} places of {count} readings", "Keep no more")
        with _placed(where):
            refuse_endless(case, limits, lattice if isinstance(lattice, int) else len(lattice))
            refuse_out_of_reach(case, limits)
            proposal = proposed(case, limits, lattice, so_far, own, kept)
        found = PlanResult(case, proposal, plan_answer(case, proposal, limits, before=so_far.readings), so_far.readings)
        if wanted and count is seconds is None and not reached_by(case, limits, [*found.places], so_far.readings):
            what = f"= {wanted:g} is not reached: {len(found)} readings leave {found.rms:.3g}"
            raise refusals.InputError(where, "rms", what, "Ask for a larger one, or for readings or minutes")
        return found

    def next(
        self, after: GivenReadings | Places | Estimated | None = None, criterion: Criterion | None = None
    ) -> Places:
        """Return the one reading that serves most."""
        case, so_far = self._after(after, "Case.next")
        own = self._criterion(case, criterion, "Case.next")
        with _placed("Case.next"):
            (place,) = placed(case, proposed(case, Limits(1), so_far=so_far, criterion=own).plan)
        return Places(place.setup, [place.pose], [place.approach])

    @one_thread()
    def evaluate(
        self,
        places: GivenPlaces,
        after: GivenReadings | Places | Estimated | None = None,
        criterion: Criterion | None = None,
    ) -> Evaluation:
        """Return what readings at places, in this order, would make known.

        U is that of `Estimated`; the core's is of the RMS over the volume.
        """
        where = "Case.evaluate"
        case, so_far = self._after(after, where)
        coming, function = given.places_of(places, self.description, where, "places"), callable(criterion)
        columns = places_of(self.description.setups, coming)
        own = None if function else self._criterion(case, criterion, where)
        with _placed(where):
            task = posed(case, so_far.knowledge, readings=so_far.readings)
        task = task if own is None else replace(task, root=own.root)
        plan = judged(task, columns)
        known = expanded(case.yardstick, foreseen(case, so_far.readings, coming).belief)
        value = plan.value
        if callable(criterion):
            left = task.state.after_readings(columns).factor[: case.observation.size]
            value = goal(criterion, case.observation.size, {}, where).value(left @ left.T)
        return Evaluation(value, plan.accuracy.rms, known.space, to_unit(plan.seconds, "min"), plan.bound)

    def estimate(self, readings: GivenReadings) -> Estimated:
        """Return what readings make known; raises InputError with file, line, value and remedy."""
        return Estimated(*self._taken(readings, "Case.estimate"))

    def known(self, mean: ArrayLike, covariance: ArrayLike) -> Estimated:
        """Return what is known already of the machine's errors: m and rad.  mean : (n,); covariance : (n, n)"""
        where, size = "Case.known", self.inner.errors.size
        belief = Inherited(finite(where, "mean", mean, (size,)), spread(where, "covariance", covariance, size))
        return Estimated(replace(self.inner, inherited=belief), ())

    @property
    def names(self) -> tuple[str, ...]:
        """The name of every unknown: "EXX[3]", "laser.zero"."""
        return names_of(self.inner.observation)

    @property
    def prior(self) -> Normal:
        """What is known of the unknowns before any reading: errors, then the set-ups' own."""
        return Normal(self.inner.prior.mean, self.inner.prior.covariance)

    def shows(self, places: GivenPlaces, x: Array) -> Normal:
        """Return what readings show of unknowns x, with noise and rests; nothing passes meanwhile.

        The mean is by the exact chain.  x : (n,)
        """
        where = "Case.shows"
        coming, size = given.places_of(places, self.description, where, "places"), self.inner.observation.size
        columns = places_of(self.description.setups, coming)
        observation = visited(self.inner.observation, columns)
        rows, variances, _ = rows_at(observation, columns)
        blank = blank_readings(self.description.setups, coming)
        exact = shown_by_each(observation, blank, finite(where, "x", x, (size,))[None])[0]
        root = rows[:, size:] * np.sqrt(np.diagonal(observation.prior_covariance())[size:])
        scales = np.concatenate([scales_of(self.description.setup(place.setup)) for place in coming] or [exact])
        return Normal(exact / scales, (root @ root.T + np.diag(variances)) / np.outer(scales, scales))

    def _criterion(self, case: Mathematics, criterion: Criterion | None, where: str) -> OwnCriterion | None:
        """Return a criterion that is not the target's; None where none is said."""
        if criterion is None:
            return None
        words = {"volume": lambda: case.yardstick.root.matrix, "joint": lambda: joint_root(case.errors).matrix}
        found = goal(criterion, case.observation.size, words, where)
        if found.function is not None:
            what, remedy = "is a function, which judges places and plans none here", "Give V, or a Machine of your own"
            raise refusals.InputError(where, "criterion", what, remedy)
        return OwnCriterion(criterion if isinstance(criterion, str) else "V", Root(found.root))

    def _after(self, after: GivenReadings | Places | Estimated | None, where: str) -> tuple[Mathematics, SoFar]:
        """Return the case as readings leave it, and what they make known; places are read at sizes as stated."""
        if after is None:
            return self.inner, SoFar(self.inner.knowledge)
        if isinstance(after, Places):
            blank = blank_readings(self.description.setups, given.places_of(after, self.description, where, "after"))
            # J leaves out how zeros wander: what is known here has no time, as that of the plan's own readings
            return self.inner, SoFar(absorbed(self.inner, blank).knowledge, timed(self.inner, blank).readings)
        known = after.estimation if isinstance(after, Estimated) else estimated(*self._taken(after, where, "after"))
        if known.case.description.machine.axes != self.description.machine.axes:
            what, remedy = "is an estimate of another machine", "Estimate readings of this one"
            raise refusals.InputError(where, "after", what, remedy)
        believed = [reading for index, reading in enumerate(known.readings) if index not in known.left_out]
        return known.case, SoFar(known.knowledge, believed)

    def _taken(
        self, readings: GivenReadings, where: str, argument: str = "readings"
    ) -> tuple[Mathematics, tuple[Reading, ...]]:
        """Return readings one by one, and the case with what a file of them says."""
        description, found = readings_of(readings, self.description, where, argument)
        return self.inner if description is self.description else case_of(description), found

    def __repr__(self) -> str:
        names = ", ".join(setup.name for setup in self.description.setups)
        return f"<Case {self.description.machine.name}: {names}>"


def estimate(campaign: Case | str | Path, readings: GivenReadings) -> Estimated:
    """Return what readings make known of a machine.

    campaign : a case, or the file campaign.toml; readings : of `Reading`, or a file that `axiscal data estimate` reads
    Raises InputError with file, line, value and remedy.
    """
    one("estimate", "campaign", campaign, (Case, OwnCase, str, Path), 'a case, or "campaign.toml"')
    if isinstance(campaign, str | Path):
        campaign = Case.of(read_campaign(campaign, target_needed=False))
    return campaign.estimate(readings)
