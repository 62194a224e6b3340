"""Debian's LinuxCNC without screen or motors, for one job after another: configuration text in, positions out."""

from axiscal.lab.linuxcnc.configuration import Joint, Machine
from axiscal.lab.linuxcnc.session import Ending, Run, Session, available, run

__all__ = ["Ending", "Joint", "Machine", "Run", "Session", "available", "run"]
