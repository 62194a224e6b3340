"""A document read into a pydantic model, pydantic's complaints turned into one failure with line, value and remedy."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Generic, Protocol, TypeVar, get_args, get_origin

from axiscal.document.file import Document
from axiscal.document.gone import instead_of, key_name
from axiscal.document.quoting import dotted, meant, quantity_text, shown
from axiscal.exceptions import DescriptionError, Faults, InputError, UnitError
from axiscal.language.spoken import WORDS, put, said
from axiscal.units import Dimension, within

if TYPE_CHECKING:
    from pydantic import BaseModel, GetCoreSchemaHandler
    from pydantic.fields import FieldInfo
    from pydantic_core import CoreSchema, ErrorDetails

ModelT = TypeVar("ModelT", bound="BaseModel")
Keys = tuple[str | int, ...]


@contextmanager
def _placing(*keys: str | int) -> Iterator[None]:
    """Let a pydantic validator raise InputError, which `read_model` places.  keys : below its own place"""
    from pydantic_core import PydanticCustomError

    try:
        yield
    except InputError as fault:
        kind, said = "unit" if isinstance(fault, UnitError) else "fault", {"what": fault.what, "remedy": fault.remedy}
        raise PydanticCustomError(kind, "{what}", said | {"keys": keys}) from None


@dataclass(frozen=True, slots=True)
class QuantityOf:
    """Marks a pydantic field as a quantity of one dimension, read to SI; without a dimension its text is kept.

    least, most : of its value, SI
    """

    dimension: Dimension | None
    least: float = -math.inf
    most: float = math.inf

    def __get_pydantic_core_schema__(self, source: object, handler: GetCoreSchemaHandler) -> CoreSchema:
        from pydantic_core import core_schema

        return core_schema.no_info_plain_validator_function(self.read)

    def read(self, value: object) -> float | str:
        """Return the value in SI units, or its text; raises what a pydantic validator may raise."""
        with _placing():
            text = quantity_text(value, self.dimension)
            return text if self.dimension is None else within(text, self.dimension, self.least, self.most)


class Beside(Protocol):
    """What is known where a field is read.  context : as in `read_model`; data : the keys before it in its table"""

    @property
    def context(self) -> Any: ...

    @property
    def data(self) -> dict[str, Any]: ...


@dataclass(frozen=True, slots=True)
class ReadAs:
    """Marks a pydantic field that is made of what a file says.

    form : the type that the file has; read : makes the value of it, and may raise InputError
    by : whether `read` is given what is `Beside` as well
    """

    form: Any
    read: Callable[..., object]
    by: bool = False

    def __get_pydantic_core_schema__(self, source: object, handler: GetCoreSchemaHandler) -> CoreSchema:
        from pydantic_core import core_schema

        return core_schema.with_info_after_validator_function(self._made, handler.generate_schema(self.form))

    def _made(self, entries: Any, known: Beside) -> object:
        with _placing():
            return self.read(entries, known) if self.by else self.read(entries)


class EachAs(ReadAs):
    """Marks a table, or a list, whose entries are read one by one.  read : of key, entry and what is `Beside`"""

    def _made(self, entries: Any, known: Beside) -> object:
        made = {}
        for key, entry in entries.items() if isinstance(entries, dict) else enumerate(entries):
            with _placing(key):
                made[key] = self.read(key, entry, known)
        return made if isinstance(entries, dict) else [*made.values()]


Length = Annotated[float, QuantityOf("length")]
QuantityText = Annotated[str, QuantityOf(None)]
"""A quantity whose dimension is known only later, kept as text."""


def read_model(document: Document, model: type[ModelT], context: object = None) -> ModelT:
    """Return the document as an instance of a pydantic model.  context : that its fields are read by

    Raises UnitError for a quantity, DescriptionError for everything else, at the first fault in the file. The error has
    the line, the offending value and the remedy (from the field's `examples`, or the nearest known key).
    """
    from pydantic import ValidationError

    try:
        return model.model_validate(document.data, context=context)
    except ValidationError as faults:
        details = faults.errors(include_url=False)
    for detail in details:
        detail["loc"] += detail.get("ctx", {}).get("keys", ())
    # A misspelt key is also a missing one: the misspelling is what its writer can see.
    misspelt = {detail["loc"][:-1] for detail in details if detail["type"] == "extra_forbidden"}
    wrong = [d for d in details if d["type"] != "missing" or d["loc"][:-1] not in misspelt]
    wrong.sort(key=lambda detail: (detail["type"] == "missing", document.line(*detail["loc"]) or 0))
    every = Faults()
    for detail in wrong:
        what, remedy = _wording(model, detail)
        failure = UnitError if detail["type"] == "unit" else DescriptionError
        every.found.append(failure(what, remedy, document.path, document.line(*detail["loc"])))
    every.refuse()
    raise AssertionError(f"{wrong}: this is a defect of axiscal")


def _wording(model: type[BaseModel], detail: ErrorDetails) -> tuple[str, str]:
    """Return what is wrong and what would be right, for one complaint of pydantic."""
    keys, kind = detail["loc"], detail["type"]
    if (listed := _miscounted_list(keys, kind)) is not None:
        what = said("{keys} has the wrong number of entries", keys=dotted(listed))
        return what, said("Write {key} = {example}", key=listed[-1], example=_example(model, listed))
    name = keys[-1] if keys else ""
    table = f"[{dotted(keys[:-1])}]" if keys[:-1] else said("the file")
    example = _example(model, keys)
    if kind == "missing":
        what = said('"{name}" is missing in {table}', name=name, table=table)
        return what, said("Add a line such as {name} = {example}", name=name, example=example)
    if kind == "extra_forbidden":
        if instead := instead_of("keys", key_name(keys)):
            return said("{keys} is gone", keys=dotted(keys)), instead
        known = list(_fields(_descend(model, keys[:-1])))
        what = said('unknown key "{key}" in {table}', key=dotted((name,)), table=table)
        return what, meant(str(keys[-1]), known, said("The keys here are {known}", known=", ".join(known)))
    context: dict[str, Any] = detail.get("ctx", {})
    if kind in ("unit", "fault"):
        return put("{keys}: {fault}", keys=dotted(keys), fault=context["what"]), context["remedy"]
    what = said("{keys}: {text} is not possible here", keys=dotted(keys), text=shown(detail["input"]))
    if kind in ("literal_error", "enum"):
        return what, said("Write one of {known}", known=context["expected"])
    remedy = said(_EXPECTED[kind]) if kind in _EXPECTED else put("{message}", message=detail["msg"])
    if example == "…":
        return what, remedy
    return what, said("{remedy}, such as {name} = {example}", remedy=remedy, name=name, example=example)


def _miscounted_list(keys: tuple[str | int, ...], kind: str) -> tuple[str | int, ...] | None:
    """Return the key path of a list when the complaint is about the number of its entries."""
    if kind == "missing" and keys and isinstance(keys[-1], int):
        return keys[:-1]
    return keys if kind in ("too_long", "too_short") and keys else None


_EXPECTED = WORDS["expected"]


def _example(model: type[BaseModel], keys: tuple[str | int, ...]) -> str:
    """Return the example that the model gives for a key, as TOML; "…" where it gives none."""
    table = _descend(model, keys[:-1])
    info = _fields(table).get(str(keys[-1])) if keys else None
    return str(info.examples[0]) if info is not None and info.examples else "…"


def _descend(annotation: Any, keys: tuple[str | int, ...]) -> Any:
    """Return the type that stands at a key path below a model, as far as its annotations tell."""
    for key in keys:
        if fields := _fields(annotation):
            info = fields.get(str(key))
            annotation = info.annotation if info else None
        else:
            inner = get_args(_plain(annotation))
            annotation = inner[1] if get_origin(_plain(annotation)) is dict else inner[0] if inner else None
    return _plain(annotation)


def _fields(annotation: Any) -> dict[str, FieldInfo]:
    """Return the fields of a model by the key they have in the file; nothing for other types."""
    fields: dict[str, FieldInfo] = getattr(_plain(annotation), "model_fields", {})
    return {str(info.alias or name): info for name, info in fields.items()}


def _plain(annotation: Any) -> Any:
    """Return a type without `| None`."""
    if get_origin(annotation) in (list, dict, tuple) or not get_args(annotation):
        return annotation
    return _plain(next(inner for inner in get_args(annotation) if inner is not type(None)))


@dataclass(frozen=True, slots=True)
class Stated(Generic[ModelT]):
    """A table of the document, with the quantities that it states.  keys : where it stands"""

    document: Document
    table: ModelT
    keys: Keys

    def within(self, key: str, dimension: Dimension, least: float, most: float, index: int = 0) -> float | None:
        """Return a quantity, or one of a list, in SI units, None where it is not stated; raises as `units.within`."""
        found = getattr(self.table, key)
        place, text = ((key, index), found[index]) if isinstance(found, tuple | list) else ((key,), found)
        with self.at_key(*place):
            return None if text is None else within(text, dimension, least, most)

    def each(self, key: str, dimension: Dimension, least: float, most: float) -> tuple[float, ...]:
        """Return all quantities of a list in SI units; raises as `units.within`."""
        found = list[float]()
        for index, text in enumerate(getattr(self.table, key)):
            with self.at_key(key, index):
                found.append(within(text, dimension, least, most))
        return tuple(found)

    def at_key(self, *keys: str | int) -> AbstractContextManager[None]:
        """Place failures of a block at keys, one below the other."""
        return self.document.placed(*self.keys, *keys)

    def misstated(self, where: str | Keys, what: str, remedy: str, **values: object) -> InputError:
        """Return a failure placed at a key, or at keys, one below the other."""
        keys = (where,) if isinstance(where, str) else where
        return self.document.fault(DescriptionError(what, remedy, None, None, **values), *self.keys, *keys)
