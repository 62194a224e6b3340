"""A document read into a pydantic model, pydantic's complaints turned into one failure with line, value and remedy."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Generic, Protocol, TypeVar, get_args, get_origin

from axiscal.document.file import Document
from axiscal.document.gone import instead_of, key_name
from axiscal.document.quoting import dotted, meant, quantity_text, shown
from axiscal.exceptions import DescriptionError, Faults, InputError
from axiscal.language.spoken import WORDS, put, said
from axiscal.units import Dimension, within

if TYPE_CHECKING:
    from pydantic import BaseModel, GetCoreSchemaHandler
    from pydantic.fields import FieldInfo
    from pydantic_core import CoreSchema, ErrorDetails

ModelT = TypeVar("ModelT", bound="BaseModel")
Keys = tuple[str | int, ...]
NAME = "*name"
"""Key by which a table knows its own name; nobody can write it."""


def refusal(faults: Sequence[tuple[Keys, InputError]]) -> Exception:
    """Return what a pydantic validator may raise, which `read_model` places.  faults : with keys below its own place"""
    from pydantic_core import PydanticCustomError

    return PydanticCustomError("faults", "faults", {"faults": faults})


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
        try:
            return self.read(entries, known) if self.by else self.read(entries)
        except InputError as fault:
            raise refusal([((), fault)]) from None


class EachAs(ReadAs):
    """Marks a table, or a list, whose entries are read one by one.  read : of key, entry and what is `Beside`"""

    def _made(self, entries: Any, known: Beside) -> object:
        made, faults = {}, list[tuple[Keys, InputError]]()
        for key, entry in entries.items() if isinstance(entries, dict) else enumerate(entries):
            try:
                made[key] = self.read(key, entry, known)
            except InputError as fault:
                faults.append(((key,), fault))
        if faults:
            raise refusal(faults)
        return made if isinstance(entries, dict) else [*made.values()]


@dataclass(frozen=True, slots=True)
class QuantityOf:
    """Marks a pydantic field as a quantity of one dimension, read to SI; without a dimension its text is kept.

    least, most : of its value, SI
    """

    dimension: Dimension | None
    least: float = -math.inf
    most: float = math.inf

    def __get_pydantic_core_schema__(self, source: object, handler: GetCoreSchemaHandler) -> CoreSchema:
        return ReadAs(Any, self.read).__get_pydantic_core_schema__(source, handler)

    def read(self, value: object) -> float | str:
        """Return the value in SI units, or its text; raises InputError."""
        text = quantity_text(value, self.dimension)
        return text if self.dimension is None else within(text, self.dimension, self.least, self.most)


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
    # A misspelt key is also a missing one: the misspelling is what its writer can see.
    misspelt = {detail["loc"][:-1] for detail in details if detail["type"] == "extra_forbidden"}
    found = list[tuple[bool, InputError]]()
    for detail in details:
        keys, missing = tuple(key for key in detail["loc"] if key != NAME), detail["type"] == "missing"
        if missing and detail["loc"][:-1] in misspelt:
            continue
        for below, fault in detail.get("ctx", {}).get("faults", ()):
            found.append((missing, document.fault(fault, *keys, *below)))
        if detail["type"] != "faults":
            found.append((missing, _complaint(model, keys, detail).placed(document.path, document.line(*keys))))
    found.sort(key=lambda each: (each[0], each[1].line or 0))
    every = Faults()
    every.found += [fault for _, fault in found]
    every.refuse()
    raise AssertionError(f"{details}: this is a defect of axiscal")


def _complaint(model: type[BaseModel], keys: Keys, detail: ErrorDetails) -> DescriptionError:
    """Return the failure that one complaint of pydantic is."""
    kind = detail["type"]
    listed = keys[:-1] if kind == "missing" and keys and isinstance(keys[-1], int) else keys
    if listed and (listed != keys or kind in ("too_long", "too_short")):
        what = said("{keys} has the wrong number of entries", keys=dotted(listed))
        return DescriptionError(what, said("Write {key} = {example}", key=listed[-1], example=_example(model, listed)))
    name, example = keys[-1] if keys else "", _example(model, keys)
    table = f"[{dotted(keys[:-1])}]" if keys[:-1] else said("the file")
    if kind == "missing":
        what = said('"{name}" is missing in {table}', name=name, table=table)
        return DescriptionError(what, said("Add a line such as {name} = {example}", name=name, example=example))
    if kind == "extra_forbidden":
        if instead_of("keys", key_name(keys)):
            return DescriptionError(said("{keys} is gone", keys=dotted(keys)), instead_of("keys", key_name(keys)))
        known = [key for key in _fields(_descend(model, keys[:-1])) if key != NAME]
        what = said('unknown key "{key}" in {table}', key=dotted((name,)), table=table)
        every = said("The keys here are {known}", known=", ".join(known))
        return DescriptionError(what, meant(str(name), known, every))
    what = said("{keys}: {text} is not possible here", keys=dotted(keys), text=shown(detail["input"]))
    if kind in ("literal_error", "enum"):
        return DescriptionError(what, said("Write one of {known}", known=detail["ctx"]["expected"]))
    wanted = said(_EXPECTED[kind]) if kind in _EXPECTED else put("{message}", message=detail["msg"])
    if example == "…":
        return DescriptionError(what, put("{message}", message=wanted))
    alike = {"name": name, "example": example}
    return DescriptionError(what, said("{wanted}, such as {name} = {example}", wanted=wanted, **alike))


_EXPECTED = WORDS["expected"]


def _example(model: type[BaseModel], keys: Keys) -> str:
    """Return the example that the model gives for a key, as TOML; "…" where it gives none."""
    info = _fields(_descend(model, keys[:-1])).get(str(keys[-1])) if keys else None
    return str(info.examples[0]) if info is not None and info.examples else "…"


def _descend(annotation: Any, keys: Keys) -> Any:
    """Return the type that stands at a key path below a model, as far as its annotations tell."""
    for key in keys:
        if fields := _fields(annotation):
            info = fields.get(str(key))
            annotation = None if info is None else _form(info.metadata) or info.annotation
        else:
            inner = get_args(_plain(annotation))
            annotation = inner[1] if get_origin(_plain(annotation)) is dict else inner[0] if inner else None
    return _plain(annotation)


def _form(marks: Sequence[Any]) -> Any:
    """Return the type that a file has for a field that is made of it; None for another field."""
    form: Any = next((mark.form for mark in marks if isinstance(mark, ReadAs)), None)
    return _form(form.__metadata__) or form.__origin__ if hasattr(form, "__metadata__") else form


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

    def at_key(self, *keys: str | int) -> AbstractContextManager[None]:
        """Place failures of a block at keys, one below the other."""
        return self.document.placed(*self.keys, *keys)

    def misstated(self, where: str | Keys, what: str, remedy: str, **values: object) -> InputError:
        """Return a failure placed at a key, or at keys, one below the other."""
        keys = (where,) if isinstance(where, str) else where
        return self.document.fault(DescriptionError(what, remedy, None, None, **values), *self.keys, *keys)
