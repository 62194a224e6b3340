"""Old files of the ISG kernel and Beckhoff TwinCAT CNC: volumetric compensation in either form, leadscrew tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from axiscal.compensation.controllers.isg import leadscrew
from axiscal.compensation.controllers.isg.formats import read_csv, read_etalon
from axiscal.compensation.export_options import ExportOptions
from axiscal.compensation.loaded import Loaded
from axiscal.compensation.lookup import Lookup
from axiscal.compensation.old_files import OldFile
from axiscal.compensation.volumetric import SampledError
from axiscal.exceptions import TableError
from axiscal.machine.description import Machine
from axiscal.machine.names import parse_error_name
from axiscal.numerics import Array

_APART = 1e-9
"""m or rad: positions nearer than this are one, by their decimals."""
_REMEDY = "give the files that the kernel loads: ISG_CSV, ETALON_EXCHANGE, and leadscrew lists (kw.ssfk)"


def load(files: Sequence[OldFile], machine: Machine, options: ExportOptions) -> Loaded:
    """Return what the files did; raises TableError.

    The list file says where the others are and nothing else. Where the tool and rotary axes lie is no compensation.
    """
    errors, lookups = dict[str, SampledError](), list[Lookup]()
    for file in files:
        try:
            if "kw.ssfk." in file.text:
                lookups += leadscrew.read(file.text, machine)
            elif "file_format[0]" not in file.text:
                read = read_etalon if file.text.lstrip().startswith("[") else read_csv
                errors |= {n: e for n, e in read(file.text, machine).items() if not n.startswith("P")}
        except (TableError, ValueError, LookupError) as fault:
            what = fault.what if isinstance(fault, TableError) else "this is no table of the ISG kernel"
            raise TableError(what, _REMEDY, file.name) from None
    if not errors and not lookups:
        raise TableError("no error and no leadscrew table is in these files", _REMEDY, files[0].name)
    return Loaded(tuple(lookups), errors=errors)


def together(new: Mapping[str, SampledError], old: Mapping[str, SampledError]) -> dict[str, SampledError]:
    """Return the sums of errors: the motions of an axis are all at the positions that any of them has."""
    parts = {name: [each[name] for each in (new, old) if name in each] for name in {**new, **old}}
    _refuse_third_axes(parts)
    grids = dict[str, list[Array]]()
    for name, both in parts.items():
        grids.setdefault(_block(name, both), []).extend(one.positions for one in both)
    at = {block: _distinct(np.concatenate(positions)) for block, positions in grids.items()}
    return {name: _sum(both, at[_block(name, both)]) for name, both in parts.items()}


def _block(name: str, both: Sequence[SampledError]) -> str:
    """Return which errors have their positions in common: those of one axis; constants and planes have their own."""
    alone = all(len(one.positions) == 1 for one in both) or any(one.over for one in both)
    return name if alone else parse_error_name(name).axis


def _refuse_third_axes(parts: Mapping[str, Sequence[SampledError]]) -> None:
    for name, both in parts.items():
        if len(overs := sorted({one.over for one in both} - {""})) > 1:
            raise TableError(f"{name} depends on {overs[0]} before and on {overs[1]} now", "take the old one out first")


def _distinct(positions: Array) -> Array:
    at = np.unique(positions)
    return at[np.r_[True, np.diff(at) > _APART]]


def _sum(both: Sequence[SampledError], at: Array) -> SampledError:
    across = [one.across for one in both if one.over]
    if not across:
        values: Array = np.sum([np.interp(at, one.positions, one.values) for one in both], axis=0)
        return SampledError(at, values)
    rows = _distinct(np.concatenate(across))
    own, other = np.meshgrid(at, rows)
    total: Array = np.sum([one.at(own.ravel(), other.ravel()) for one in both], axis=0).reshape(own.shape)
    return SampledError(at, total, next(one.over for one in both if one.over), rows)
