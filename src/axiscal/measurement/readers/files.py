"""Any file of readings, recognised by its first lines: one row for each format, then what installed packages read."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import NamedTuple, Protocol, runtime_checkable

from axiscal.document.gone import instead_of
from axiscal.document.ports import names, of_class, one_of
from axiscal.exceptions import InputError
from axiscal.language.spoken import later, said
from axiscal.measurement.readers import bed_map, point_lists
from axiscal.measurement.readers.axis_tests import axis_named, axis_test, test_of
from axiscal.measurement.readers.csv_readings import ALONE, Around, Found, RawReading, table_readings
from axiscal.measurement.readers.probe_offset import offset_in, sections_in, zero_of
from axiscal.measurement.readers.renishaw import file_type, laser_test
from axiscal.measurement.readers.text_file import LINES_OF, TextFile, has_line
from axiscal.measurement.setup import Setup
from axiscal_core.axes import Axis

PORTS = "axiscal.readers"
"""Group of the entry points by which packages bring readers."""


@runtime_checkable
class FileReader(Protocol):
    """What reads the files of an instrument."""

    def knows(self, file: TextFile) -> bool:
        """Return whether it is the reader of a file."""

    def read(self, file: TextFile) -> Sequence[RawReading]:
        """Return the readings of such a file, in its order; raises ReadingError."""


class Format(NamedTuple):
    """One format.

    title : what such a file is called; knows : whether a file is one; read : its readings, raises ReadingError
    unitless : it states no units, and --unit may
    """

    title: str
    knows: Callable[[TextFile], bool]
    read: Callable[[TextFile, Around], Found]
    unitless: bool = False


FORMATS = (
    Format(later("a positioning test (.rtl)"), lambda file: file_type(file) == "rtl", laser_test, True),
    Format(later("an angular test (.rta)"), lambda file: file_type(file) == "rta", laser_test, True),
    Format(later("a straightness test (.rts)"), lambda file: file_type(file) == "rts", laser_test, True),
    Format(later("a file of laser software"), lambda file: file_type(file) is not None, laser_test, True),
    Format(later("a RepRapFirmware map"), bed_map.is_height_map, bed_map.height_map),
    Format(later("a Klipper mesh"), bed_map.is_mesh, bed_map.mesh),
    Format(later("a Moonraker mesh"), bed_map.is_moonraker, bed_map.moonraker),
    Format(later("a mesh of the Klipper console"), bed_map.is_console, bed_map.console),
    Format(later("touches as a firmware printed them"), bed_map.is_touched, bed_map.touched, True),
    Format(later("a Marlin map (M420 V)"), bed_map.is_printed, bed_map.printed),
    Format(later("a Marlin map (M421, M503)"), bed_map.is_nodes, bed_map.nodes),
    Format(later("a Candle height map"), point_lists.is_candle, point_lists.candle, True),
    Format(later("a bCNC probe file"), point_lists.is_bcnc, point_lists.bcnc, True),
    Format(later("a list of points X Y Z"), point_lists.is_list, point_lists.listed, True),
    Format(later("a circular test (ISO 230-4)"), lambda file: test_of(file) == "circle", axis_test, True),
    Format(later("a test of one axis, a column a run"), lambda file: test_of(file) == "wide", axis_test, True),
    Format(later("a test of one axis (ISO 230-2)"), lambda file: test_of(file) == "long", axis_test, True),
)
"""In this order: the first that knows a file reads it."""
_GONE = {name: partial(has_line, [pattern]) for name, pattern in LINES_OF["gone"].items()}
"""What tells files that are read no more, by name."""
_TABLE = Format(later("a table of readings"), lambda file: True, table_readings, True)


def recognised(path: str | Path, around: Around = ALONE, unit: str = "") -> Found:
    """Return what a file is, and its readings; raises ReadingError.  unit : of lengths, where the file names none"""
    file = bed_map.read_part(path, unit)
    if gone := next((name for name, is_one in _GONE.items() if is_one(file)), ""):
        raise file.fail("{name} is gone", instead_of("readings", gone), name=gone)
    own = next((each for each in FORMATS if each.knows(file)), None)
    brought = [] if own else [of_class(name, one_of(PORTS, name), FileReader) for name in names(PORTS)]
    reader = next((each for each in brought if each.knows(file)), None)
    if reader is not None:
        title = type(reader).__qualname__
        read = of_class(f"the result of {title}.read", reader.read(file), Sequence)
        readings = tuple(of_class(f"each of {title}.read", each, RawReading) for each in read)
        return Found(readings, file=file.name, title=title)
    kind = own or _TABLE
    if unit and not kind.unitless:
        what, remedy = "this is {title}, whose units are known, and --unit names another", "leave --unit out"
        raise file.fail(what, remedy, title=said(kind.title))
    found = kind.read(file, around)
    if any(each.error == "z" for each in found.readings):  # heights, by a probe that may stand beside the tool point
        text = "\n".join(file.lines)
        beside, zero = offset_in(text), zero_of(sections_in(text) or {})
        found = replace(found, readings=tuple(replace(each, beside=beside, zero=zero) for each in found.readings))
    named = axis_named(file)
    told = tuple(replace(each, axis=each.axis or named) if each.test else each for each in found.readings)
    return replace(found, readings=told, file=file.name, title=kind.title)


def title_of(path: str | Path) -> str:
    """Return what a file of readings is called, even a damaged one; "" where it is none."""
    with suppress(InputError):
        file = bed_map.read_part(path)
        return next((each.title for each in FORMATS if each.knows(file)), None) or recognised(path).title
    return ""


def read_any(path: str | Path, axes: Sequence[Axis] = (), setups: Sequence[Setup] = ()) -> tuple[RawReading, ...]:
    """Return the readings of a file of any kind, in its order; raises ReadingError, with the header for these axes."""
    return recognised(path, Around(axes, setups)).readings
