"""study.toml -> Study: which machines are measured in which ways, when each ends, and what is kept of it.

A key of a study file: a path into campaign.toml or machine.toml, such as target.rms or setups[*].noise.

In brackets stands which entries of a list: all (*), one by its number from 1, or one by its name.
"""

from __future__ import annotations

import copy
import hashlib
import math
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

from pydantic import BaseModel, ConfigDict, Field

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.description.campaign_schema import CampaignTable
from axiscal.description.target import MOST_READINGS
from axiscal.document import Document, meant, read_model, shown
from axiscal.document.quoting import toml_document
from axiscal.exceptions import InputError, StudyError
from axiscal.language.spoken import later, put, said
from axiscal.machine.machine_schema import MachineFile
from axiscal.ports.fleet.type_learning import campaign_with_sisters
from axiscal.ports.study.study_case import Stop, StudyCase, Variant, canonical
from axiscal.units import parse_quantity

_PART = re.compile(r"(?P<name>[^.\[\]]+)(?:\[(?P<which>[^\]]+)\])?(?:\.|$)")
_ALL = "*"


class PathPart(NamedTuple):
    """One part of a path.  which : entries of a list, None where it is none"""

    name: str
    which: str | None


def parts_of(path: str) -> tuple[PathPart, ...]:
    """Return a path taken apart; raises StudyError for one that cannot be read."""
    found, at = list[PathPart](), 0
    while at < len(path) and (part := _PART.match(path, at)):
        found.append(PathPart(part["name"].strip(), part["which"]))
        at = part.end()
    if at < len(path) or not found or path.endswith("."):
        remedy = 'Write paths such as "target.rms", "setups[*].noise" or "errors.EXX.std"'
        raise StudyError("{text} is no path of a key", remedy, text=shown(path))
    return tuple(found)


def changed(data: Mapping[str, Any], path: str, value: Any) -> dict[str, Any]:
    """Return a document with the value of a key replaced; raises StudyError where there is no such table or entry."""
    found: dict[str, Any] = copy.deepcopy(dict(data))
    *way, last = parts_of(path)
    for table in _below([found], way, path):
        if last.which is None:
            table[last.name] = value
            continue
        entries = _value(table, last.name, path)
        for index in _indices(entries, last, path):
            entries[index] = value
    return found


def _below(tables: list[Any], way: Iterable[PathPart], path: str) -> list[Any]:
    for part in way:
        below = list[Any]()
        for table in tables:
            value = _value(table, part.name, path)
            below += [value] if part.which is None else [value[index] for index in _indices(value, part, path)]
        tables = below
    for table in tables:
        if not isinstance(table, dict):
            hint = "Say which, as in setups[*].noise" if isinstance(table, list) else "Shorten the path"
            what = '{text}: what stands before ".{part}" is no table'
            raise StudyError(what, hint, text=shown(path), part=path.rpartition(".")[2])
    return tables


def _value(table: Any, name: str, path: str) -> Any:
    if isinstance(table, dict) and name in table:
        return table[name]
    known = list(table) if isinstance(table, dict) else []
    remedy = meant(
        name, known, said("There are {known}", known=", ".join(known)) if known else said("Shorten the path")
    )
    raise StudyError('{text}: there is no "{name}"', remedy, text=shown(path), name=name)


def _indices(entries: Any, part: PathPart, path: str) -> list[int]:
    if not isinstance(entries, list):
        remedy = "Write {part} without brackets"
        raise StudyError('{text}: "{part}" is no list', remedy, text=shown(path), part=part.name)
    if part.which == _ALL:
        return list(range(len(entries)))
    which = part.which or ""
    if which.isascii() and which.isdigit() and 1 <= int(which) <= len(entries):
        return [int(which) - 1]
    names = [str(each.get("name", "")) for each in entries if isinstance(each, dict)]
    if which in names:
        return [names.index(which)]
    remedy = meant(
        which, names, said("Write [*], or one of [1] to [{count}], or its name", count=len(entries)), quoted="[{}]"
    )
    raise StudyError('{text}: there is no "{name}" in {part}', remedy, text=shown(path), name=which, part=part.name)


MOST_MACHINES = 1_000_000
"""More is a slip of the finger."""


class _KnownKeys(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, defer_build=True)


class StudyTable(_KnownKeys):
    """[study]: what every case begins with."""

    campaign: str = Field(examples=['"campaign.toml"'])
    seed: int = Field(1, ge=0, le=2**63, examples=["1"])
    machines: int = Field(100, ge=1, le=MOST_MACHINES, examples=["200"])
    stop: str | dict[str, Any] = Field("target", examples=['"target"', "{ readings = 30 }"])


class StudyFile(_KnownKeys):
    """The whole file."""

    study: StudyTable = Field(examples=['{ campaign = "campaign.toml" }'])
    grid: dict[str, list[Any]] = Field(default={}, examples=['{ "target.rms" = ["4 um", "8 um"] }'])


SETUPS = "setups"
"""The key with a meaning of its own: which set-ups are used."""
_FIXED = ("machine", "prior", "sisters")
_STOP = later('Write "target", {{ readings = 30 }} or {{ budget = "90 min" }}')
MOST_CASES = 10_000_000
"""Years of work; whoever says more has slipped."""


@dataclass(frozen=True, eq=False, slots=True)
class Study:
    """A study as described by its owner.

    described : the campaign that every case begins with; grid : the values of each key
    """

    source: Path
    text: str
    described: CampaignDescription
    seed: int
    machines: int
    stop: Stop
    grid: Mapping[str, tuple[Any, ...]]

    @property
    def digest(self) -> str:
        """SHA-256 of the texts that every case is a function of."""
        texts = self.text, self.described.text, self.described.machine.text, self.described.prior_text
        return hashlib.sha256("\0".join(texts).encode()).hexdigest()

    @property
    def count(self) -> int:
        """How many cases there are."""
        return math.prod(map(len, self.grid.values())) * self.machines

    def ways(self) -> Iterator[dict[str, Any]]:
        """Yield all ways of measuring: every combination of the grid."""
        for values in product(*self.grid.values()):
            yield dict(zip(self.grid, values, strict=True))

    def variant(self, choices: Mapping[str, Any]) -> Variant:
        """Return one way of measuring; raises StudyError for a key that is none.  choices : of the grid, by key"""
        described = self.described
        documents = {
            "campaign": Document.parse(described.text, described.source).data,
            "machine": Document.parse(described.machine.text, described.machine_source).data,
        }
        for key, value in choices.items():
            if key != SETUPS:
                of = _document_of(key)
                documents[of] = changed(documents[of], key, value)
        used = choices.get(SETUPS, "all")
        return Variant(
            choices=canonical(dict(choices)),
            campaign=toml_document(documents["campaign"]),
            machine=toml_document(documents["machine"]),
            truth=described.machine.text,
            names=(described.source, described.machine_source),
            prior=described.prior_text,
            setups=None if used == "all" else tuple(used),
            stop=self.stop,
        )

    def cases(self) -> Iterator[StudyCase]:
        """Yield all cases, one way of measuring after the other."""
        for way in self.ways():
            variant = self.variant(way)
            for machine in range(self.machines):
                yield StudyCase(variant, self.seed, machine)


def read_study(path: str | Path) -> Study:
    """Return the study in a file; every value of its grid has been tried on the campaign.

    Raises StudyError or DescriptionError with file, line, value and remedy.
    """
    document = Document.read(path)
    table = read_model(document, StudyFile, StudyError)
    described = campaign_with_sisters(document.path.parent / table.study.campaign, target_needed=False)
    study = Study(
        source=document.path,
        text=document.text,
        described=described,
        seed=table.study.seed,
        machines=table.study.machines,
        stop=_stop(table.study.stop, described, document),
        grid=MappingProxyType({key: _values(key, values, document) for key, values in table.grid.items()}),
    )
    _try_values(study, document)
    if study.count > MOST_CASES:
        what = "these are {count:,} cases, more than {most:,}"
        fault = StudyError(what, "Give fewer values or machines", count=study.count, most=MOST_CASES)
        raise document.fault(fault, "grid")
    return study


def _document_of(key: str) -> str:
    """Return which file a key stands in; raises StudyError for one that stands in none."""
    first = parts_of(key)[0].name
    if first in _FIXED:
        remedy = "Make a study of each"
        raise StudyError('"{key}" cannot vary within a study', remedy, key=first)
    if first in CampaignTable.model_fields:
        return "campaign"
    if first in MachineFile.model_fields:
        return "machine"
    otherwise = said('Write paths such as "target.rms" or "errors.EXX.std"')
    remedy = meant(first, [*CampaignTable.model_fields, *MachineFile.model_fields], otherwise)
    raise StudyError('there is no key "{key}" in campaign.toml or machine.toml', remedy, key=first)


def _refused(document: Document, what: str, remedy: str = _STOP, **values: object) -> InputError:
    return document.fault(StudyError(what, remedy, None, None, **values), "study", "stop")


def _stop(given: str | dict[str, Any], described: CampaignDescription, document: Document) -> Stop:
    if given == "target":
        if described.target.empty:
            raise _refused(
                document, "the campaign has no target to stop at", "Give it one, or write stop = { readings = 30 }"
            )
        return Stop()
    if not isinstance(given, dict) or len(given) != 1 or not given.keys() <= {"readings", "budget"}:
        raise _refused(document, "{text} is not possible here", text=shown(given))
    if "budget" in given:
        try:
            seconds = parse_quantity(str(given["budget"]), "time")
        except InputError as wrong:
            raise _refused(document, wrong.what, wrong.remedy) from None
        if seconds <= 0:
            raise _refused(document, "{text} is no time to measure in", text=shown(given["budget"]))
        return Stop(budget=seconds)
    count = given["readings"]
    if not isinstance(count, int) or isinstance(count, bool) or not 1 <= count <= MOST_READINGS:
        raise _refused(document, "{text} is no number of readings", text=shown(count))
    return Stop(readings=count)


def _values(key: str, values: list[Any], document: Document) -> tuple[Any, ...]:
    if not values:
        raise document.fault(StudyError("there is no value", "Give at least one"), "grid", key)
    for index, value in enumerate(values):
        if value in values[:index]:
            fault = StudyError("{text} is there twice", "Give each value once", text=shown(value))
            raise document.fault(fault, "grid", key, index)
    return tuple(values)


def _try_values(study: Study, document: Document) -> None:
    """Raise the fault of the first value that campaign or machine cannot have, at its line."""
    first = {key: values[0] for key, values in study.grid.items()}
    for key, values in study.grid.items():
        for index, value in enumerate(values):
            fault = _fault_of(study, {key: value})
            if fault is not None and _fault_of(study, {**first, key: value}) is not None:
                raise _of_study(fault, key, value).placed(document.path, document.line("grid", key, index))


def _fault_of(study: Study, choices: Mapping[str, Any]) -> InputError | None:
    try:
        _try(study, choices)
    except InputError as wrong:
        return wrong
    return None


def _of_study(wrong: InputError, key: str, value: Any) -> InputError:
    what = put("{key} = {text}: {fault}", key=key, text=shown(value), fault=wrong.what)
    return StudyError(wrong.what if isinstance(wrong, StudyError) else what, wrong.remedy)


def _try(study: Study, choices: Mapping[str, Any]) -> None:
    used = choices.get(SETUPS, "all")
    if used != "all":
        if not isinstance(used, list) or not used:
            raise StudyError("{text} names no set-ups", 'Write "all", or a list of names of set-ups', text=shown(used))
        for name in used:
            study.described.setup(name)
    variant = study.variant(choices)
    names = variant.names
    campaign_from_texts(variant.campaign, names[0], variant.machine, names[1], prior_text=variant.prior)
