"""Instruments that somebody wrote: a class derived from `axiscal_core.Instrument` is one like ours.

A campaign names it as `file.py:Class`, by the path from campaign.toml, or by the name that a package gave it.
Numbers that are not equally noisy are multiplied by σ₁/σᵢ within estimates and plans, so that one noise is that of all.
"""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cached_property, partial
from pathlib import Path
from types import ModuleType
from typing import Any, ClassVar
from zlib import crc32

import numpy as np

from axiscal.document.consent import refuse_unread
from axiscal.document.ports import one_of
from axiscal.document.quoting import shown
from axiscal.exceptions import AxiscalError, CodeError, DescriptionError
from axiscal.measurement.setup import Reads, Setup, Unknown, Usual
from axiscal.measurement.type_b import Read, TypeB
from axiscal.numerics import Array
from axiscal.units import find_unit
from axiscal_core import refusals
from axiscal_core.instrument import At, Unknowns, numbers, own_slopes, refuse_what_is_not_analytic
from axiscal_core.instrument import Instrument as Seeing
from axiscal_core.points import even_points
from axiscal_core.units import Quantity, si

PORTS = "axiscal.instruments"
"""Group of the entry points by which packages bring instruments."""
_TRIED = 1000
"""Poses at which a class is tried when a set-up names it: an unknown may count at a few of them only."""
_ROUNDING = 1e-9
"""Of derivatives, which are m/m or m/rad."""
_NAME = re.compile(r"(?!(?:reading|setup|approach|time|check|std|used|surprise)$)[a-z]\w*", re.ASCII)
"""Of a number: a column of its own in a file of readings."""


class Foreign(Setup):
    """What a class of somebody's sees.

    made : the class; units : of each number; sigma : (k,) noise of each; where : file and line that name it
    """

    made: ClassVar[type[Seeing]] = Seeing
    units: ClassVar[tuple[Reads, ...]] = ()
    sigma: ClassVar[Array]
    where: ClassVar[tuple[Path, int | None]]
    directed, written = False, True

    @cached_property
    def _seeing(self) -> Seeing:
        with _placed(*self.where):
            return self.made(self.name, [self.machine.axes[k].name for k in self.moves])

    def sees(self, at: At, u: Unknowns) -> Sequence[Array]:
        """Return what the class does, each number by its scale."""
        with _placed(*self.where):
            return [*(numbers(self._seeing, at, u) * self.scales).T]

    def check(self) -> None:
        """Raise DescriptionError where the class fails at a pose of the set-up, or is not analytic there."""
        with _placed(*self.where):
            refuse_what_is_not_analytic(self._seeing, self._tried())

    def _tried(self) -> At:
        """Return places that are spread over what the set-up moves."""
        poses = np.tile(np.array(self.park), (_TRIED, 1))
        for k, share in zip(self.moves, even_points(_TRIED, len(self.moves)).T, strict=True):
            low, high = self.machine.axes[k].travel
            poses[:, k] = low + (high - low) * share
        return self.places(poses, np.ones_like(poses))

    def curved_by(self) -> tuple[str, ...]:
        """Return the unknowns on whose size the derivatives by any of them depend."""
        own = [unknown.name for unknown in self.unknowns]
        at, nothing = self._tried(), dict.fromkeys(self.unknown_reads, 0.0)
        slopes = [own_slopes(self, at, {**nothing, each.name: each.std}, own) for each in self.unknowns]
        still = own_slopes(self, at, nothing, own)
        moved = (float(np.abs(each - still).max(initial=0.0)) for each in slopes)
        return tuple(name for name, change in zip(own, moved, strict=True) if change > _ROUNDING)

    @property
    def scales(self) -> Array:
        """By what each number is multiplied so that all are as noisy as the first, (k,)."""
        return np.asarray(self.sigma[0] / self.sigma)

    @property
    def reads_each(self) -> tuple[Reads, ...]:
        """What each number is."""
        return self.units

    def column(self, name: str) -> str:
        """Return the number's own name."""
        return name


def named(text: str, file: Path, line: int | None, *, own: bool) -> type[Setup] | None:
    """Return the instrument that a campaign calls so, None where nobody brings one; raises DescriptionError, PortError.

    file, line : where it is named; own : by who reads it. Raises CodeError for code that nobody has said yes to.
    """
    module, _, name = text.rpartition(":")
    found = getattr(_module(file.parent, module, own), name, None) if module else one_of(PORTS, text)
    if found is None and not module:
        return None
    if not (isinstance(found, type) and issubclass(found, Seeing)):
        what = "{name} is no class that is derived from axiscal_core.Instrument"
        raise DescriptionError(what, "Name it as in file.py:Class, its path from here", name=shown(text))
    with _placed(None, None):
        return _instrument(text, found, (file, line))


def _module(folder: Path, file: str, own: bool) -> Any:
    """Return a file of Python, run once for what it says; raises DescriptionError.  folder : may not be there yet"""
    path = Path(os.path.normpath(folder / file))
    try:
        text = path.read_bytes()
        refuse_unread(path, text, own=own)
        name = f"axiscal_written_{crc32(str(path.absolute()).encode() + text):08x}"
        if name not in sys.modules:
            module = ModuleType(name)
            module.__file__ = str(path)
            exec(compile(text, path, "exec"), module.__dict__)  # the text that was read: files beside it are not asked
            sys.modules[name] = module
        return sys.modules[name]
    except CodeError:
        raise
    except Exception as fault:
        what = "the instrument {module} cannot be loaded ({kind}: {fault})"
        remedy = "Put the file there, or repair it"
        raise DescriptionError(what, remedy, module=path, kind=type(fault).__name__, fault=fault) from fault


@contextmanager
def _placed(file: Path | None, line: int | None) -> Iterator[None]:
    """Raise whatever a class does wrong as a DescriptionError at the place that names it."""
    try:
        yield
    except AxiscalError:
        raise
    except refusals.InputError as fault:
        wrong, _, right = str(fault).rstrip(".").rpartition(". ")
        raise DescriptionError("{wrong}", "{right}", file, line, wrong=wrong, right=right) from fault
    except Exception as fault:
        what = "the instrument cannot be mounted ({kind}: {fault})"
        remedy = "Let its class be made of a name and the axes that move"
        raise DescriptionError(what, remedy, file, line, kind=type(fault).__name__, fault=fault) from fault


def _instrument(text: str, made: type[Seeing], where: tuple[Path, int | None]) -> type[Setup]:
    """Return a class with its figures."""
    one = made(text, [])
    names, sigma = tuple(one.names), one.sigma
    wrong = [name for name in names if not _NAME.fullmatch(name)] or [n for n in names if names.count(n) > 1]
    if wrong:
        raise refusals.InputError(made.__name__, "names", f"hold {wrong[0]!r}", "Give each a word of its own")
    units = tuple[Reads, ...]("angle" if unit == "rad" else "length" for unit in one.units)
    alike = len(set(units)) == 1 and bool(np.all(sigma == sigma[0]))
    if one.wander and not alike:
        raise refusals.InputError(made.__name__, "drift", "is one for unlike numbers", "Leave it out")
    kinds = {name: find_unit(_unit(size, units[0])).dimension for name, size in {**one.unknowns, **one.type_b}.items()}
    unknowns: dict[str, Reads] = {name: "angle" if kind == "angle" else "length" for name, kind in kinds.items()}
    own = {"instrument": text, "made": made, "numbers": names, "reads": units[0], "units": units, "where": where}
    own |= {"sigma": sigma, "alike": alike, "unknown_reads": unknowns}
    own["usual"] = Usual(
        noise=float(sigma[0]),
        unknowns=tuple(Unknown(name, std) for name, std in one.own.items()),
        setup_time=one.begins,
        settle=0.0,
        reading_time=one.costs,
        wanders=(one.wander, one.wander),
        approach=one.approach,
        park={axis: si(place, made.__name__, "park") for axis, place in one.park.items()},
    )
    own["type_b"] = tuple(
        TypeB(
            name, std, _unit(one.type_b[name], units[0]), "its class", "instrument", partial(_alone, name=name),
            covered=(name,),
        )
        for name, std in one.considered.items()
    )  # fmt: skip
    return type(made.__name__, (Foreign,), own)


def _alone(read: Read, size: float, name: str) -> Array:
    """Return what a class shows of a cause of its own, (k, r)."""
    return size * read.setup.own_slopes(read.at, (name,))[:, :, 0].T


def _unit(size: Quantity, reads: Reads) -> str:
    """Return the unit that a quantity is written in; of a bare number that of what is read."""
    return size.split()[-1] if isinstance(size, str) else {"length": "um", "angle": "urad"}[reads]
