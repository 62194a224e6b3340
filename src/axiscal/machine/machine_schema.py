"""machine.toml as it is written: its tables and their keys."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, PlainValidator, StrictFloat, StrictStr
from pydantic_core import PydanticKnownError

from axiscal.document import QuantityText
from axiscal.document.validation import QuantityOf
from axiscal_core.axes import Counting

Twice = tuple[str, str]


def _once_or_twice(read: Callable[[object], object]) -> PlainValidator:
    """Return what reads a value, or two of them in a list."""

    def made(value: object) -> object:
        if not isinstance(value, list):
            return read(value)
        if len(value) != 2:
            raise PydanticKnownError("too_long", {"field_type": "List", "max_length": 2, "actual_length": len(value)})
        return tuple(map(read, value))

    return PlainValidator(made)


def _count(value: object) -> int:
    if type(value) is not int:
        raise PydanticKnownError("int_type")
    return value


Counts = Annotated[int | tuple[int, int], _once_or_twice(_count)]
"""A whole number, or one for each of two axes."""
QuantityTexts = Annotated[str | Twice, _once_or_twice(QuantityOf(None).read)]
"""A quantity, or one for each of two axes."""


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True)


class ToolTable(_Table):
    """[tool]"""

    length: QuantityText = Field("0 mm", examples=['"120 mm"'])
    radius: QuantityText = Field("40 mm", examples=['"31.5 mm"'])
    stylus: QuantityText = Field("0 mm", examples=['"6 mm"'])
    reach: QuantityText = Field("50 mm", examples=['"50 mm"'])
    head: tuple[QuantityText, QuantityText] | None = Field(None, examples=['["130 mm", "130 mm"]'])


class AxisTable(_Table):
    """[axes.X]"""

    travel: tuple[QuantityText, QuantityText] = Field(examples=['["0 mm", "600 mm"]'])
    speed: QuantityText | None = Field(None, examples=['"10 m/min"'])
    acceleration: QuantityText | None = Field(None, examples=['"2 m/s^2"'])
    overrun: QuantityText | None = Field(None, examples=['"2 mm"'])
    origin: tuple[QuantityText, QuantityText, QuantityText] | None = Field(
        None, examples=['["0 mm", "0 mm", "-150 mm"]']
    )
    limits: tuple[QuantityText, QuantityText] | None = Field(None, examples=['["-720 deg", "1080 deg"]'])
    direction: Counting | None = Field(None, examples=['"reversed"', '"iso"'])
    shows: Literal["radius", "diameter"] = Field("radius", examples=['"diameter"'])


class ErrorTable(_Table):
    """An entry of [errors]"""

    std: QuantityText | None = Field(None, examples=['"10 um"'])
    band: QuantityText | None = Field(None, examples=['"40 um"'])
    knots: Counts | None = Field(None, examples=["13"])
    spacing: QuantityTexts | None = Field(None, examples=['"50 mm"'])
    length: QuantityTexts | None = Field(None, examples=['"150 mm"'])
    rest: QuantityText | None = Field(None, examples=['"0.5 um"', '"estimate"'])
    period: QuantityText | None = Field(None, examples=['"5 mm"'])
    smoothness: StrictFloat | Literal["estimate"] | None = Field(None, examples=["1.5"])
    sure: Literal["roughly", "well", "exactly"] | None = Field(None, examples=['"well"'])
    harmonics: int | None = Field(None, examples=["2"])
    at: list[QuantityText] | None = Field(None, examples=['["500 mm", "1000 mm"]'])
    scale: QuantityText | None = Field(None, examples=['"30 um/m"'])


class MachineFile(_Table):
    """The whole file"""

    name: StrictStr | None = Field(None, examples=['"Three-axis mill"'])
    maker: StrictStr = Field("", examples=['"Example Machine Works, type 600"'])
    serial: StrictStr = Field("", examples=['"M-1042"'])
    chain: StrictStr = Field(examples=["\"w-X'-Y'-b-Z-t\""])
    tool: ToolTable = ToolTable()
    axes: dict[str, AxisTable] = Field(examples=['{ X = { travel = ["0 mm", "600 mm"] } }'])
    errors: dict[str, ErrorTable] = Field(examples=['{ EXX = { std = "10 um" } }'])
