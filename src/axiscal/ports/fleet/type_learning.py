"""From a folder of records to what their type has taught, and a campaign with that as its prior."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from axiscal.description.campaign import CampaignDescription
from axiscal.description.campaign_schema import SistersTable
from axiscal.description.type_text import Learned, SisterRecord, TypePrior
from axiscal.document import shown
from axiscal.errors.model import ErrorModel
from axiscal.estimation.case import Case
from axiscal.estimation.data_equation import DataEquation
from axiscal.estimation.inheritance import case_of
from axiscal.exceptions import RecordError, TargetError
from axiscal.language.spoken import listed, put
from axiscal.machine.description import Machine, machine_from_text
from axiscal.planning.plan.plan import Plan
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import proposed
from axiscal.ports.fleet.gibbs import SisterPrior, sister_prior
from axiscal.ports.fleet.hierarchy import Hierarchy, PriorUnits, prior_units
from axiscal.ports.fleet.sister_records import MachineRecord, equations_of, read_records, usual_machine
from axiscal.record.copies import gathered
from axiscal_core.threads import one_thread

DIRECTIONS, DOUBT = 3, 0.1
"""In which sisters differ together; that a machine is no sister, before it is measured. A user states them."""
FEW = 3
"""Fewer sisters than this hardly teach what is common, and teach only in which sizes the tolerances are wrong."""


@one_thread()
def learnt_type(
    files: Iterable[Path],
    machine: Machine | None = None,
    directions: int = DIRECTIONS,
    doubt: float = DOUBT,
    named: str | None = None,
) -> TypePrior:
    """Return what records teach of a type: the same for the same records in any order.

    machine : over whose errors; None for the description that most of them have
    named : only machines of this name, None for all
    Raises RecordError where no record counts.
    """
    found, left = read_records(files)
    if named is not None:
        found = _of_name(found, named)
    if not found:
        raise _nothing(left)
    if machine is None:  # what usually goes wrong is none of what a type teaches
        stated = usual_machine(found)
        machine = machine_from_text(stated.text, fine_knots=stated.fine_knots)
    units = prior_units(ErrorModel(machine))
    seen, equations = equations_of(found, machine, units.root)
    records = tuple(sorted([*seen, *left], key=lambda record: (record.digest, record.file)))
    if not equations:
        raise _nothing(records)
    return taught(machine, units, records, equations, directions, doubt)


def taught(
    machine: Machine,
    units: PriorUnits,
    records: tuple[SisterRecord, ...],
    equations: Mapping[str, DataEquation],
    directions: int = DIRECTIONS,
    doubt: float = DOUBT,
) -> TypePrior:
    """Return what the errors of a type teach as records show them, each by itself.

    machine : over whose errors; records : all that were looked at; equations : of those that count, by their digests
    """
    seed = [int(digest[:15], 16) for digest in equations]
    found = sister_prior(list(equations.values()), Hierarchy(units.blocks, directions), seed)
    covariance = units.root @ found.covariance @ units.root.T + units.cut
    own = units.root @ (found.covariance - found.common) @ units.root.T + units.cut
    learned = {name: _learned(found, units, name) for name in dict.fromkeys(block.name for block in units.blocks)}
    whole, mine = ((matrix + matrix.T) / 2 for matrix in (covariance, own))
    mean = units.root @ found.mean
    return TypePrior(machine.text, records, learned, directions, doubt, mean, whole, mine, machine.fine_knots)


def _learned(found: SisterPrior, units: PriorUnits, name: str) -> Learned:
    """Return what was learnt of an error, the mean over its coarse and fine parts by the variance they hold."""
    mine = [index for index, block in enumerate(units.blocks) if block.name == name]
    weights = np.array([units.blocks[index].weight for index in mine])
    figures = (found.scales, found.scale_stds, found.shares, found.share_stds)
    return Learned(*(float(weights @ each[mine] / weights.sum()) for each in figures))


def _of_name(records: list[MachineRecord], named: str) -> list[MachineRecord]:
    found = [record for record in records if record.description.machine.name == named]
    if records and not found:
        others = ", ".join(sorted({shown(record.description.machine.name) for record in records}))
        remedy = "There are records of: {others}"
        raise RecordError("None of the records is of a machine {named}", remedy, named=shown(named), others=others)
    return found


def _nothing(records: Iterable[SisterRecord]) -> RecordError:
    left = [put("{file}: {why}", file=record.file, why=record.left_out) for record in records if record.left_out]
    whys = listed("; ", left)
    what = "No record teaches anything of this type: {whys}" if whys else "There are no records to learn from"
    return RecordError(what, "Name records of measured machines of this type", whys=whys)


def taught_by_sisters(described: CampaignDescription, named: SistersTable) -> CampaignDescription:
    """Return a campaign with what its sisters teach as its prior; raises RecordError where none of them is there."""
    found = named.files(Path(described.source).parent)
    if not found:
        remedy = 'Give a pattern beside the campaign, such as records = "records/*.axiscal", or "store:"'
        raise RecordError("[sisters] names no record that is there", remedy, described.source)
    doubt = DOUBT if described.doubt is None else described.doubt
    prior = learnt_type(gathered(found), described.machine, named.directions, doubt, named.type)
    return replace(described, prior_text=prior.text())


def saving(described: CampaignDescription, text: str) -> tuple[Plan, Plan]:
    """Return the plans of a campaign by the stated prior and by what its type has taught.  text : that

    Raises TargetError where nothing would end the plans, PlanError.
    """
    plain = replace(described, prior_text="", sisters=None)
    return planned(case_of(plain)), planned(case_of(replace(plain, prior_text=text)))


def planned(case: Case) -> Plan:
    """Return the plan to the target of a campaign; raises TargetError where nothing would end it, PlanError."""
    if case.description.target.empty:
        raise TargetError("nothing would ever end this plan", 'Give the campaign a target, such as rms = "4 um"')
    return proposed(case, Limits.of(case.description.target)).plan
