"""Every sample configuration of LinuxCNC: from its INI to tables that the component reads, or refused by `init`."""

from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory

from axiscal.description.first_files import machine_text
from axiscal.description.ini_file import read_ini
from axiscal.description.ini_machine import lacking_limits, machine_of
from axiscal.exceptions import InputError
from axiscal.machine.axis import letter_direction
from axiscal.machine.description import machine_from_text
from axiscal.ports.linuxcnc.volumetric_tables import LinuxcncVolumetric
from axiscal.tables import registry
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.round_trip import drawn_and_known
from axiscal.units import from_unit
from tests.controls.fetched import MissingError
from tests.tables.core_library import Core

SAMPLES = Path("/usr/share/doc/linuxcnc/examples/sample-configs")
"""Of Debian's linuxcnc-uspace."""
_TRAVEL = (-0.3, 0.0)
"""m, where an INI leaves it open and a person is asked."""


def ends(core: Core, ini: Path) -> str:
    """Return how an INI file ends: "loaded", "refused" by what reads it, or why nothing loads its tables."""
    try:
        read = read_ini(ini)
        given = {axis: (_TRAVEL[0] / float(from_unit(1.0, unit)), 0.0) for axis, unit in lacking_limits(read).items()}
        found = machine_of(read, given)
        machine = machine_from_text(machine_text(found, ini.name), ini)
    except InputError:
        return "refused"
    try:
        estimate = drawn_and_known(machine, 3)
        joints = {axis.letter: axis.joints for axis in found.axes}
        options = ExportOptions(unit=found.unit, numbers=joints, active=False)
        linear = [letter_direction(axis.letter) for axis in machine.axes if not axis.rotary]
        if len(set(linear)) < len(linear):
            registry.export(estimate, "linuxcnc", options)
            return "loaded"  # two axes along one direction have tables of their own
        files = LinuxcncVolumetric().make(estimate, options).files
    except InputError as failure:
        return str(failure.what)
    return core.load(files["axiscal.vcomp"].encode())[0] or "loaded"


def counted(every: int = 1) -> Counter[str]:
    """Return how often each end is met by every so many-th; raises MissingError where samples, or gcc, are not here."""
    files = sorted(SAMPLES.rglob("*.ini"))[::every]
    if not files:
        raise MissingError("linuxcnc-uspace is not installed")
    with TemporaryDirectory() as folder:
        core = Core(Path(folder))
        return Counter(ends(core, ini) for ini in files)
