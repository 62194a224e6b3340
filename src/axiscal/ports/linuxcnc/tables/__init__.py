"""LinuxCNC: `COMP_FILE` tables of one axis.

Nothing in such a file is checked by LinuxCNC: a fault in it is passed over in silence or drives the motor away.  So a
file is read back by the controller's own rules (`writer`), applied, and offered only when it corrects (`exporting`).
"""

from axiscal.ports.linuxcnc.tables.writer import LinuxcncTable, correction, dead_band, offer, parse, verify, write

__all__ = ["LinuxcncTable", "correction", "dead_band", "offer", "parse", "verify", "write"]
