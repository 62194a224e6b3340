"""The controllers that tables can be made for, by the names that `axiscal export --to` takes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from axiscal.description.fields import CONTROLS
from axiscal.document import meant, shown
from axiscal.document.gone import instead_of
from axiscal.document.ports import made_by, names, of_class
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import AxiscalError, Faults, TableError
from axiscal.language.spoken import joined, later
from axiscal.language.stages import stage
from axiscal.tables.exporter import OFF, Exporter, ExportOptions, asked_about, informed, on_top
from axiscal.tables.loaded import Loaded, refuse_long_numbers
from axiscal.tables.offer import Export, tried_out
from axiscal_core.machine import Machine
from axiscal_core.threads import one_thread

_ABSURD = 1.0
"""m or rad: no compensation is as large; any value above what a machine can be off by would do."""
_FARTHEST = 1e3
"""m or rad: no axis goes so far."""
_OTHERS = later("leave it out: it is for {takers}")


@one_thread()
@stage("tables")
def export(estimate: Estimate, controller: str, options: ExportOptions) -> Export:
    """Return the files for one controller, tried out; raises TableError for an unknown one, or what it cannot hold."""
    refuse_untaken(controller, options.given)
    control = exporter(controller)
    for axis in options.spacing if isinstance(options.spacing, Mapping) else ():
        estimate.machine.index(axis)
    if not options.old_files:
        draft = asked_about(controller, control, control.make(estimate, options), options)
    else:
        old = loaded(controller, estimate.machine, options)
        draft = on_top(estimate, control.make(estimate, replace(options, old=old)), old, options)
    return tried_out(controller, estimate, draft)


def refuse_untaken(controller: str, given: Sequence[str]) -> None:
    """Raise TableError for the first option of the command line that a control has no use for."""
    control = exporter(controller)
    for option in given:
        if option not in control.takes:
            takers = joined([name for name in controllers() if option in exporter(name).takes]) or "program"
            what, remedy = "{controller} does not take {option}", OFF if option == "--on-top-of" else _OTHERS
            raise TableError(what, remedy, controller=controller, option=option, takers=takers)


def unstated(controller: str) -> str:
    """Return the tables of a control whose sign no source states, as of `Exporter`; raises TableError for none."""
    if found := exporter(controller).unstated:
        return found
    what = "{controller} states which way it takes its tables"
    raise TableError(what, "Leave --probe-sign and --bump out", controller=controller)


def offered(known: Estimation, controller: str) -> Export:
    """Return the files for a control as the campaign describes it; raises as `export`, and ReadingError."""
    return export(known.estimate(), controller, informed(ExportOptions(), known.case.description, controller))


def loaded(controller: str, machine: Machine, options: ExportOptions) -> Loaded:
    """Return what the old files of a control did; raises TableError, ReadingError."""
    load = exporter(controller).load
    for file in options.old_files:
        refuse_long_numbers(file.text, file.name)
    named = ", ".join(dict.fromkeys(file.name for file in options.old_files))
    try:
        found: Loaded = of_class(f"the result of {controller}.load", load(options.old_files, machine, options), Loaded)
    except TableError as fault:
        raise fault if fault.file else fault.placed(named) from None
    except AxiscalError:
        raise
    except (LookupError, ArithmeticError, ValueError) as fault:
        what = "a number that {controller} needs is missing, or is none ({reason})"
        remedy = "give the files as the control saved them"
        raise TableError(what, remedy, named, controller=controller, reason=fault) from fault
    faults, known = Faults(), {name for table in found.tables for name in (table.axis, table.over)}
    faults.found += found.untaken
    for file in (each for each in options.old_files if each.axis and each.axis not in known):
        remedy = "give it without AXIS=, or name the file of that axis"
        faults.found.append(TableError("no table of {axis} is in this file", remedy, file.name, axis=file.axis))
    faults.refuse()
    for table in found.tables:
        absurd = np.abs([table.forward, table.reverse, table.positions / _FARTHEST]) >= _ABSURD
        if np.any(absurd):
            what = "the table of {axis} over {over} moves it by a metre, or a radian, or stands at a kilometre"
            remedy = "give the files as the control saved them, and the unit of the machine"
            raise TableError(what, remedy, named, axis=table.axis, over=table.over)
    return found


def controllers() -> tuple[str, ...]:
    """Return the names of all controls."""
    return names(CONTROLS)


def exporter(controller: str) -> Exporter:
    """Return what writes for a control and reads its files; raises TableError for one that is not known."""
    instead = instead_of("controls", controller)
    if instead:
        raise TableError("{controller} is gone", instead, controller=controller)
    brought: Exporter | None = made_by(CONTROLS, controller, Exporter)
    if brought is None:
        remedy = meant(controller, controllers(), quoted="{}")
        what = "{controller} is not a controller that tables can be made for"
        raise TableError(what, remedy, controller=shown(controller))
    return brought
