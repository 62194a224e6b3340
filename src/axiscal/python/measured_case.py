"""A machine and the set-ups to measure on it, in Python, without a file on disk.

machine = ac.load_machine("three-axis-mill")
case = ac.Case(machine, [ac.setup("interferometer", "x", moves=["X"]), ac.setup("level", "y", moves=["X"])])
plan = case.plan(readings=12)
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.estimation.inheritance import case_of
from axiscal.machine.description import Machine
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import Thoroughness, proposed
from axiscal.present.plan_answer import plan_answer
from axiscal.python.plan_result import PlanResult
from axiscal.python.setup_keys import Quantity, SetupKeys, campaign_text, si

_NO_KEYS: Mapping[str, Any] = MappingProxyType({})
_SOURCE = "the case"


class Case:
    """A machine and set-ups on it.

    machine : of `load_machine`; setups : of `setup`; target : keys of [target] in campaign.toml, such as
        {"rms": "2 um"}; learn : sizes, smoothness and noise are learnt from the readings
    raises DescriptionError or UnitError for what makes no sense on this machine
    """

    def __init__(
        self,
        machine: Machine,
        setups: Sequence[SetupKeys],
        target: Mapping[str, Any] = _NO_KEYS,
        learn: bool = False,
    ) -> None:
        text = campaign_text(machine.name, setups, target, "estimate" if learn else "stated")
        self._hold(campaign_from_texts(text, _SOURCE, machine.text, machine.name, fine_knots=machine.fine_knots))

    @classmethod
    def of(cls, description: CampaignDescription) -> Case:
        """Return the case of a campaign that was described in a file."""
        case = cls.__new__(cls)
        case._hold(description)
        return case

    def _hold(self, description: CampaignDescription) -> None:
        self.description = description
        self.inner = case_of(description)

    def plan(
        self,
        readings: int | None = None,
        *,
        rms: Quantity | None = None,
        minutes: float | None = None,
        candidates: int = Thoroughness().candidates,
    ) -> PlanResult:
        """Return the readings that serve best together, with what no plan can beat; raises PlanError.

        At least one of them ends it: so many readings, an RMS over the volume reached, so many minutes.
        """
        limits = Limits(
            readings,
            None if rms is None else si(rms, "length"),
            None,
            None if minutes is None else 60.0 * minutes,
        )
        proposal = proposed(self.inner, limits, Thoroughness(candidates))
        return PlanResult(self.inner, proposal, plan_answer(self.inner, proposal, limits))

    def __repr__(self) -> str:
        names = ", ".join(setup.name for setup in self.description.setups)
        return f"<Case {self.description.machine.name}: {names}>"
